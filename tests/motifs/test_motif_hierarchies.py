"""The motif hierarchies as data and as graphs."""

import copy

import numpy as np
import pytest
from motif_objects import (
    assert_same_rows,
    assert_unchanged,
    snapshot,
)

from shapeconcepts import (
    DescribedObject,
    MotifHierarchyEnsemble,
)
from shapeconcepts.descriptors import Description


def test_hierarchies_never_change(dictionary, train, new):
    model = MotifHierarchyEnsemble(dictionary).fit(train)
    hierarchies, before = model.hierarchies_, snapshot(model.hierarchies_)
    words = [level.copy() for level in dictionary.words_]
    rows, names = model.transform(new), model.get_feature_names_out()
    for one in new:
        model.explain(one)
    assert model.hierarchies_ is hierarchies
    assert_unchanged(hierarchies, before)
    assert_same_rows(model.transform(new), rows)
    assert model.get_feature_names_out().tolist() == names.tolist()
    earlier = copy.copy(model)
    model.partial_fit(new)
    assert_unchanged(hierarchies, before)
    assert_same_rows(earlier.transform(new), rows)
    assert model.hierarchies_.n_objects == len(train) + len(new)
    for a, b in zip(words, dictionary.words_, strict=True):
        np.testing.assert_array_equal(a, b)


def test_refused_part_leaves_everything_as_it_was(dictionary, train, new):
    model = MotifHierarchyEnsemble(dictionary).fit(train)
    before, stimuli = snapshot(model.hierarchies_), model.stimuli_
    bad = DescribedObject(Description(np.ones((2, 6))), np.array([[0, 7]], np.int32))
    with pytest.raises(ValueError, match="segment_edges must name segments 0 to 1"):
        model.partial_fit([*new, bad])
    assert_unchanged(model.hierarchies_, before)
    assert_same_rows(model.stimuli_, stimuli)


def test_graph(model):
    hierarchies = model.hierarchies_
    n_nodes = n_edges = 0
    for level in (1, 2, 3):
        graph = hierarchies.graph(level)
        assert graph.graph["dictionary_level"] == level and not graph.is_directed()
        assert set(graph) == set(np.flatnonzero(hierarchies.dictionary_levels == level))
        for vertex, attributes in graph.nodes(data=True):
            behind = hierarchies.prototype_vertices[:, level - 1] == vertex
            assert attributes == {
                "words": hierarchies.motif(vertex),
                "motif_level": hierarchies.motif_levels[vertex],
                "n_prototypes": behind.sum(),
                "n_objects": len(set(hierarchies.prototype_objects[behind])),
            }
        expected = {
            (a, b) for a, b in hierarchies.edges.tolist() if hierarchies.dictionary_levels[a] == level
        }
        assert {tuple(sorted(edge)) for edge in graph.edges} == expected
        n_nodes, n_edges = n_nodes + graph.number_of_nodes(), n_edges + graph.number_of_edges()
    assert n_nodes == hierarchies.n_vertices and n_edges == len(hierarchies.edges)
    assert (np.diff(hierarchies.edges) == 0).any(), "no vertex is linked to itself"
    for level in (0, 4):
        with pytest.raises(ValueError, match=f"dictionary_level must be between 1 and 3, got {level}"):
            hierarchies.graph(level)


def test_prototypes_are_one_block_of_single_precision(model, train):
    prototypes = model.hierarchies_.prototypes
    assert prototypes.dtype == np.float32 and prototypes.flags.c_contiguous and prototypes.base is None
    assert model.hierarchies_.object_names == tuple(one.name for one in train)
