"""Imagined prototypes, and what they remind of, against a slow version in plain Python."""

import math

import numpy as np
import pytest

from shapeconcepts import MotifHierarchyEnsemble, ShapeConceptModel, datasets, describe, segment
from shapeconcepts.concepts.recognition import concept_shares, foreign_segments

N_TRAIN = 21


@pytest.fixture(scope="module")
def objects():
    scans = datasets.simulate(n_per_category=4, random_state=5)
    return [describe(segment(scan), n_occlusions=2) for scan in scans[::4] + scans[1::4] + scans[2::4]]


@pytest.fixture(scope="module")
def new():
    return [describe(segment(scan)) for scan in datasets.simulate(n_per_category=1, random_state=6)]


@pytest.fixture(scope="module")
def ensemble(objects):
    return MotifHierarchyEnsemble(n_neighbours=5).fit(objects)


def hellinger(p: np.ndarray, q: np.ndarray) -> float:
    return max(1.0 - sum(math.sqrt(float(a)) * math.sqrt(float(b)) for a, b in zip(p, q, strict=True)), 0.0)


def imagined_one_by_one(objects, hierarchies, resolution):
    """Histogram, object and constellation of each imagined prototype."""
    found = []
    for number, described in enumerate(objects):
        own = hierarchies.prototypes[hierarchies.prototype_objects == number]
        known = set(hierarchies.prototype_constellations[hierarchies.prototype_objects == number].tolist())
        for rest, segments in described.occlusions:
            for constellation in range(1, 1 << rest.n_segments):
                chosen = [s for s in range(rest.n_segments) if constellation >> s & 1]
                whole = sum(1 << int(segments[s]) for s in chosen)
                edges = [e for e in rest.segment_edges.tolist() if set(e) <= set(chosen)]
                linked = {chosen[0]}
                for _ in chosen:
                    linked |= {s for e in edges if linked & set(e) for s in e}
                histogram = rest.description.histograms([constellation])[0].astype(np.float16)
                is_there = linked == set(chosen) and whole in known and histogram.any()
                if is_there and min(hellinger(histogram, one) for one in own) >= resolution:
                    found.append((number, whole, histogram.tobytes()))
    return sorted(found)


def test_what_tells_something_new_is_kept(objects, ensemble):
    hierarchies, imagined = ensemble.hierarchies_, ensemble.imagined_
    found = sorted(
        zip(
            hierarchies.prototype_objects[imagined.prototypes].tolist(),
            hierarchies.prototype_constellations[imagined.prototypes].tolist(),
            (histogram.tobytes() for histogram in imagined.histograms),
            strict=True,
        )
    )
    assert found == imagined_one_by_one(objects, hierarchies, ensemble.resolution)
    assert len(objects) < len(found) < 2 * len(hierarchies.prototypes)


def test_reminders_are_stimuli_by_object(objects, ensemble, new):
    hierarchies, imagined = ensemble.hierarchies_, ensemble.imagined_
    rows = np.concatenate([hierarchies.prototypes, imagined.histograms])
    behind = np.concatenate([np.arange(len(hierarchies.prototypes)), imagined.prototypes])
    owners = hierarchies.prototype_objects[behind]

    def scale(histogram, left_out):
        others = sorted(hellinger(histogram, r) for r, o in zip(rows, owners, strict=True) if o != left_out)
        return max(others[min(5, len(others)) - 1], ensemble.resolution)

    scales = [scale(row, owner) for row, owner in zip(rows, owners, strict=True)]
    one = min(new, key=lambda described: described.n_segments)
    expected, strongest = np.zeros(len(objects)), 0.0
    words = ensemble.dictionary_.transform(np.array([one.description.histograms([1])[0]]))
    assert one.n_segments == 1
    padded = np.full((1, words.shape[1], 16), -1, np.int32)
    padded[0, :, -1] = words[0]
    activated = hierarchies.activated(padded)[0]
    histogram = one.description.histograms([1])[0].astype(np.float32)
    own_scale = scale(histogram, -1)
    for row, prototype, owner, its_scale in zip(rows, behind, owners, scales, strict=True):
        d = hellinger(histogram, row)
        m = int((hierarchies.prototype_vertices[prototype] == activated).sum())
        kernel = math.exp(-(d**2) / (2 * ensemble.width**2 * its_scale * own_scale))
        stimulus = (1 + m) / (1 + len(activated)) * kernel
        if stimulus >= 1e-3 and d < 1:
            expected[owner] += stimulus
            strongest = max(strongest, stimulus)
    found = ensemble.reminders([one]).toarray()[0]
    assert expected.sum() > 0
    assert np.allclose(found, strongest * expected / expected.sum(), atol=1e-5)


def test_learning_in_parts_imagines_the_same(objects, new):
    dictionary = MotifHierarchyEnsemble().fit(objects).dictionary_
    at_once = MotifHierarchyEnsemble(dictionary).fit(objects)
    in_parts = MotifHierarchyEnsemble(dictionary).fit(objects[:9])
    in_parts.partial_fit(objects[9:])
    assert np.array_equal(at_once.imagined_.histograms, in_parts.imagined_.histograms)
    assert np.array_equal(at_once.imagined_.prototypes, in_parts.imagined_.prototypes)
    assert (at_once.reminders(new) != in_parts.reminders(new)).nnz == 0


def test_reminders_are_the_same_alone_and_with_more_jobs(ensemble, new):
    rows = ensemble.reminders(new)
    assert rows.shape == (len(new), N_TRAIN)
    assert (rows.sum(axis=1) <= 1 + 1e-9).all() and rows.data.min() > 0
    for position, one in enumerate(new):
        assert (ensemble.reminders([one]) != rows[position]).nnz == 0


def test_concepts_and_stimuli_do_not_depend_on_what_is_imagined(objects, new):
    with_them, without = (
        ShapeConceptModel().set_params(ensemble__n_occlusions=n).fit(objects) for n in (2, 0)
    )
    assert len(without.ensemble_.imagined_.prototypes) == 0 < len(with_them.ensemble_.imagined_.prototypes)
    assert np.array_equal(with_them.labels_, without.labels_)
    assert (with_them.stimuli(new) != without.stimuli(new)).nnz == 0
    assert (with_them.ensemble_.reminders(new) != without.ensemble_.reminders(new)).nnz > 0


def test_motifs_as_columns_know_no_objects(objects, new):
    ensemble = MotifHierarchyEnsemble(columns="motifs").fit(objects)
    with pytest.raises(ValueError, match="columns must be 'prototypes' for reminders, got 'motifs'"):
        ensemble.reminders(new)


def test_shares_of_concepts():
    from scipy.sparse import csr_matrix

    reminders = csr_matrix([[0.2, 0.0, 0.1, 0.1], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.3]])
    shares = concept_shares(reminders, np.array([1, 0, 0, -1]), 3)
    assert np.allclose(shares, [[0.25, 0.5, 0.0], [0, 0, 0], [0, 0, 0]])


def test_segments_that_hardly_remind_of_a_concept():
    from scipy.sparse import csr_matrix

    reminders = csr_matrix([[0.3, 0.3, 0.1], [0.05, 0.04, 0.9], [0.0, 0.0, 0.0]])
    assert foreign_segments(reminders, np.array([2, 2, 0]), 2) == (1, 2)
    assert foreign_segments(reminders, np.array([2, 2, 0]), 0) == (2,)
    # Nothing is of this concept, and so nothing is foreign to it.
    assert foreign_segments(reminders, np.array([2, -1, 0]), 3) == ()


def test_what_another_object_left_is_foreign(objects):
    model = ShapeConceptModel().fit(objects)
    for described in objects[:12]:
        explanation = model.explain(described)
        [concept] = model.predict([described])
        is_foreign = []
        for number in range(described.n_segments):
            row = model.ensemble_.reminders([described.segment(number)]).toarray()[0]
            is_foreign.append(row[model.labels_ == concept].sum() < 0.1)
        expected = () if all(is_foreign) else tuple(np.flatnonzero(is_foreign))
        assert explanation.foreign == expected


def test_hidden_scans_are_told_right_more_often():
    scans = datasets.simulate(n_per_category=24, random_state=8)
    known = [scan for i, scan in enumerate(scans) if i % 4]
    hidden = [scan for i, scan in enumerate(scans) if i % 4 == 0]
    hidden = [half(segment(scan)) for scan in hidden]
    described = [describe(segment(scan), n_occlusions=2) for scan in known]
    labels, kinds = np.unique([one.label for one in described], return_inverse=True)
    truth = [one.label for one in hidden]
    errors = []
    for n_occlusions in (2, 0):
        ensemble = MotifHierarchyEnsemble(n_occlusions=n_occlusions).fit(described)
        shares = concept_shares(ensemble.reminders(hidden), kinds, len(labels))
        errors.append(float((labels[shares.argmax(axis=1)] != truth).mean()))
    assert errors[0] < 0.25
    assert errors[0] < errors[1]


def half(segmented):
    """Without the half that lies on one side, described."""
    from dataclasses import replace

    across = segmented.points[:, 0]
    labels = np.where(across > np.median(across), -1, segmented.segment_labels)
    names, labels_left = np.unique(labels[labels >= 0], return_inverse=True)
    visible = labels >= 0
    return describe(
        replace(
            segmented,
            points=segmented.points[visible],
            normals=segmented.normals[visible],
            patch_labels=segmented.patch_labels[visible],
            segment_labels=labels_left.astype(np.int32),
            segment_edges=np.empty((0, 2), np.int32),
            n_segments=len(names),
        )
    )
