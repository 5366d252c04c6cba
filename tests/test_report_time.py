"""The axis of time of a report."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from report_models import WITHOUT_CONCEPTS, grouped_stimuli, model_of
from shapeconcepts.report.html.contents import report_contents
from shapeconcepts.report.html.time_scale import N_STEPS, TimeScale, annexation_counts


@given(st.floats(1e-9, 0.4), st.floats(0.6, 0.9999), st.lists(st.floats(0, 0.999), min_size=2, max_size=20))
def test_equal_ratios_of_odds_are_equally_far_apart(first, last, positions):
    scale = TimeScale((first, last))
    at = np.sort(positions)
    times = scale.times(at)
    odds = times / (1 - times)
    span = last / (1 - last) / (first / (1 - first))
    assert np.allclose(odds[1:] / odds[:-1], span ** np.diff(at), rtol=1e-6)
    assert np.allclose(scale.positions(times), at)
    assert scale.positions(np.array([0.0, first / 2, last, 1.0])).tolist() == pytest.approx([0, 0, 1, 1])
    assert scale.times(np.array([1.0])).tolist() == [1.0]


def test_a_linear_axis_is_time_itself():
    times = np.linspace(0, 1, 7)
    scale = TimeScale.of(model_of(grouped_stimuli(30, 3)[0], heat="geodesic").filtration_)
    assert scale.ends is None
    assert np.array_equal(scale.positions(times), times) and np.array_equal(scale.times(times), times)


def test_most_of_an_axis_of_odds_is_used_whatever_near_duplicates_there_are():
    rows = grouped_stimuli(60, 4)[0]
    rows[1] = rows[0] * (1 + 1e-9 * np.arange(30))
    filtration = model_of(rows).filtration_
    assert filtration.times_[0] < 1e-4
    scale = TimeScale.of(filtration)
    positions = scale.positions(filtration.times_)
    assert positions[0] == 0 and 0.6 < positions[-1] <= 1
    assert 0.2 < np.median(positions) < 0.8


@pytest.mark.parametrize(
    ("heat", "stop"),
    [("divergence", "persistence"), ("divergence", "annexations"), ("geodesic", "annexations")],
)
def test_annexations_per_step(heat, stop):
    filtration = model_of(grouped_stimuli(80, 5)[0], heat=heat, stop=stop).filtration_
    ends, counts = annexation_counts(filtration, TimeScale.of(filtration))
    slow, start = [], 0.0
    for end in ends:
        slow.append(sum(start + 1e-9 < time <= end + 1e-9 for time in filtration.times_))
        start = end
    assert counts == slow and sum(counts) == 79 and ends[-1] == 1
    if stop == "persistence":
        assert len(ends) == N_STEPS
        odds = np.log(np.array(ends[:-1]) / (1 - np.array(ends[:-1])))
        assert np.allclose(np.diff(odds), odds[1] - odds[0])
    else:
        assert ends == filtration.annexations()[0].tolist()


@pytest.mark.parametrize("kind", WITHOUT_CONCEPTS)
def test_an_axis_for_every_filtration(kind):
    model = model_of(WITHOUT_CONCEPTS[kind])
    contents = report_contents(model, [None] * len(WITHOUT_CONCEPTS[kind]), [], "", {})["filtration"]
    assert contents["axisEnds"] is None or 0 < contents["axisEnds"][0] < contents["axisEnds"][1] < 1
    assert sum(contents["stepCounts"]) == len(contents["edges"]) + len(contents["edgesBetween"])
    assert all(0 <= heat <= 1 for heat in contents["heat"])


def test_a_scan_is_the_hotter_the_later_it_has_a_neighbour():
    model = model_of(grouped_stimuli(50, 4)[0])
    filtration = model.filtration_
    contents = report_contents(model, [None] * 50, [], "", {})["filtration"]
    first = [
        min(t for t, e in zip(filtration.times_, filtration.edges_, strict=True) if v in e) for v in range(50)
    ]
    by_heat = np.argsort(contents["heat"], kind="stable")
    assert np.all(np.diff(np.array(first)[by_heat]) > -1e-3)
    assert min(contents["heat"]) == 0 and max(contents["heat"]) == 1
    labels = filtration.labels_[np.argsort(filtration.space_.vertices_)]
    between = [edge for edge in filtration.edges_.tolist() if labels[edge[0]] != labels[edge[1]]]
    assert contents["edgesBetween"] == between and len(between) == len(filtration.concepts_) - 1 > 0
    assert len(contents["edges"]) + len(between) == 49
