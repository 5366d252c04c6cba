"""Rows and learning of the motif hierarchy ensemble; what it computes is in test_motif_reference."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motif_objects import (
    MotifColumns,
    assert_same_rows,
    assert_unchanged,
    described,
    learned,
    motif_keys,
    rows_by_motif,
    segmented_objects,
    snapshot,
)
from motif_reference import SlowObject
from scipy.sparse import vstack

from shapeconcepts import (
    MotifHierarchyEnsemble,
    SegmentDictionary,
    describe,
)

few_words_are_no_news = pytest.mark.filterwarnings("ignore:.*different segment descriptions give")
N_TRAIN = 24


def assert_close_rows(a: list[dict], b: list[dict], tolerance: float) -> None:
    assert len(a) == len(b)
    for one, other in zip(a, b, strict=True):
        for motif in one.keys() | other.keys():
            assert abs(one.get(motif, 0.0) - other.get(motif, 0.0)) <= tolerance, motif


def assert_same_learned(a: MotifHierarchyEnsemble, b: MotifHierarchyEnsemble) -> None:
    assert learned(a.hierarchies_) == learned(b.hierarchies_)
    assert a.get_feature_names_out().tolist() == b.get_feature_names_out().tolist()
    assert a.hierarchies_.object_names == b.hierarchies_.object_names


def test_rows_are_sparse_stimuli(model, new):
    rows = model.transform(new)
    assert rows.format == "csr" and rows.dtype == np.float64
    assert rows.shape == (len(new), len(model.columns_))
    assert rows.has_sorted_indices
    assert rows.data.min() >= 1e-6 and rows.data.max() <= 1
    assert 0 < rows.nnz < np.prod(rows.shape)


def test_row_is_the_same_alone_and_in_any_batch(model, train, new):
    rows = model.transform(new)
    assert_same_rows(vstack([model.transform([one]) for one in new], format="csr"), rows)
    order = np.random.default_rng(0).permutation(len(new))
    assert_same_rows(model.transform([new[i] for i in order]), rows[order])
    assert_same_rows(model.transform(train + new + train)[N_TRAIN : N_TRAIN + len(new)], rows)
    assert_same_rows(model.transform(iter(new)), rows)


@pytest.mark.parametrize("descriptor", ["fpfh", "surflet"])
@few_words_are_no_news
def test_number_of_jobs_does_not_matter(descriptor):
    objects = [describe(one, descriptor) for one in segmented_objects(30)]
    models = [
        MotifColumns(SegmentDictionary(3), bandwidth=0.3, n_jobs=n_jobs).fit(objects[:20])
        for n_jobs in (None, 1, 2)
    ]
    for other in models[1:]:
        assert_same_rows(other.stimuli_, models[0].stimuli_)
        assert_same_rows(other.transform(objects[20:]), models[0].transform(objects[20:]))
        assert_unchanged(other.hierarchies_, snapshot(models[0].hierarchies_))
    assert models[0].transform(objects[20:]).nnz > 20


def test_order_of_training_objects_does_not_matter(model, dictionary, train, new):
    order = np.random.default_rng(1).permutation(N_TRAIN)
    other = MotifColumns(dictionary).fit([train[i] for i in order])
    assert other.get_feature_names_out().tolist() == model.get_feature_names_out().tolist()
    levels, prototypes, edges = learned(model.hierarchies_)
    other_levels, other_prototypes, other_edges = learned(other.hierarchies_)
    assert (levels, edges) == (other_levels, other_edges)
    for motif, counts in other_prototypes.items():
        assert {(order[index], segments) for index, segments in counts} == set(prototypes[motif])
    assert_same_rows(other.transform(new), model.transform(new))
    assert_same_rows(other.stimuli_, model.stimuli_[order])


@few_words_are_no_news
def test_order_of_training_objects_does_not_matter_to_a_learned_dictionary(train, new):
    order = np.random.default_rng(2).permutation(N_TRAIN)
    a = MotifColumns(SegmentDictionary(4)).fit(train)
    b = MotifColumns(SegmentDictionary(4)).fit([train[i] for i in order])
    assert [w.tobytes() for w in a.dictionary_.words_] == [w.tobytes() for w in b.dictionary_.words_]
    assert a.get_feature_names_out().tolist() == b.get_feature_names_out().tolist()
    assert_same_rows(a.transform(new), b.transform(new))
    assert_same_rows(a.stimuli_[order], b.stimuli_)


def renamed(slow: SlowObject, new_name: list[int]) -> SlowObject:
    segments: list = [None] * len(new_name)
    for old, name in enumerate(new_name):
        segments[name] = slow.segments[old]
    return SlowObject(
        segments,
        {tuple(sorted((new_name[a], new_name[b]))): mass for (a, b), mass in slow.pairs.items()},
        [(new_name[b], new_name[a]) for a, b in slow.edges],
    )


def test_names_of_segments_do_not_matter(model, slow_objects):
    rng = np.random.default_rng(3)
    for slow in slow_objects:
        other = renamed(slow, rng.permutation(len(slow.segments)).tolist())
        a, b = (rows_by_motif(model, model.transform([described(one)])) for one in (slow, other))
        assert_close_rows(a, b, 1e-6)


@settings(max_examples=25, deadline=None)
@given(cuts=st.sets(st.integers(1, N_TRAIN - 1)), ask_between=st.booleans())
def test_learning_in_parts_is_learning_at_once(model, dictionary, train, new, cuts, ask_between):
    parts = np.split(np.arange(N_TRAIN), sorted(cuts))
    other = MotifColumns(dictionary)
    for part in parts:
        other.partial_fit([train[i] for i in part])
        if ask_between:
            assert other.stimuli_.shape == (part[-1] + 1, len(other.columns_))
            other.transform(new)
    assert_same_learned(other, model)
    np.testing.assert_array_equal(other.hierarchies_.prototypes, model.hierarchies_.prototypes)
    assert_same_rows(other.stimuli_, model.stimuli_)
    assert_same_rows(other.transform(new), model.transform(new))


@few_words_are_no_news
def test_first_part_learns_the_dictionary(train, new):
    first = MotifColumns(SegmentDictionary(3)).fit(train[:9])
    parts = MotifColumns(SegmentDictionary(3)).partial_fit(train[:9])
    learned_words = parts.dictionary_
    parts.partial_fit(train[9:])
    assert parts.dictionary_ is learned_words
    for a, b in zip(first.dictionary_.words_, learned_words.words_, strict=True):
        np.testing.assert_array_equal(a, b)
    whole = MotifColumns(first.dictionary_).fit(train)
    assert_same_learned(parts, whole)
    assert abs(parts.transform(new) - whole.transform(new)).max() < 1e-12


def test_fit_forgets(model, dictionary, train, new):
    again = MotifColumns(dictionary).fit(new).fit(train)
    assert_same_learned(again, model)
    assert_same_rows(again.stimuli_, model.stimuli_)


def test_training_rows_leave_own_prototypes_out(model, dictionary, train):
    assert abs(model.stimuli_ - model.transform(train)).max() > 1e-3
    left_in = MotifColumns(dictionary, leave_own_out=False).fit(train)
    assert_same_rows(left_in.stimuli_, left_in.transform(train))
    # Without a single training object, the others' hierarchies give its row.
    for index in (0, 5, 11):
        others = MotifColumns(dictionary, min_support=1).fit(train[:index] + train[index + 1 :])
        (expected,) = rows_by_motif(others, others.transform([train[index]]))
        (actual,) = rows_by_motif(model, model.stimuli_[index])
        keys = motif_keys(model.hierarchies_)
        columns = {keys[vertex] for vertex in model.columns_}
        assert_close_rows([actual], [{k: v for k, v in expected.items() if k in columns}], 1e-12)


def test_support(dictionary, train):
    for min_support in (1, 2, 4, len(train) + 1):
        model = MotifColumns(dictionary, min_support=min_support).fit(train)
        support = np.diff(model.hierarchies_.prototypes_of.starts) * 0
        for motifs in model.hierarchies_.prototype_vertices.T:
            for vertex in np.unique(motifs):
                support[vertex] = len(set(model.hierarchies_.prototype_objects[motifs == vertex]))
        np.testing.assert_array_equal(model.hierarchies_.support, support)
        np.testing.assert_array_equal(np.sort(model.columns_), np.flatnonzero(support >= min_support))
        assert model.transform(train).shape == model.stimuli_.shape == (len(train), len(model.columns_))


def test_names_of_columns(model):
    names = model.get_feature_names_out()
    assert names.dtype == object and len(names) == model.stimuli_.shape[1]
    assert len(set(names)) == len(names)
    hierarchies, order = model.hierarchies_, []
    for name, vertex in zip(names, model.columns_, strict=True):
        level, motif_level, *words = name.split()
        assert level == f"d{hierarchies.dictionary_levels[vertex]}"
        assert motif_level == f"m{hierarchies.motif_levels[vertex]}"
        assert tuple(int(word.removeprefix("w")) for word in words) == hierarchies.motif(vertex)
        order.append((int(level[1:]), len(words), hierarchies.motif(vertex)))
    assert order == sorted(order)
