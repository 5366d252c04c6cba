"""Stimuli of single prototypes against the slow reference, and what holds for their rows."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motif_objects import (
    adversarial_objects,
    assert_same_rows,
    described,
    fit_dictionary,
    kinds_of_segments,
    random_objects,
    segmented_objects,
    segments_of,
)
from motif_reference import SlowEnsemble, SlowObject, without_ties
from prototype_reference import Constellation, SlowField, constellations_of
from scipy.sparse import csr_matrix, vstack

from shapeconcepts import MotifHierarchyEnsemble, SegmentDictionary, describe, read_scan, segment
from shapeconcepts.motifs.decomposition import decompose
from shapeconcepts.motifs.prototype_stimuli import PrototypeField

pytestmark = pytest.mark.filterwarnings("ignore:.*different segment descriptions give")
N_TRAIN = 24


@pytest.fixture(scope="module")
def model(dictionary, train) -> MotifHierarchyEnsemble:
    return MotifHierarchyEnsemble(dictionary, n_neighbours=5).fit(train)


def by_prototype(model: MotifHierarchyEnsemble, rows: csr_matrix) -> list[dict[tuple, float]]:
    """Dense rows as dictionaries from (training object, segments) to stimulus."""
    hierarchies = model.hierarchies_
    keys = [
        (int(index), segments_of(constellation))
        for index, constellation in zip(
            hierarchies.prototype_objects, hierarchies.prototype_constellations, strict=True
        )
    ]
    assert rows.format == "csr" and rows.dtype == np.float64 and rows.has_sorted_indices
    assert (rows.data > 0).all(), "a zero is stored"
    return [dict(zip(keys, row.tolist(), strict=True)) for row in rows.toarray()]


def compare(
    model: MotifHierarchyEnsemble,
    train: list[list[Constellation]],
    new: list[list[Constellation]],
    described_new: list,
) -> list[float]:
    """Compare training rows and new rows; return the widths of the bounds of all stimuli."""
    n_prototypes = sum(len(one) for one in train)
    n_neighbours = model.n_neighbours or max(25, round(n_prototypes**0.5))
    slow = SlowField(train, n_neighbours, model.width, model.resolution)
    widths = []
    cases = [(row, index) for index, row in enumerate(by_prototype(model, model.stimuli_))]
    cases = [(row, train[index], index if model.leave_own_out else -1) for row, index in cases]
    cases += [
        (row, parts, -1)
        for row, parts in zip(by_prototype(model, model.transform(described_new)), new, strict=True)
    ]
    for actual, parts, left_out in cases:
        expected = slow.row(parts, left_out)
        assert actual.keys() == expected.keys()
        for prototype, bounds in expected.items():
            assert bounds.hold(actual[prototype]), (prototype, bounds, actual[prototype])
            if bounds.high > 0:
                widths.append(bounds.high - bounds.low)
    return widths


def compare_slow(train: list[SlowObject], new: list[SlowObject], n_levels: int, **parameters) -> list[float]:
    dictionary = fit_dictionary([described(one) for one in train], n_levels)
    slow = SlowEnsemble([words.tolist() for words in dictionary.words_], dictionary.metric, 1.0)
    train, new = without_ties(slow, train), without_ties(slow, new)
    if not train:
        return []
    model = MotifHierarchyEnsemble(dictionary, **parameters)
    model.fit([described(one) for one in train])
    return compare(
        model,
        [constellations_of(one, slow) for one in train],
        [constellations_of(one, slow) for one in new],
        [described(one) for one in new],
    )


@pytest.mark.parametrize("with_pairs", [False, True], ids=["segments", "pairs"])
def test_random_objects(with_pairs):
    rng = np.random.default_rng(with_pairs)
    widths = []
    for trial in range(36):
        kinds = kinds_of_segments(rng, n_kinds=int(rng.integers(1, 6)), n_bins=int(rng.integers(2, 10)))
        train = random_objects(rng, 6, kinds, 4, with_pairs=with_pairs)
        new = random_objects(rng, 3, kinds, 4, with_pairs=with_pairs)
        widths += compare_slow(
            train,
            new,
            1 + trial % 3,
            n_neighbours=(1, 3, 20)[trial % 3],
            width=(0.35, 0.35, 0.1, 2.0)[trial // 3 % 4],
            resolution=(1e-5, 0.05, 0.3)[trial // 2 % 3],
            leave_own_out=trial % 4 != 0,
        )
    # The bounds say something: rounding leaves nearly all stimuli as they are.
    assert len(widths) > 2000
    assert np.median(widths) < 1e-5 and np.quantile(widths, 0.9) < 1e-3


@settings(max_examples=80, deadline=None)
@given(
    objects=adversarial_objects(),
    copies=st.integers(1, 3),
    n_neighbours=st.sampled_from([1, 2, 20]),
    width=st.sampled_from([0.35, 0.1, 2.0]),
    leave_own_out=st.booleans(),
)
def test_any_object(objects, copies, n_neighbours, width, leave_own_out):
    """Few bins, equal and empty histograms, one object, one object several times."""
    compare_slow(
        objects * copies, objects, 2, n_neighbours=n_neighbours, width=width, leave_own_out=leave_own_out
    )


def test_scans(shared_data):
    files = sorted((shared_data / "seven_shapes").rglob("*.pcd"))[::13]
    objects = [describe(segment(read_scan(path))) for path in files]
    train, new = objects[:-6], objects[-6:]
    model = MotifHierarchyEnsemble(SegmentDictionary(4)).fit(train)

    def constellations(one) -> list[Constellation]:
        masks, _ = decompose(one.segment_edges, one.n_segments)
        histograms = one.description.histograms(masks).tolist()
        words = model.dictionary_.transform(one.description.histograms(1 << np.arange(one.n_segments))).T
        return [
            Constellation(
                segments_of(mask), histogram, tuple(tuple(sorted(w[list(segments_of(mask))])) for w in words)
            )
            for mask, histogram in zip(masks, histograms, strict=True)
        ]

    widths = compare(model, *([constellations(one) for one in part] for part in (train, new)), new)
    assert len(widths) > 500 and np.quantile(widths, 0.95) < 1e-5


SAME = SlowObject([[1.0, 0.0, 2.0], [0.0, 3.0, 1.0]], {}, [(0, 1)])
EMPTY = SlowObject([[0.0] * 3] * 2, {}, [(0, 1)])
HALF = SlowObject([[0.0] * 3, [1.0, 0.0, 0.0]], {}, [])


def fitted(
    objects: list[SlowObject], n_levels: int = 1, resolution: float = 1e-5, **parameters
) -> MotifHierarchyEnsemble:
    objects = [described(one) for one in objects]
    dictionary = fit_dictionary(objects, n_levels)
    return MotifHierarchyEnsemble(dictionary, resolution=resolution, **parameters).fit(objects)


def test_single_training_object():
    """There are no others to learn from, and every constellation finds itself."""
    model = fitted([SAME])
    assert model.stimuli_.shape == (1, 3) and model.stimuli_.nnz == 0
    assert fitted([SAME], leave_own_out=False).stimuli_.toarray() == pytest.approx(1 / 3)
    assert model.transform([described(SAME)]).toarray() == pytest.approx(1 / 3)
    stranger = SlowObject([[9.0, 0.0, 1.0]], {}, [])
    assert model.transform([described(stranger)]).nnz == 0


@pytest.mark.parametrize("n_objects", [2, 3, 30])
def test_equal_objects(n_objects):
    """Everything is at divergence 0: each constellation shares its mass among its twins."""
    model = fitted([SAME] * n_objects, n_neighbours=1)
    names = model.get_feature_names_out()
    for index, row in enumerate(model.stimuli_.toarray()):
        own = [name.startswith(f"object{index} ") for name in names]
        np.testing.assert_allclose(row, np.where(own, 0, 1 / 3 / (n_objects - 1)), atol=1e-9)
    np.testing.assert_allclose(model.transform([described(SAME)]).toarray(), 1 / 3 / n_objects, atol=1e-9)


def test_nothing_resembles_nothing():
    model = fitted([EMPTY, EMPTY, HALF, HALF, SAME])
    assert np.diff(model.stimuli_.indptr)[:2].tolist() == [0, 0]
    rows = model.transform([described(one) for one in (EMPTY, HALF)])
    # One of two constellations of HALF has mass, and reminds of itself.
    np.testing.assert_allclose(rows.sum(axis=1).ravel(), [[0, 0.5]], atol=1e-12)
    only = fitted([EMPTY, EMPTY])
    assert only.stimuli_.nnz == 0 and only.transform([described(EMPTY)]).nnz == 0


def test_more_neighbours_than_prototypes(train, dictionary, new):
    """All count as the last."""
    n_prototypes = len(MotifHierarchyEnsemble(dictionary).fit(train).columns_)
    a, b = (MotifHierarchyEnsemble(dictionary, n_neighbours=n).fit(train) for n in (n_prototypes, 10**6))
    assert_same_rows(a.transform(new), b.transform(new))
    assert_same_rows(a.stimuli_, b.stimuli_)
    closer = MotifHierarchyEnsemble(dictionary, n_neighbours=1).fit(train)
    assert closer.transform(new).nnz < a.transform(new).nnz


def test_row_sums_to_the_share_that_reminds_of_anything(model, train, new):
    for one in (*train, *new):
        explanation = model.explain(one)
        share = len(explanation.motifs) / explanation.n_constellations
        assert model.transform([one]).sum() == pytest.approx(share, abs=1e-9)


def test_all_goes_to_the_only_prototype_that_resembles():
    """Exactly all: no rounding makes an entry more than 1."""
    model = fitted(
        [SlowObject([segment], {}, []) for segment in ([8.0, 1.0, 1.0], [1.0, 1.0, 8.0])], n_neighbours=1
    )
    new = [SlowObject([[8.0, 1.0 + more, 1.0]], {}, []) for more in np.linspace(0.1, 2, 50)]
    rows = model.transform([described(one) for one in new])
    np.testing.assert_array_equal(rows.toarray(), [[1, 0]] * 50)


def test_row_is_the_same_alone_and_in_any_batch(model, train, new):
    rows = model.transform(new)
    assert rows.shape == (len(new), len(model.columns_)) and 0 < rows.nnz < np.prod(rows.shape)
    assert_same_rows(vstack([model.transform([one]) for one in new], format="csr"), rows)
    order = np.random.default_rng(0).permutation(len(new))
    assert_same_rows(model.transform([new[i] for i in order]), rows[order])
    assert_same_rows(model.transform(train + new + train)[N_TRAIN : N_TRAIN + len(new)], rows)


@pytest.mark.parametrize("n_jobs", [1, 2, 3])
def test_number_of_jobs_does_not_matter(n_jobs):
    objects = [describe(one) for one in segmented_objects(24)]
    alone, parallel = (
        MotifHierarchyEnsemble(SegmentDictionary(3), n_jobs=jobs).fit(objects[:16]) for jobs in (None, n_jobs)
    )
    assert_same_rows(parallel.stimuli_, alone.stimuli_)
    assert_same_rows(parallel.transform(objects[16:]), alone.transform(objects[16:]))
    assert alone.transform(objects[16:]).nnz > 100


def permuted_columns(model: MotifHierarchyEnsemble, other: MotifHierarchyEnsemble, order) -> np.ndarray:
    """The column of `model` that each column of `other` is; its object i is object order[i] of `model`."""
    column = {name: index for index, name in enumerate(model.get_feature_names_out())}
    columns = []
    for name in other.get_feature_names_out():
        index, *segments = name.removeprefix("object").split()
        columns.append(column[" ".join([f"object{order[int(index)]}", *segments])])
    assert sorted(columns) == list(range(len(column)))
    return np.array(columns)


@pytest.mark.parametrize("learned", [False, True], ids=["dictionary given", "dictionary learned"])
@pytest.mark.parametrize("seed", range(3))
def test_order_of_training_objects_only_permutes(dictionary, train, new, learned, seed):
    """Bit for bit."""
    order = np.random.default_rng(seed).permutation(N_TRAIN)
    words = SegmentDictionary(4) if learned else dictionary
    model = MotifHierarchyEnsemble(words, n_neighbours=5).fit(train)
    other = MotifHierarchyEnsemble(words, n_neighbours=5).fit([train[i] for i in order])
    columns = permuted_columns(model, other, order)
    np.testing.assert_array_equal(other.transform(new).toarray(), model.transform(new).toarray()[:, columns])
    expected = model.stimuli_.toarray()[order][:, columns]
    np.testing.assert_array_equal(other.stimuli_.toarray(), expected)


@settings(max_examples=15, deadline=None)
@given(cuts=st.sets(st.integers(1, N_TRAIN - 1)), ask_between=st.booleans())
def test_learning_in_parts_is_learning_at_once(model, dictionary, train, new, cuts, ask_between):
    other = MotifHierarchyEnsemble(dictionary, n_neighbours=5)
    for part in np.split(np.arange(N_TRAIN), sorted(cuts)):
        other.partial_fit([train[i] for i in part])
        if ask_between:
            assert other.stimuli_.shape == (part[-1] + 1, len(other.columns_))
            other.transform(new)
    assert other.get_feature_names_out().tolist() == model.get_feature_names_out().tolist()
    assert_same_rows(other.stimuli_, model.stimuli_)
    assert_same_rows(other.transform(new), model.transform(new))


def test_own_prototypes_are_left_out_of_training_rows_only(model, dictionary, train):
    own = model.hierarchies_.prototype_objects == np.arange(N_TRAIN)[:, None]
    assert not model.stimuli_.toarray()[own].any()
    rows = model.transform(train).toarray()
    has_mass = model.hierarchies_.prototypes.any(axis=1)
    assert (rows[own & has_mass] > 0).all() and not (rows[own & ~has_mass]).any()
    left_in = MotifHierarchyEnsemble(dictionary, n_neighbours=5, leave_own_out=False).fit(train)
    assert_same_rows(left_in.stimuli_, left_in.transform(train))
    assert_same_rows(left_in.transform(train), model.transform(train))


@pytest.mark.parametrize("parameters", [{"n_neighbours": 2}, {"leave_own_out": False}, {"width": 0.7}])
@pytest.mark.parametrize("asks", [True, False], ids=["asked", "not asked"])
def test_parameters_wait_until_more_is_learned(dictionary, train, new, parameters, asks):
    """Whether or not anything was computed with the former ones."""
    fresh = MotifHierarchyEnsemble(dictionary).fit(train[:-1])
    before, rows = fresh.stimuli_, fresh.transform(new)
    model = MotifHierarchyEnsemble(dictionary).fit(train[:-1])
    if asks:
        assert model.stimuli_.nnz and model.transform(new).nnz
    model.set_params(**parameters)
    assert_same_rows(model.transform(new), rows)
    assert_same_rows(model.stimuli_, before)
    expected = MotifHierarchyEnsemble(dictionary, **parameters).fit(train)
    model.partial_fit(train[-1:])
    assert_same_rows(model.stimuli_, expected.stimuli_)
    assert_same_rows(model.transform(new), expected.transform(new))
    former = MotifHierarchyEnsemble(dictionary).fit(train)
    assert (model.stimuli_ != former.stimuli_).nnz > 0


@pytest.mark.parametrize(("first", "then"), [("prototypes", "motifs"), ("motifs", "prototypes")])
def test_other_columns_wait_for_the_next_fit(dictionary, train, new, first, then):
    model = MotifHierarchyEnsemble(dictionary, columns=first).fit(train[:-1])
    rows, names, explanation = model.transform(new), model.get_feature_names_out(), model.explain(new[0])
    model.set_params(columns=then)
    assert_same_rows(model.transform(new), rows)
    assert model.get_feature_names_out().tolist() == names.tolist()
    assert model.explain(new[0]) == explanation
    expected = MotifHierarchyEnsemble(dictionary, columns=then).fit(train)
    assert_same_rows(model.partial_fit(train[-1:]).transform(new), expected.transform(new))


def test_names_of_columns(model):
    names = model.get_feature_names_out()
    assert names.dtype == object and len(names) == len(set(names)) == model.stimuli_.shape[1]
    hierarchies = model.hierarchies_
    for name, index, mask in zip(
        names, hierarchies.prototype_objects, hierarchies.prototype_constellations, strict=True
    ):
        assert name == " ".join([f"object{index}", *(f"s{s}" for s in sorted(segments_of(mask)))])


def test_equal_prototypes_have_equal_scales():
    model = fitted([SAME, SAME, HALF])
    field = PrototypeField.of(model.hierarchies_, model.columns_, 1, 1e-3, 0.35)
    twins = model.hierarchies_.prototype_objects < 2
    np.testing.assert_array_equal(field.scales[twins], np.float64(1e-3))
    assert (field.scales >= 1e-3).all() and (field.scales <= 1).all()
