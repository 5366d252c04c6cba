"""What touches an object, and is none of it."""

import numpy as np

from model_file_examples import described_objects, fitted_model
from shapeconcepts import DescribedObject
from shapeconcepts.descriptors import Description


def test_a_segment_of_another_kind_is_foreign():
    model = fitted_model()
    for one, other in zip(
        described_objects(2, seed=4)[1::4], described_objects(2, seed=5)[3::4], strict=True
    ):
        assert model.explain(one).foreign == ()
        histograms = [one.description.segment_histograms, other.description.segment_histograms[:1]]
        edges = np.concatenate([one.segment_edges, [[1, 2]]]).astype(np.int32)
        joined = DescribedObject(Description(np.concatenate(histograms)), edges)
        assert model.predict([joined])[0] == model.predict([one])[0]
        assert model.explain(joined).foreign == (2,)


def test_an_unknown_scan_and_motifs_as_columns_have_nothing_foreign():
    model = fitted_model()
    # Bins that no kind has together.
    histograms = np.zeros((2, 14))
    histograms[:, [1, 5]] = [[8.0, 1.0], [1.0, 3.0]]
    strange = DescribedObject(Description(histograms), np.array([[0, 1]], np.int32))
    model.response_.largest_divergence_ = 0.0
    assert model.predict([strange])[0] == -1
    assert model.explain(strange).foreign == ()
    like_the_paper = fitted_model(ensemble__columns="motifs", ensemble__bandwidth=0.1)
    assert like_the_paper.explain(described_objects(1)[0]).foreign == ()
