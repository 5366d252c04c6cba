"""Constellations of segment graphs."""

import motif_reference
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motif_objects import GRAPHS, segment_graph, segments_of

from shapeconcepts import decompose


def levels_of(edges, n_segments: int) -> dict[frozenset, int]:
    constellations, motif_levels = decompose(edges, n_segments)
    assert constellations.dtype == np.int64 and motif_levels.dtype == np.int32
    assert constellations.shape == motif_levels.shape
    # Ordered by motif level, then by value; the segments first.
    assert np.array_equal(np.lexsort((constellations, motif_levels)), np.arange(len(constellations)))
    assert constellations[:n_segments].tolist() == [1 << segment for segment in range(n_segments)]
    level_of = {segments_of(c): int(level) for c, level in zip(constellations, motif_levels, strict=True)}
    assert len(level_of) == len(constellations), "a constellation counts twice"
    return level_of


def named(text: str) -> dict[frozenset, int]:
    """Constellations of motif level 1, 2 ... from "0 1 | 01"."""
    return {
        frozenset(map(int, constellation)): level
        for level, line in enumerate(text.split("|"), start=1)
        for constellation in line.split()
    }


@pytest.mark.parametrize(
    ("edges", "n_segments", "expected"),
    [
        pytest.param([], 0, "", id="nothing"),
        pytest.param([], 1, "0", id="one segment"),
        pytest.param([], 3, "0 1 2", id="no neighbours"),
        pytest.param([[1, 0]], 2, "0 1 | 01", id="two"),
        pytest.param([[0, 1], [1, 2]], 3, "0 1 2 | 01 12 | 012", id="chain of three"),
        pytest.param([[0, 1], [1, 2], [0, 2]], 3, "0 1 2 | 01 12 02 | 012", id="box of three faces"),
        pytest.param([[0, 1], [1, 2], [2, 3]], 4, "0 1 2 3 | 01 12 23 | 012 123 | 0123", id="chain of four"),
        pytest.param(
            # 012 and 234 share segment 2: five segments at the level of four.
            [[0, 1], [1, 2], [2, 3], [3, 4]],
            5,
            "0 1 2 3 4 | 01 12 23 34 | 012 123 234 | 0123 1234 01234",
            id="chain of five",
        ),
        pytest.param([[0, 1], [0, 2], [0, 3]], 4, "0 1 2 3 | 01 02 03 | 012 013 023 | 0123", id="star"),
        pytest.param(
            [[0, 1], [1, 2], [2, 3], [3, 0]],
            4,
            "0 1 2 3 | 01 12 23 03 | 012 123 023 013 | 0123",
            id="cycle of four",
        ),
        pytest.param([[0, 1], [2, 3], [3, 4]], 6, "0 1 2 3 4 5 | 01 23 34 | 234", id="three components"),
    ],
)
def test_known_graphs(edges, n_segments, expected):
    assert levels_of(edges, n_segments) == named(expected)


def test_random_graphs_against_the_reference():
    rng = np.random.default_rng(0)
    for trial in range(2500):
        n_segments = int(rng.integers(1, 8))
        edges = segment_graph(rng, GRAPHS[trial % len(GRAPHS)], n_segments)
        assert levels_of(edges, n_segments) == motif_reference.decompose(edges, n_segments), edges


@pytest.mark.parametrize("graph", ["sparse", "chain", "star", "cycle", "tree", "spider", "two parts"])
@pytest.mark.parametrize("n_segments", [9, 12])
def test_larger_graphs_against_the_reference(graph, n_segments):
    if (graph, n_segments) == ("star", 12):
        n_segments = 10
    edges = segment_graph(np.random.default_rng(n_segments), graph, n_segments)
    assert levels_of(edges, n_segments) == motif_reference.decompose(edges, n_segments)


def test_twelve_neighbours_of_each_other():
    edges = segment_graph(np.random.default_rng(0), "complete", 12)
    # Level l + 1 holds up to twice as many segments as level l, less the shared one.
    largest = {1: 1, 2: 2, 3: 3, 4: 5, 5: 9, 6: 12}
    level_of = levels_of(edges, 12)
    assert len(level_of) == 4095
    assert all(level == min(k for k, n in largest.items() if len(c) <= n) for c, level in level_of.items())


@settings(max_examples=50, deadline=None)
@given(st.data())
def test_names_order_and_repeats_of_edges_do_not_matter(data):
    n_segments = data.draw(st.integers(2, 7))
    pair = st.lists(st.integers(0, n_segments - 1), min_size=2, max_size=2, unique=True)
    edges = data.draw(st.lists(pair, max_size=12))
    new_name = data.draw(st.permutations(range(n_segments)))
    changed = data.draw(st.permutations([[new_name[b], new_name[a]] for a, b in edges] * 2))
    expected = {frozenset(new_name[s] for s in c): level for c, level in levels_of(edges, n_segments).items()}
    assert levels_of(changed, n_segments) == expected


def test_any_integer_type_and_order_in_memory():
    edges = np.array([[0, 1], [1, 2]])
    expected = levels_of(edges, 3)
    for same in (
        edges.astype(np.uint8),
        np.asfortranarray(edges),
        edges.tolist(),
        edges.astype(np.int16)[::-1],
    ):
        assert levels_of(same, 3) == expected


@pytest.mark.parametrize(
    ("edges", "n_segments", "message"),
    [
        ([], 17, "n_segments must be between 0 and 16, got 17"),
        ([], -1, "n_segments must be between 0 and 16, got -1"),
        ([[0, 2]], 2, r"segments 0 to 1, got \[\[0, 2\]\]"),
        ([[-1, 0]], 2, "segments 0 to 1"),
        ([[0, 1]], 0, "segments"),
        ([[1, 1]], 2, "two different segments"),
        ([[0.0, 1.0]], 2, "integers of shape"),
        ([[0, 1, 2]], 3, r"shape \(1, 3\)"),
        ([0, 1], 2, r"shape \(2,\)"),
    ],
)
def test_wrong_graphs_are_refused(edges, n_segments, message):
    with pytest.raises(ValueError, match=message):
        decompose(edges, n_segments)
