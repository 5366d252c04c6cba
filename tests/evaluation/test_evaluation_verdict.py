"""The verdict: every measure has its say, and what the motifs add is told, and where it is nothing."""

from dataclasses import replace

import evaluation_examples as examples
import pytest

from shapeconcepts.evaluation.metrics import GroupingScores
from shapeconcepts.evaluation.report.motif_gain import motif_gain_table, motif_gains, said_of_motifs, signed
from shapeconcepts.evaluation.report.verdict import verdict
from shapeconcepts.evaluation.results import BaselineRow, Evaluation


def scores(information: float, f1: float, explained: float) -> list[GroupingScores]:
    return [GroupingScores(9, 0.9, 0.5, 1.0, explained, information, f1)] * 3


def row(representation: str, grouping: str, *values: float) -> BaselineRow:
    return BaselineRow(representation, grouping, [{}] * 3, scores(*values))


def evaluation(*rows: BaselineRow) -> Evaluation:
    """Ours has 0.9 information, 0.8 B-cubed F1 and explains 95 %."""
    made = examples.evaluation(repetitions=3)
    ours = replace(made.selections[0], scores=scores(0.9, 0.8, 0.95))
    return replace(made, selections=[ours, *made.selections[1:]], baselines=list(rows))


def test_each_measure_names_its_own_best_rival() -> None:
    said = verdict(
        evaluation(
            row("ESF", "k-means", 0.5, 0.85, 0.99),
            row("surflet", "HDBSCAN", 0.95, 0.6, 0.5),
            row("mean FPFH", "ToMATo", 0.1, 0.82, 0.7),
        )
    )
    assert said == (
        "shapeconcepts, default, beside 3 rivals that saw no label either: "
        "information 0.90, 1 is better, best surflet, HDBSCAN (0.95). "
        "B-cubed F1 0.80, 2 are better, best ESF, k-means (0.85). "
        "objects explained 95.0 %, 1 is better, best ESF, k-means (99.0 %)."
    )


def test_where_none_is_better_the_best_is_named_all_the_same() -> None:
    said = verdict(evaluation(row("ESF", "k-means", 0.5, 0.4, 0.3)))
    assert said.count("none is better, best ESF, k-means") == 3


def test_nothing_to_compare_is_no_verdict() -> None:
    assert verdict(evaluation()) == ""
    assert verdict(examples.nothing_found()) == ""


PAIRS = (
    row("whole object", "k-means", 0.5, 0.5, 0.9),
    row("motif stimuli", "k-means", 0.6, 0.4, 0.9),
    row("whole object", "Leiden", 0.7, 0.7, 0.9),
    row("motif stimuli", "Leiden", 0.7, 0.65, 0.9),
    row("whole object", "our filtration", 0.8, 0.8, 0.95),
    row("surflet", "Leiden", 0.1, 0.1, 0.1),
)


def test_motifs_are_compared_by_the_same_way_to_group() -> None:
    gains = motif_gains(evaluation(*PAIRS))
    assert list(gains) == ["adjusted_mutual_information", "b_cubed_f1", "explained"]
    assert gains["adjusted_mutual_information"] == pytest.approx(
        {"k-means": 0.1, "Leiden": 0, "our filtration": 0.1}
    )
    assert gains["b_cubed_f1"] == pytest.approx({"k-means": -0.1, "Leiden": -0.05, "our filtration": 0})


def test_gains_are_medians_of_the_differences_of_repetitions() -> None:
    stimuli = replace(PAIRS[1], scores=[scores(value, 0.5, 0.5)[0] for value in (0.55, 0.9, 0.4)])
    gains = motif_gains(evaluation(PAIRS[0], stimuli))
    assert gains["adjusted_mutual_information"] == pytest.approx({"k-means": 0.05})


def test_what_motifs_add_and_what_they_do_not_is_said() -> None:
    said = verdict(evaluation(*PAIRS))
    assert said.endswith(
        "Motif stimuli instead of the whole-object histogram, in 3 ways to group, median: "
        "information +0.10 (more in 2, less in 0); B-cubed F1 −0.05 (more in 0, less in 2); "
        "objects explained 0.00 (more in 0, less in 0). "
        "So the motifs add information, but no B-cubed F1 and no objects explained. "
        "They add nothing at all under Leiden."
    )


def test_that_motifs_add_nothing_is_said() -> None:
    worse = row("motif stimuli", "k-means", 0.4, 0.4, 0.8)
    assert verdict(evaluation(PAIRS[0], worse)).endswith("So they add nothing.")


def test_without_pairs_nothing_is_said_of_motifs() -> None:
    gains = motif_gains(evaluation(PAIRS[0], PAIRS[5]))
    assert not any(gains.values())
    assert said_of_motifs(gains) == ""


def test_a_row_for_each_way_to_group() -> None:
    text = motif_gain_table(motif_gains(evaluation(*PAIRS)))
    assert text.count("<tr") == 4
    assert "+0.10" in text and "−0.05" in text


def test_what_is_too_small_to_be_seen_is_0() -> None:
    assert [signed(value) for value in (0.0049, -0.0049, 0.0051, -0.126)] == [
        "0.00",
        "0.00",
        "+0.01",
        "−0.13",
    ]
