"""Odd objects, wrong objects and wrong parameters for the motif hierarchy ensemble."""

import numpy as np
import pytest
from motif_objects import (
    MotifColumns,
    assert_same_rows,
    assert_unchanged,
    described,
    fit_dictionary,
    segmented_objects,
    snapshot,
)
from motif_reference import SlowObject
from sklearn.exceptions import NotFittedError

from shapeconcepts import (
    DescribedObject,
    MotifHierarchyEnsemble,
    Scan,
    SegmentDictionary,
    describe,
)
from shapeconcepts.descriptors import Description


def test_object_without_any_match_has_an_empty_row(train):
    """A dictionary of two words, of which the training objects have one."""
    words = SegmentDictionary(1).fit([[1.0, 0, 0], [0.9, 0.1, 0], [0, 0, 1], [0, 0.1, 0.9]])
    known, unknown = [1.0, 0.1, 0.0], [0.0, 0.1, 1.0]
    model = MotifColumns(words).fit([described(SlowObject([known] * 2, {}, [(0, 1)]))] * 3)
    stranger = described(SlowObject([unknown] * 3, {}, [(0, 1), (1, 2)]))
    rows = model.transform([stranger, described(SlowObject([known, unknown], {}, [(0, 1)])), stranger])
    assert np.diff(rows.indptr).tolist() == [0, 1, 0]
    assert rows.shape == (3, 2) and rows[1].data == pytest.approx([1.0])
    explanation = model.explain(stranger)
    assert explanation.motifs == () and explanation.n_unknown == (6,)


def test_objects_without_mass(model):
    empty = described(SlowObject([[0.0] * 6] * 2, {}, [(0, 1)]))
    assert np.isfinite(model.transform([empty]).data).all()
    only = MotifColumns(fit_dictionary([empty], 1), bandwidth=0.5).fit([empty, empty])
    # Nothing is as far from nothing as can be: divergence 1.
    np.testing.assert_allclose(only.stimuli_.toarray(), np.exp(-1 / (2 * 0.5**2)))


def test_no_objects(model):
    rows = model.transform([])
    assert rows.shape == (0, len(model.columns_)) and rows.format == "csr"


@pytest.mark.parametrize("edges", [[], [[]], np.empty(0), np.empty((0, 2)), [[0, 1]], np.array([[1, 0]])])
def test_edges_as_people_write_them(model, edges):
    one = DescribedObject(Description(np.ones((2, 6))), edges)
    expected = DescribedObject(Description(np.ones((2, 6))), np.array(edges, np.int32).reshape(-1, 2))
    assert_same_rows(model.transform([one]), model.transform([expected]))
    twin = MotifColumns(model.dictionary_).fit([one, one])
    n_edges = np.size(edges) // 2
    # Both segments have the same word: in each of the three hierarchies the one vertex is linked to itself.
    assert len(twin.hierarchies_.edges) == 3 * n_edges


@pytest.mark.parametrize("bandwidth", [1e-200, 5e-324, 1e200, np.float32(0.1), 1])
def test_any_positive_bandwidth(dictionary, train, bandwidth):
    stimuli = MotifColumns(dictionary, bandwidth=bandwidth).fit(train).stimuli_
    assert ((stimuli.data > 0) & (stimuli.data <= 1)).all()
    if float(bandwidth) == 1e200:
        np.testing.assert_array_equal(stimuli.data, 1)


@pytest.mark.parametrize("width", [1e-200, 5e-324, 1e200, np.float32(0.1), 1])
def test_any_positive_width(dictionary, train, width):
    model = MotifHierarchyEnsemble(dictionary, width=width).fit(train)
    assert ((model.stimuli_.data > 0) & (model.stimuli_.data <= 1)).all()
    same = MotifHierarchyEnsemble(dictionary, width=float(width)).fit(train)
    assert_same_rows(model.stimuli_, same.stimuli_)
    if float(width) == 1e200:
        # Everything reminds of what it has anything in common with.
        hierarchies, roots = model.hierarchies_, np.sqrt(model.hierarchies_.prototypes)
        of_object = hierarchies.prototype_objects == np.arange(len(train))[:, None]
        expected = (of_object @ (roots @ roots.T > 0)) & ~of_object
        np.testing.assert_array_equal(model.stimuli_.toarray() > 0, expected)


POSITIVE = r"must be a float in the range \(0\.0, inf\)"
FROM_1 = r"must be an int in the range \[1, 2147483647\]"


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"bandwidth": 0}, rf"'bandwidth' parameter of MotifHierarchyEnsemble {POSITIVE}\. Got 0 instead"),
        ({"bandwidth": -1}, rf"'bandwidth' .* {POSITIVE}\. Got -1 instead"),
        ({"bandwidth": np.nan}, rf"'bandwidth' .* {POSITIVE}\. Got nan instead"),
        ({"bandwidth": np.inf}, rf"'bandwidth' .* {POSITIVE}\. Got inf instead"),
        ({"bandwidth": "a"}, rf"'bandwidth' .* {POSITIVE}\. Got 'a' instead"),
        ({"bandwidth": None}, rf"'bandwidth' .* {POSITIVE}\. Got None instead"),
        ({"bandwidth": True}, rf"'bandwidth' .* {POSITIVE}\. Got 'True' instead"),
        ({"width": 0}, rf"'width' parameter of MotifHierarchyEnsemble {POSITIVE}\. Got 0 instead"),
        ({"width": np.nan}, rf"'width' .* {POSITIVE}\. Got nan instead"),
        ({"width": None}, rf"'width' .* {POSITIVE}\. Got None instead"),
        ({"min_support": 0}, rf"'min_support' .* {FROM_1}\. Got 0 instead"),
        ({"min_support": 1.5}, rf"'min_support' .* {FROM_1}\. Got 1\.5 instead"),
        (
            {"columns": "words"},
            "'columns' .* must be a str among {('prototypes', 'motifs'|'motifs', 'prototypes')}. Got 'words'",
        ),
        ({"n_neighbours": 0}, rf"'n_neighbours' .* {FROM_1} or None\. Got 0 instead"),
        ({"n_neighbours": True}, rf"'n_neighbours' .* {FROM_1} or None\. Got 'True' instead"),
        ({"resolution": 0}, rf"'resolution' .* {POSITIVE}\. Got 0 instead"),
        ({"max_columns": 0}, rf"'max_columns' .* {FROM_1}\. Got 0 instead"),
        ({"leave_own_out": "no"}, "'leave_own_out' .* Got 'no' instead"),
        ({"n_jobs": 1.5}, r"'n_jobs' .* Got 1\.5 instead"),
        ({"dictionary": 3}, r"'dictionary' .* 'transform' or None\. Got 3 instead"),
        (
            {"dictionary": SegmentDictionary(0)},
            r"'n_levels' parameter of SegmentDictionary must be an int .* \[1, 16\]\. Got 0 instead",
        ),
        (
            {"dictionary": SegmentDictionary(1, "L3")},
            "'metric' parameter of SegmentDictionary must be a str among .* Got 'L3' instead",
        ),
    ],
)
def test_wrong_parameters_are_refused(train, parameters, message):
    model = MotifHierarchyEnsemble(**{"columns": "motifs", **parameters})
    for learn in (model.fit, model.partial_fit, model.fit_transform):
        with pytest.raises(ValueError, match=message):
            learn(train)
        assert not hasattr(model, "hierarchies_")


@pytest.mark.parametrize("wrong", ["sift", None])
def test_wrong_descriptors_are_refused(wrong):
    (one,) = segmented_objects(1)
    with pytest.raises(ValueError, match=r"descriptor must be one of ('[a-z+]+', )+.*") as error:
        describe(one, wrong)
    for name in ("fpfh", "surflet", "curvature", "surflet+fpfh", "surflet+fpfh+curvature"):
        assert repr(name) in str(error.value)
    assert str(error.value).endswith(f"got {wrong!r}")


@pytest.mark.parametrize("parameters", [{"bandwidth": 0}, {"bandwidth": "a"}])
def test_wrong_parameters_are_refused_when_more_is_learned(dictionary, train, new, parameters):
    """Until then they change nothing."""
    model = MotifColumns(dictionary).fit(train)
    rows, explanation, before = model.transform(new), model.explain(new[0]), snapshot(model.hierarchies_)
    model.set_params(**parameters)
    for learn in (model.fit, model.partial_fit, model.fit_transform):
        with pytest.raises(ValueError, match=r"'bandwidth' .* must be a float in the range"):
            learn(new)
    assert_unchanged(model.hierarchies_, before)
    assert_same_rows(model.transform(new), rows)
    assert model.explain(new[0]) == explanation
    assert_same_rows(model.stimuli_, MotifColumns(dictionary).fit(train).stimuli_)


@pytest.mark.parametrize("parameters", [{"bandwidth": 0.5}, {"leave_own_out": False}])
def test_training_rows_do_not_depend_on_when_they_are_asked_for(dictionary, train, parameters):
    asked, not_asked = (MotifColumns(dictionary).fit(train) for _ in range(2))
    before = asked.stimuli_
    assert before.nnz > 0
    assert_same_rows(asked.set_params(**parameters).stimuli_, before)
    assert_same_rows(not_asked.set_params(**parameters).stimuli_, before)
    # What is set takes effect when more is learned, asked before or not.
    expected = MotifColumns(dictionary, **parameters).fit(train).partial_fit(train[:3]).stimuli_
    for model in (asked, not_asked):
        assert_same_rows(model.partial_fit(train[:3]).stimuli_, expected)
    former = MotifColumns(dictionary).fit(train).partial_fit(train[:3]).stimuli_
    assert abs(expected - former).max() > 1e-3


def many_segments(n: int, n_bins: int = 6) -> DescribedObject:
    return DescribedObject(Description(np.ones((n, n_bins))), name="many")


@pytest.mark.parametrize(
    ("X", "message"),
    [
        ([Scan(np.zeros((3, 3)))], "DescribedObject, as `describe` makes them, got Scan at position 0"),
        (segmented_objects(1), "as `describe` makes them, got SegmentedObject at position 0"),
        (np.ones((4, 6)), "got ndarray at position 0"),
        ("abc", "got str at position 0"),
        ([many_segments(2), None], "got NoneType at position 1"),
        ([many_segments(17)], "many: expected 1 to 16 segments, got 17"),
        ([many_segments(0)], "expected 1 to 16 segments, got 0"),
        ([many_segments(2, n_bins=5)], "5 .*6 "),
    ],
    ids=["scan", "segmented", "array", "text", "none", "17 segments", "no segments", "bins"],
)
def test_wrong_objects_are_refused(dictionary, train, X, message):
    model = MotifColumns(dictionary)
    with pytest.raises(ValueError, match=message):
        model.fit(X)
    model.fit(train)
    for call in (model.transform, model.partial_fit):
        with pytest.raises(ValueError, match=message):
            call(X)
    with pytest.raises(ValueError, match=message.replace("position 1", "position 0")):
        model.explain(list(X)[-1])


def test_different_numbers_of_bins_are_refused():
    objects = [many_segments(2), many_segments(2), many_segments(2, n_bins=5)]
    with pytest.raises(ValueError, match="bins"):
        MotifColumns(SegmentDictionary(1)).fit(objects)


@pytest.mark.parametrize("learn", ["fit", "partial_fit", "fit_transform"])
def test_nothing_to_learn_from_is_refused(dictionary, learn):
    with pytest.raises(ValueError, match="at least one object"):
        getattr(MotifColumns(dictionary), learn)([])


def test_not_fitted(dictionary, train):
    model = MotifColumns(dictionary)
    for call in (
        lambda: model.transform(train),
        lambda: model.transform([]),
        lambda: model.explain(train[0]),
        lambda: model.stimuli_,
        model.get_feature_names_out,
    ):
        with pytest.raises(NotFittedError):
            call()
