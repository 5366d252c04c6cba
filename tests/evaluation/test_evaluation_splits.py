"""Splits with the same share of every label."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from shapeconcepts.evaluation import stratified_splits

shares = st.sampled_from([0.1, 0.25, 0.5, 0.9])


@given(st.lists(st.integers(2, 15), min_size=1, max_size=5), shares, st.integers(0, 100))
def test_every_label_has_its_share_on_both_sides(counts, share, seed) -> None:
    labels = np.random.default_rng(seed).permutation(np.repeat(np.arange(len(counts)), counts).astype(str))
    for training, test in stratified_splits(labels, 3, share, seed):
        assert sorted([*training, *test]) == list(range(len(labels)))
        for label, count in enumerate(counts):
            in_test = (labels[test] == str(label)).sum()
            assert 1 <= in_test <= count - 1
            assert abs(in_test - share * count) <= 0.5 or in_test in (1, count - 1)


@given(st.lists(st.tuples(st.sampled_from("ab"), st.integers(0, 4)), min_size=2, max_size=40), shares)
def test_instances_stay_on_one_side(pairs, share) -> None:
    labels, instances = map(np.array, zip(*pairs, strict=True))
    n_instances = {label: len(set(instances[labels == label])) for label in set(labels)}
    assume(min((labels == label).sum() for label in n_instances) >= 2 and max(n_instances.values()) >= 2)
    for training, test in stratified_splits(labels, 2, share, 0, instances):
        sides = [{pairs[i] for i in side} for side in (training, test)]
        assert not sides[0] & sides[1]
        assert sides[0] | sides[1] == set(pairs)
        for label, n in n_instances.items():
            assert any(name == label for name, _ in sides[0])
            assert any(name == label for name, _ in sides[1]) == (n >= 2)


def test_the_share_is_met_with_instances_of_one_size() -> None:
    labels, instances = np.repeat(["a", "b"], 40), np.tile(np.arange(8), 10)
    for training, test in stratified_splits(labels, 5, 0.25, 0, instances):
        assert [(labels[test] == label).sum() for label in "ab"] == [10, 10]
        assert len(training) == 60


def test_repeats_differ_and_the_seed_decides() -> None:
    labels = np.repeat(["a", "b"], 20)
    splits = stratified_splits(labels, 4, random_state=7)
    assert len({tuple(test) for _, test in splits}) == 4
    again = stratified_splits(labels, 4, random_state=7)
    assert all(
        np.array_equal(one, other)
        for a, b in zip(splits, again, strict=True)
        for one, other in zip(a, b, strict=True)
    )


def test_every_object_is_tested_about_as_often() -> None:
    splits = stratified_splits(np.repeat(["a", "b"], 12), 400, random_state=0)
    share = np.bincount(np.concatenate([test for _, test in splits])) / 400
    assert np.abs(share - 0.25).max() < 0.1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((["a", "b", "b"], 1), "'a' has one"),
        (([], 1), "at least one, got shape"),
        ((["a", "a"], 0), "n_repeats must be an integer of at least 1, got 0"),
        ((["a", "a"], 1, 1.0), "test_share must be between 0 and 1, got 1.0"),
        ((["a", "a"], 1, 0.5, 0, [1]), r"one for each of 2 labels, got shape \(1,\)"),
        ((["a", "a", "b", "b"], 1, 0.5, 0, [1, 1, 2, 2]), "at least two of at least one label"),
    ],
)
def test_what_cannot_be_split_is_refused(arguments, message) -> None:
    with pytest.raises(ValueError, match=message):
        stratified_splits(*arguments)
