"""Explanations of stimuli of single prototypes, against the rows of transform and the slow reference."""

from itertools import pairwise

import numpy as np
import pytest
from motif_objects import (
    described,
    fit_dictionary,
    kinds_of_segments,
    motif_keys,
    random_objects,
    segments_of,
)
from motif_reference import SlowEnsemble, SlowObject, jensen_shannon
from prototype_reference import SlowField, constellations_of

from shapeconcepts import MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.motifs.explanation import N_CLOSEST

N_TRAIN = 20


@pytest.fixture(scope="module")
def slow_objects() -> list[SlowObject]:
    rng = np.random.default_rng(12)
    return random_objects(rng, N_TRAIN + 10, kinds_of_segments(rng, 3), 4, with_pairs=True)


@pytest.fixture(scope="module")
def model(slow_objects) -> MotifHierarchyEnsemble:
    train = [described(one, f"object {index}") for index, one in enumerate(slow_objects[:N_TRAIN])]
    return MotifHierarchyEnsemble(fit_dictionary(train, 3), n_neighbours=4, resolution=0.01).fit(train)


@pytest.fixture(scope="module")
def slow(model) -> SlowEnsemble:
    dictionary = model.dictionary_
    return SlowEnsemble([words.tolist() for words in dictionary.words_], dictionary.metric, 1.0)


@pytest.fixture(scope="module")
def slow_field(slow_objects, slow) -> SlowField:
    return SlowField([constellations_of(one, slow) for one in slow_objects[:N_TRAIN]], 4, resolution=0.01)


@pytest.fixture(params=range(0, N_TRAIN + 10, 2))
def slow_object(request, slow_objects) -> SlowObject:
    """Two in three are training objects, which are explained as if they were new."""
    return slow_objects[request.param]


def prototype_of(model: MotifHierarchyEnsemble, column: int) -> tuple:
    hierarchies = model.hierarchies_
    index = int(hierarchies.prototype_objects[column])
    return index, segments_of(hierarchies.prototype_constellations[column])


def test_stimuli_are_those_of_the_reference(model, slow, slow_field, slow_object):
    """One entry for each constellation that stimulates any prototype, with the strongest of them."""
    parts = {one.segments: one for one in constellations_of(slow_object, slow)}
    explanation = model.explain(described(slow_object))
    explained = [frozenset(motif.segments) for motif in explanation.motifs]
    assert explanation.n_constellations == len(parts) and len(set(explained)) == len(explained)
    for segments in parts.keys() - set(explained):
        assert all(bounds.low == 0 for bounds in slow_field.stimuli(parts[segments]).values())
    for motif, segments in zip(explanation.motifs, explained, strict=True):
        stimuli = slow_field.stimuli(parts[segments])
        assert stimuli[prototype_of(model, motif.column)].hold(motif.stimulus)
        assert motif.stimulus >= max(bounds.low for bounds in stimuli.values()) - 1e-9
        assert sum(b.low > 0 for b in stimuli.values()) <= motif.n_prototypes
        assert motif.n_prototypes <= sum(b.high > 0 for b in stimuli.values())


def test_row_is_there_where_anything_is_explained(model, slow_object):
    (row,) = model.transform([described(slow_object)]).toarray()
    explanation = model.explain(described(slow_object))
    assert row.sum() == pytest.approx(len(explanation.motifs) / explanation.n_constellations, abs=1e-9)
    assert max((motif.n_prototypes for motif in explanation.motifs), default=0) <= np.count_nonzero(row)
    for motif in explanation.motifs:
        # The strongest of n has at least an n-th of its constellation's share.
        assert row[motif.column] >= 1 / motif.n_prototypes / explanation.n_constellations - 1e-9


def test_object_of_one_constellation_has_its_stimuli_as_row(model, slow, slow_field):
    rng = np.random.default_rng(0)
    for one in random_objects(rng, 20, kinds_of_segments(rng, 3), 1):
        (row,) = model.transform([described(one)]).toarray()
        explanation = model.explain(described(one))
        if not explanation.motifs:
            assert not row.any()
            continue
        (motif,) = explanation.motifs
        assert motif.n_prototypes == np.count_nonzero(row) and motif.column == row.argmax()
        (part,) = constellations_of(one, slow)
        for key, bounds in slow_field.stimuli(part).items():
            column = [prototype_of(model, c) for c in range(len(row))].index(key)
            # Shares of one sum are to each other as the stimuli are.
            value = row[column] / row[motif.column] * motif.stimulus
            assert bounds.low - 1e-6 <= value <= bounds.high + 1e-6


def test_strongest_first_then_the_one_of_more_segments(model, slow_object):
    motifs = model.explain(described(slow_object)).motifs
    order = [(-motif.stimulus, -len(motif.segments), motif.column) for motif in motifs]
    assert order == sorted(order)


def test_motif_is_the_finest_that_is_shared(model, slow, slow_field, slow_object):
    keys, hierarchies = motif_keys(model.hierarchies_), model.hierarchies_
    parts = {one.segments: one for one in constellations_of(slow_object, slow)}
    prototypes = {(index, one.segments): one for index, one in slow_field.prototypes}
    for motif in model.explain(described(slow_object)).motifs:
        ours = parts[frozenset(motif.segments)].motifs
        theirs = prototypes[prototype_of(model, motif.column)].motifs
        shared = [a for a, b in zip(ours, theirs, strict=True) if a == b]
        if shared:
            assert (motif.dictionary_level, motif.words) == shared[-1] == keys[motif.vertex]
            assert motif.name == hierarchies.name(motif.vertex)
        else:
            assert (motif.vertex, motif.name, motif.dictionary_level, motif.words) == (-1, "d0", 0, ())


def test_closest_are_those_of_largest_stimulus(model, slow, slow_field, slow_objects, slow_object):
    parts = {one.segments: one for one in constellations_of(slow_object, slow)}
    for motif in model.explain(described(slow_object)).motifs:
        part = parts[frozenset(motif.segments)]
        stimuli = slow_field.stimuli(part)
        assert prototype_of(model, motif.column) == (
            motif.closest[0].object_index,
            frozenset(motif.closest[0].segments),
        )
        shown = [stimuli[one.object_index, frozenset(one.segments)] for one in motif.closest]
        indices = [one.object_index for one in motif.closest]
        assert len(set(indices)) == len(indices)
        for stronger, weaker in pairwise(shown):
            assert stronger.high >= weaker.low
        # None of the others is stronger than what is shown of its object, or than the last that is shown.
        for (index, _), bounds in stimuli.items():
            if index in indices:
                assert bounds.low <= shown[indices.index(index)].high
            elif len(shown) == N_CLOSEST:
                assert bounds.low <= shown[-1].high
            else:
                assert bounds.low == 0
        for one in motif.closest:
            assert one.object_name == f"object {one.object_index}"
            theirs = slow_objects[one.object_index].histogram(frozenset(one.segments))
            assert one.divergence == pytest.approx(jensen_shannon(part.histogram, theirs), abs=1e-6)


def test_constellations_of_unknown_motifs_are_counted(model, slow, slow_field, slow_object):
    known = {motif for _, prototype in slow_field.prototypes for motif in prototype.motifs}
    parts = constellations_of(slow_object, slow)
    expected = [sum(part.motifs[level] not in known for part in parts) for level in range(3)]
    assert model.explain(described(slow_object)).n_unknown == tuple(expected)


def test_object_without_any_match(model):
    for stranger in (
        SlowObject([[0.0] * 6] * 2, {}, [(0, 1)]),
        SlowObject([[0.0] * 6], {}, []),
    ):
        explanation = model.explain(described(stranger))
        assert explanation.motifs == () and explanation.n_constellations == len(stranger.segments) * 2 - 1
        assert model.transform([described(stranger)]).nnz == 0
    words = SegmentDictionary(1).fit([[1.0, 0, 0], [0.9, 0.1, 0], [0, 0, 1], [0, 0.1, 0.9]])
    known = described(SlowObject([[1.0, 0.1, 0.0]], {}, []))
    stranger = described(SlowObject([[0.0, 0.0, 1.0]] * 2, {}, [(0, 1)]))
    explanation = MotifHierarchyEnsemble(words).fit([known] * 3).explain(stranger)
    assert explanation.motifs == () and explanation.n_unknown == (3,)


def test_fields_are_plain_python(model, slow_object):
    explanation = model.explain(described(slow_object))
    assert type(explanation.n_constellations) is int
    assert all(type(n) is int for n in explanation.n_unknown)
    for motif in explanation.motifs:
        for name in ("column", "vertex", "dictionary_level", "motif_level", "n_prototypes"):
            assert type(getattr(motif, name)) is int, name
        assert type(motif.stimulus) is float and type(motif.name) is str
        for one in motif.closest:
            assert type(one.object_index) is int and type(one.divergence) is float
            assert all(type(segment) is int for segment in one.segments)


def test_there_is_something_to_explain(model, slow_objects):
    explanations = [model.explain(described(one)) for one in slow_objects]
    motifs = [motif for explanation in explanations for motif in explanation.motifs]
    assert len(motifs) > 100
    assert {len(motif.closest) for motif in motifs} >= {1, 3, 5}
    assert min(motif.dictionary_level for motif in motifs) == 0
    assert any(sum(explanation.n_unknown) > 0 for explanation in explanations)
    # The order by stimulus is not that by divergence.
    assert any(a.divergence > b.divergence for motif in motifs for a, b in pairwise(motif.closest))
