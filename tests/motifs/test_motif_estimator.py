"""The motif hierarchy ensemble among other estimators, and with other descriptors."""

import pickle

import numpy as np
import pytest
from motif_objects import (
    MotifColumns,
    assert_same_rows,
    segmented_objects,
)
from sklearn.base import clone
from sklearn.frozen import FrozenEstimator
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.svm import SVC

from shapeconcepts import (
    MotifHierarchyEnsemble,
    SegmentDictionary,
    ShapeConceptModel,
    describe,
)
from shapeconcepts.descriptors import Description

few_words_are_no_news = pytest.mark.filterwarnings("ignore:.*different segment descriptions give")


@few_words_are_no_news
def test_clone_and_parameters(dictionary, train):
    model = MotifHierarchyEnsemble(
        SegmentDictionary(3),
        "motifs",
        7,
        width=0.5,
        bandwidth=0.2,
        leave_own_out=False,
        min_support=3,
        n_occlusions=1,
        n_jobs=2,
    )
    copied = clone(model.fit(train))
    parameters, expected = copied.get_params(), model.get_params()
    assert parameters.pop("dictionary").n_levels == expected.pop("dictionary").n_levels == 3
    assert parameters == expected
    assert expected == {
        "bandwidth": 0.2,
        "columns": "motifs",
        "dictionary__metric": "hellinger",
        "dictionary__n_levels": 3,
        "leave_own_out": False,
        "max_columns": 4096,
        "min_support": 3,
        "n_neighbours": 7,
        "n_jobs": 2,
        "n_occlusions": 1,
        "resolution": 0.05,
        "width": 0.5,
    }
    assert not hasattr(copied, "hierarchies_") and not hasattr(copied, "stimuli_")
    copied.set_params(dictionary__n_levels=1, bandwidth=0.1, n_jobs=None)
    assert copied.fit(train).hierarchies_.n_levels == 1
    assert not hasattr(model.dictionary, "words_"), "learning touched the parameter"
    # A dictionary learned elsewhere is used as it is, and survives a clone when it is frozen.
    assert MotifColumns(dictionary).fit(train).dictionary_ is dictionary
    assert not hasattr(clone(MotifColumns(dictionary)).dictionary, "words_")
    frozen = clone(MotifColumns(FrozenEstimator(dictionary))).fit(train)
    assert_same_rows(frozen.stimuli_, MotifColumns(dictionary).fit(train).stimuli_)
    assert frozen.explain(train[0]).motifs


@few_words_are_no_news
def test_in_a_pipeline(train, new):
    labels = np.array([one.n_segments > 2 for one in train])
    ensemble = MotifColumns(SegmentDictionary(2), bandwidth=0.3)
    pipeline = make_pipeline(ensemble, SVC(kernel="linear")).fit(train, labels)
    expected = SVC(kernel="linear").fit(ensemble.stimuli_, labels).predict(ensemble.transform(new))
    np.testing.assert_array_equal(pipeline.predict(new), expected)
    assert cross_val_score(pipeline, train, labels, cv=3, error_score="raise").mean() > 0.6
    assert_same_rows(clone(ensemble).fit_transform(train), ensemble.stimuli_)


def test_pickle(model, train, new):
    for asked in (False, True):
        fresh = MotifColumns(model.dictionary_).fit(train)
        if asked:
            assert fresh.stimuli_.nnz and fresh.transform(new).nnz
        again = pickle.loads(pickle.dumps(fresh))
        assert_same_rows(again.stimuli_, model.stimuli_)
        assert_same_rows(again.transform(new), model.transform(new))
        assert again.explain(new[0]) == model.explain(new[0])
        again.partial_fit(new)
        assert again.hierarchies_.n_objects == len(train) + len(new)


class Heights:
    """Descriptor: how high the points of each segment lie, in five bins."""

    def describe(self, segmented):
        z = segmented.points[:, 2]
        bins = np.minimum(5 * (z - z.min()) / np.ptp(z), 4).astype(int)
        histograms = np.zeros((segmented.n_segments, 5))
        kept = segmented.segment_labels >= 0
        np.add.at(histograms, (segmented.segment_labels[kept], bins[kept]), 1)
        return Description(histograms)


@pytest.mark.parametrize("n_jobs", [None, 2])
@few_words_are_no_news
def test_any_descriptor(n_jobs):
    objects = [describe(one, Heights()) for one in segmented_objects(16)]
    model = MotifColumns(SegmentDictionary(2), n_jobs=n_jobs).fit(objects[:12])
    rows = model.transform(objects[12:])
    assert model.hierarchies_.prototypes.shape[1] == model.n_features_in_ == 5 and rows.nnz > 0
    assert_same_rows(rows, model.transform([describe(one, Heights()) for one in segmented_objects(16)[12:]]))
    assert model.hierarchies_.object_names == tuple(one.name for one in segmented_objects(12))
    assert clone(model).fit(objects).hierarchies_.n_objects == 16


def test_presets(train):
    assert MotifHierarchyEnsemble.preset("default").get_params() == MotifHierarchyEnsemble().get_params()
    paper = MotifHierarchyEnsemble.preset("paper")
    assert (paper.dictionary.n_levels, paper.dictionary.metric) == (4, "euclidean")
    assert (ShapeConceptModel.preset("paper").descriptor, paper.columns, paper.bandwidth) == (
        "fpfh",
        "motifs",
        0.025,
    )
    rows = paper.set_params(dictionary=SegmentDictionary(2, "euclidean")).fit_transform(train)
    # Nothing is left out: every object activates all its own vertices.
    assert_same_rows(rows, paper.transform(train))
    assert rows.shape[1] == paper.hierarchies_.n_vertices
    with pytest.raises(ValueError, match="preset must be 'default' or 'paper', got 'best'"):
        MotifHierarchyEnsemble.preset("best")
