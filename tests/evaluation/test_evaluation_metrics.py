"""Scores of groupings and of predictions."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import adjusted_mutual_info_score, balanced_accuracy_score

from shapeconcepts.evaluation import grouping_scores, mean_error_over_labels, purity, rank_score

objects = st.lists(st.tuples(st.integers(-1, 5), st.sampled_from("abc")), min_size=1, max_size=40)


def slow_scores(groups: list[int], labels: list[str]) -> dict[str, float]:
    sizes = Counter(groups)
    own = [(g if g >= 0 and sizes[g] > 1 else ("alone", i)) for i, g in enumerate(groups)]
    members = {g: [labels[i] for i in range(len(own)) if own[i] == g] for g in own}
    kept = [of_group for g, of_group in members.items() if not isinstance(g, tuple)]
    majorities = [max(Counter(of_group).values()) for of_group in kept]
    precision = np.mean(
        [members[g].count(label) / len(members[g]) for g, label in zip(own, labels, strict=True)]
    )
    recall = np.mean(
        [members[g].count(label) / labels.count(label) for g, label in zip(own, labels, strict=True)]
    )
    numbers = {g: k for k, g in enumerate(members)}
    return {
        "n_groups": len(kept),
        "mean_purity": np.mean([m / len(g) for m, g in zip(majorities, kept, strict=True)])
        if kept
        else np.nan,
        "pure_share": np.mean([m == len(g) for m, g in zip(majorities, kept, strict=True)])
        if kept
        else np.nan,
        "coverage": sum(map(len, kept)) / len(groups),
        "explained": sum(majorities) / len(groups),
        "adjusted_mutual_information": adjusted_mutual_info_score(labels, [numbers[g] for g in own]),
        "b_cubed_f1": 2 * precision * recall / (precision + recall),
    }


@given(objects)
def test_scores_are_those_of_a_slow_count(pairs) -> None:
    groups, labels = map(list, zip(*pairs, strict=True))
    assert vars(grouping_scores(groups, labels)) == pytest.approx(slow_scores(groups, labels), nan_ok=True)


def test_scores_of_an_example() -> None:
    scores = grouping_scores([0, 0, 0, 1, 1, -1, 7], ["a", "a", "b", "b", "b", "a", "b"])
    assert scores.n_groups == 2
    assert scores.mean_purity == pytest.approx((2 / 3 + 1) / 2)
    assert scores.pure_share == 0.5
    assert scores.coverage == pytest.approx(5 / 7)
    assert scores.explained == pytest.approx(4 / 7)
    # Precision: 2/3, 2/3, 1/3, 1, 1, 1, 1. Recall: 2/3, 2/3, 1/4, 2/4, 2/4, 1/3, 1/4.
    precision, recall = (17 / 3) / 7, (19 / 6) / 7
    assert scores.b_cubed_f1 == pytest.approx(2 * precision * recall / (precision + recall))


def test_the_labels_as_groups_are_perfect() -> None:
    scores = grouping_scores([3, 3, 1, 1], ["x", "x", "y", "y"])
    assert vars(scores) == dict.fromkeys(vars(scores), 1.0) | {"n_groups": 2}


@pytest.mark.parametrize("groups", [[-1, -1, -1], [0, 1, 2]])
def test_without_groups_there_is_no_purity(groups) -> None:
    scores = grouping_scores(groups, ["a", "a", "b"])
    assert np.isnan(scores.mean_purity) and np.isnan(scores.pure_share)
    assert (scores.n_groups, scores.coverage, scores.explained) == (0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("groups", "labels", "message"),
    [
        ([], [], "at least 1"),
        ([0], ["a", "b"], r"got shapes \(1,\) and \(2,\)"),
        ([-2, 0], ["a", "b"], r"at least -1, got \[-2, 0\]"),
        ([0.5, 0.0], ["a", "b"], r"integers of at least -1, got \[0.5, 0.0\]"),
    ],
)
def test_unsuitable_groups_are_refused(groups, labels, message) -> None:
    with pytest.raises(ValueError, match=message):
        grouping_scores(groups, labels)


def test_purity_and_rank_follow_the_paper() -> None:
    assert purity(["can", "sack", "can", "can"]) == 0.75
    assert rank_score(4, 1.0) == pytest.approx(4000)
    assert rank_score(4, 0.75, epsilon=0.25) == 8
    with pytest.raises(ValueError, match="labels must be a sequence of at least one"):
        purity([])
    for arguments, name in (((0, 1.0), "size"), ((1, 0.0), "purity"), ((1, 1.0, 0.0), "epsilon")):
        with pytest.raises(ValueError, match=f"^{name} must be"):
            rank_score(*arguments)


@given(st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from("abc")), min_size=1, max_size=30))
def test_the_mean_error_is_one_minus_balanced_accuracy(pairs) -> None:
    true, predicted = map(np.array, zip(*pairs, strict=True))
    errors, mean = mean_error_over_labels(true, predicted)
    recalls = {label: (predicted[true == label] == label).mean() for label in sorted(set(true))}
    assert errors == pytest.approx({label: 1 - recall for label, recall in recalls.items()})
    assert mean == pytest.approx(1 - np.mean(list(recalls.values())))
    if set(predicted) <= set(true) and len(set(true)) > 1:
        assert mean == pytest.approx(1 - balanced_accuracy_score(true, predicted))


def test_predictions_of_another_length_are_refused() -> None:
    with pytest.raises(ValueError, match=r"got shapes \(2,\) and \(1,\)"):
        mean_error_over_labels(["a", "b"], ["a"])
