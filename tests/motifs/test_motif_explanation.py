"""Explanations of stimuli, against the rows of transform and the slow reference."""

import math

import numpy as np
import pytest
from motif_objects import MotifColumns, described, fit_dictionary, kinds_of_segments, random_objects
from motif_reference import SlowEnsemble, SlowObject, decompose, jensen_shannon

from shapeconcepts import MotifHierarchyEnsemble
from shapeconcepts.motifs import FiredMotif

N_TRAIN = 20
BANDWIDTH = 0.2


@pytest.fixture(scope="module")
def slow_objects() -> list[SlowObject]:
    rng = np.random.default_rng(11)
    return random_objects(rng, N_TRAIN + 10, kinds_of_segments(rng, 2), with_pairs=True)


@pytest.fixture(scope="module")
def model(slow_objects) -> MotifHierarchyEnsemble:
    train = [described(one, f"object {index}") for index, one in enumerate(slow_objects[:N_TRAIN])]
    return MotifColumns(fit_dictionary(train, 3), bandwidth=BANDWIDTH).fit(train)


@pytest.fixture(scope="module")
def slow_model(model, slow_objects) -> SlowEnsemble:
    dictionary = model.dictionary_
    slow = SlowEnsemble([words.tolist() for words in dictionary.words_], dictionary.metric, BANDWIDTH)
    for one in slow_objects[:N_TRAIN]:
        slow.learn(one)
    return slow


@pytest.fixture(params=range(0, N_TRAIN + 10, 2))
def slow_object(request, slow_objects) -> SlowObject:
    """Half of them training objects, which are explained as if they were new."""
    return slow_objects[request.param]


def test_stimuli_are_the_row(model, slow_object):
    row = model.transform([described(slow_object)])
    explanation = model.explain(described(slow_object))
    assert {motif.column: motif.stimulus for motif in explanation.motifs} == dict(
        zip(row.indices.tolist(), row.data.tolist(), strict=True)
    )
    assert len(explanation.motifs) == row.nnz


def test_strongest_first_then_the_one_of_more_segments(model, slow_object):
    motifs = model.explain(described(slow_object)).motifs
    order = [(-motif.stimulus, -len(motif.segments)) for motif in motifs]
    assert order == sorted(order)


def test_equal_stimuli_are_ordered_by_number_of_segments():
    """Three objects that are all the same: every stimulus is 1."""
    one = described(SlowObject([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]], {}, [(0, 1), (1, 2)]))
    explanation = MotifColumns(fit_dictionary([one], 1)).fit([one] * 3).explain(one)
    assert [motif.stimulus for motif in explanation.motifs] == [1.0] * len(explanation.motifs)
    assert [len(motif.segments) for motif in explanation.motifs] == [3, 2, 2, 1, 1]


def test_motifs_are_those_of_the_hierarchies(model, slow_model, slow_object):
    names, hierarchies = model.get_feature_names_out(), model.hierarchies_
    for motif in model.explain(described(slow_object)).motifs:
        assert motif.vertex == model.columns_[motif.column]
        assert motif.name == names[motif.column]
        assert motif.words == hierarchies.motif(motif.vertex)
        assert motif.dictionary_level == hierarchies.dictionary_levels[motif.vertex]
        vertex = slow_model.vertices[motif.dictionary_level, motif.words]
        assert motif.motif_level == vertex.motif_level
        assert motif.n_prototypes == len(vertex.prototypes)


def test_segments_have_the_words_and_the_stimulus(slow_model, model, slow_object):
    words_of = slow_model.words_of(slow_object)
    constellations = decompose(slow_object.edges, len(slow_object.segments))
    for motif in model.explain(described(slow_object)).motifs:
        segments = frozenset(motif.segments)
        assert motif.segments == tuple(sorted(segments)) and segments in constellations
        words = sorted(words_of[motif.dictionary_level - 1][segment] for segment in segments)
        assert motif.words == tuple(words)
        histogram = slow_object.histogram(segments)
        prototypes = slow_model.vertices[motif.dictionary_level, motif.words].prototypes
        kernels = [
            math.exp(-(jensen_shannon(histogram, prototype.histogram) ** 2) / (2 * BANDWIDTH**2))
            for prototype in prototypes
        ]
        assert motif.stimulus == pytest.approx(sum(kernels) / len(kernels), abs=1e-6)


def closest(motif: FiredMotif, slow_model: SlowEnsemble, slow_object: SlowObject) -> dict[int, float]:
    """Smallest divergence from each training object's prototypes, rising."""
    histogram = slow_object.histogram(frozenset(motif.segments))
    smallest: dict[int, float] = {}
    for prototype in slow_model.vertices[motif.dictionary_level, motif.words].prototypes:
        divergence = jensen_shannon(histogram, prototype.histogram)
        index = prototype.object_index
        smallest[index] = min(divergence, smallest.get(index, 1.0))
    return dict(sorted(smallest.items(), key=lambda item: item[1]))


def test_closest_prototypes(model, slow_model, slow_object, slow_objects):
    for motif in model.explain(described(slow_object)).motifs:
        histogram = slow_object.histogram(frozenset(motif.segments))
        expected = closest(motif, slow_model, slow_object)
        divergences = [one.divergence for one in motif.closest]
        assert divergences == sorted(divergences)
        assert len(motif.closest) == min(5, len(expected))
        np.testing.assert_allclose(divergences, list(expected.values())[:5], rtol=0, atol=1e-6)
        assert len({one.object_index for one in motif.closest}) == len(motif.closest)
        for one in motif.closest:
            assert one.object_name == f"object {one.object_index}"
            segments = frozenset(one.segments)
            assert any(
                prototype.object_index == one.object_index and prototype.segments == segments
                for prototype in slow_model.vertices[motif.dictionary_level, motif.words].prototypes
            )
            source = slow_objects[one.object_index]
            assert one.divergence == pytest.approx(
                jensen_shannon(histogram, source.histogram(segments)), abs=1e-6
            )


def test_training_object_finds_itself(model, slow_objects):
    for index in (0, 3, 7):
        for motif in model.explain(described(slow_objects[index])).motifs:
            if any(slow_objects[index].histogram(frozenset(motif.segments))):
                assert motif.closest[0].divergence == 0
                itself = [one for one in motif.closest if one.object_index == index]
                assert not itself or itself[0].divergence == 0


def test_every_constellation_fires_or_is_unknown(model, slow_model, slow_object):
    explanation = model.explain(described(slow_object))
    assert explanation.n_constellations == len(decompose(slow_object.edges, len(slow_object.segments)))
    assert len(explanation.n_unknown) == 3
    supported = slow_model.supported(2)
    for n_unknown, motif_of in zip(explanation.n_unknown, slow_model.motifs_of(slow_object), strict=True):
        assert n_unknown == sum(motif not in supported for motif in motif_of.values())


def test_fields_are_plain_python(model, slow_object):
    explanation = model.explain(described(slow_object))
    assert type(explanation.n_constellations) is int
    assert all(type(n) is int for n in explanation.n_unknown)
    for motif in explanation.motifs:
        for name in ("column", "vertex", "dictionary_level", "motif_level", "n_prototypes"):
            assert type(getattr(motif, name)) is int, name
        assert type(motif.stimulus) is float and type(motif.name) is str
        assert all(type(word) is int for word in motif.words)
        for one in motif.closest:
            assert type(one.object_index) is int and type(one.divergence) is float


def test_there_is_something_to_explain(model, slow_objects):
    """The tests above loop over motifs: most objects have some, of several segments, and unknown ones."""
    explanations = [model.explain(described(one)) for one in slow_objects]
    assert sum(bool(explanation.motifs) for explanation in explanations) > 25
    assert max(len(motif.segments) for e in explanations for motif in e.motifs) >= 3
    assert max(len(motif.closest) for e in explanations for motif in e.motifs) == 5
    assert any(sum(explanation.n_unknown) > 0 for explanation in explanations)
