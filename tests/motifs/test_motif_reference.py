"""Hierarchies and stimuli against the slow reference, over thousands of random objects."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motif_objects import (
    GRAPHS,
    MotifColumns,
    adversarial_objects,
    described,
    fit_dictionary,
    kinds_of_segments,
    learned,
    random_object,
    random_objects,
    rows_by_motif,
    segments_of,
)
from motif_reference import SlowEnsemble, SlowObject, jensen_shannon, prototypes_by_vertex, without_ties
from scipy.spatial.distance import jensenshannon

from shapeconcepts import SegmentDictionary


def slow_twin(dictionary: SegmentDictionary, bandwidth: float) -> SlowEnsemble:
    return SlowEnsemble([words.tolist() for words in dictionary.words_], dictionary.metric, bandwidth)


def assert_same_hierarchies(hierarchies, slow: SlowEnsemble, objects: list[SlowObject]) -> None:
    levels, prototypes, edges = learned(hierarchies)
    assert levels == {motif: vertex.motif_level for motif, vertex in slow.vertices.items()}
    assert prototypes == prototypes_by_vertex(slow)
    assert edges == slow.edges
    assert hierarchies.prototypes.dtype == np.float32 and hierarchies.prototypes.flags.c_contiguous
    expected = [
        objects[index].histogram(segments_of(constellation))
        for index, constellation in zip(
            hierarchies.prototype_objects, hierarchies.prototype_constellations, strict=True
        )
    ]
    np.testing.assert_allclose(hierarchies.prototypes, expected, rtol=0, atol=1e-6)


def assert_same_stimuli(actual: dict, expected: dict, columns: set) -> None:
    """Columns have the reference's stimuli; what is under 1e-6 is not stored."""
    assert actual.keys() <= columns
    assert all(1e-6 <= value <= 1 for value in actual.values())
    for motif in columns:
        assert abs(actual.get(motif, 0.0) - expected.get(motif, 0.0)) <= 1e-6, motif


def compare(
    train: list[SlowObject],
    new: list[SlowObject],
    dictionary: SegmentDictionary,
    *,
    bandwidth: float = 0.1,
    leave_own_out: bool = True,
    min_support: int = 2,
) -> tuple[int, int]:
    """Compare everything; return how many objects took part, and how many stimuli they had."""
    slow = slow_twin(dictionary, bandwidth)
    train, new = without_ties(slow, train), without_ties(slow, new)
    if not train:
        return 0, 0
    for one in train:
        slow.learn(one)
    model = MotifColumns(
        dictionary, bandwidth=bandwidth, leave_own_out=leave_own_out, min_support=min_support
    )
    model.fit([described(one) for one in train])
    assert_same_hierarchies(model.hierarchies_, slow, train)
    columns = slow.supported(min_support)
    actual_rows = rows_by_motif(model, model.stimuli_)
    for index, (one, actual) in enumerate(zip(train, actual_rows, strict=True)):
        expected = slow.stimuli(one, left_out=index if leave_own_out else None)
        assert_same_stimuli(actual, expected, columns)
    rows = rows_by_motif(model, model.transform([described(one) for one in new]))
    for one, actual in zip(new, rows, strict=True):
        assert_same_stimuli(actual, slow.stimuli(one), columns)
    return len(train) + len(new), sum(map(len, actual_rows + rows))


@pytest.mark.parametrize("metric", ["hellinger", "euclidean"])
@pytest.mark.parametrize("with_pairs", [False, True], ids=["segments", "pairs"])
def test_random_objects(metric, with_pairs):
    rng = np.random.default_rng([with_pairs, metric == "euclidean"])
    n_objects = n_stimuli = 0
    for trial in range(75):
        kinds = kinds_of_segments(rng, n_kinds=int(rng.integers(1, 6)), n_bins=int(rng.integers(2, 8)))
        train = random_objects(rng, 7, kinds, 5, with_pairs=with_pairs)
        new = random_objects(rng, 4, kinds, 5, with_pairs=with_pairs)
        counts = compare(
            train,
            new,
            fit_dictionary([described(one) for one in train], int(rng.integers(1, 4)), metric),
            bandwidth=(0.025, 0.1, 0.5)[trial % 3],
            leave_own_out=trial % 4 != 0,
            min_support=(2, 1, 3)[trial % 3],
        )
        n_objects, n_stimuli = n_objects + counts[0], n_stimuli + counts[1]
    assert n_objects > 700 and n_stimuli > 4000


@pytest.mark.parametrize("graph", GRAPHS)
def test_every_graph_with_more_segments(graph):
    rng = np.random.default_rng(GRAPHS.index(graph))
    kinds = kinds_of_segments(rng, n_kinds=2)
    n_segments = [6, 7] if graph in ("random", "complete", "star") else [7, 9, 10]
    objects = [random_object(rng, kinds, n, graph, with_pairs=n == 7) for n in n_segments for _ in range(2)]
    dictionary = fit_dictionary([described(one) for one in objects], 2)
    n_compared, n_stimuli = compare(objects[::2], objects[1::2], dictionary, bandwidth=0.3, min_support=1)
    assert n_compared >= 3 and n_stimuli > 10


def test_motif_level_is_the_smallest_seen():
    """Nine equal segments: a chain is whole at level 5, a spider with legs of 3, 3 and 2 at level 6."""
    mass = [1.0, 2.0]
    spider_edges = [(0, 1), (1, 2), (2, 3), (0, 4), (4, 5), (5, 6), (0, 7), (7, 8)]
    chain = SlowObject([mass] * 9, {}, [(a, a + 1) for a in range(8)])
    spider = SlowObject([mass] * 9, {}, spider_edges)
    dictionary = fit_dictionary([described(chain)], 1)
    for objects, level in (([spider], 6), ([chain], 5), ([spider, chain], 5), ([chain, spider], 5)):
        compare(objects, [chain, spider], dictionary, min_support=1)
        model = MotifColumns(dictionary, min_support=1).fit([described(one) for one in objects])
        assert model.get_feature_names_out()[-1] == f"d1 m{level} " + " ".join(["w0"] * 9)


@settings(max_examples=100, deadline=None)
@given(
    objects=adversarial_objects(),
    bandwidth=st.sampled_from([0.025, 0.2, 3.0]),
    min_support=st.integers(1, 2),
    leave_own_out=st.booleans(),
)
def test_any_object(objects, bandwidth, min_support, leave_own_out):
    dictionary = fit_dictionary([described(one) for one in objects], 2)
    compare(
        objects,
        objects,
        dictionary,
        bandwidth=bandwidth,
        min_support=min_support,
        leave_own_out=leave_own_out,
    )


def test_reference_divergence_is_the_known_one():
    rng = np.random.default_rng(0)
    for _ in range(200):
        p, q = rng.dirichlet(np.full(7, 0.3), 2) * (rng.random((2, 7)) < 0.8) + [[1e-3] + [0] * 6] * 2
        p, q = p / p.sum(), q / q.sum()
        assert jensen_shannon(p.tolist(), q.tolist()) == pytest.approx(
            jensenshannon(p, q, base=2) ** 2, abs=1e-12
        )
