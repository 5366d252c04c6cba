"""The model as a whole, on a few simulated scans."""

import copy
import pickle

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.impute import SimpleImputer
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.svm import SVC

from shapeconcepts import (
    FPFH,
    ConceptResponse,
    Curvature,
    DescribedObject,
    Filtration,
    Joint,
    MotifHierarchyEnsemble,
    Scan,
    ScanError,
    ScanWarning,
    Segmenter,
    ShapeConceptModel,
    Surflet,
    datasets,
    describe,
    get_descriptor,
    load_model,
)
from shapeconcepts.concepts import response as response_module
from shapeconcepts.descriptors import Description
from shapeconcepts.model import PRESETS
from shapeconcepts.topology import jensen_shannon_divergences

pytestmark = pytest.mark.filterwarnings("ignore:.*different segment descriptions give")
BROKEN = Scan(np.full((80, 3), np.nan), name="broken")


@pytest.fixture(scope="module")
def scans() -> list[Scan]:
    return datasets.simulate(n_per_category=6)


@pytest.fixture(scope="module")
def segmented(scans):
    model = ShapeConceptModel()
    return [model.segment(scan) for scan in scans]


@pytest.fixture(scope="module")
def model(scans) -> ShapeConceptModel:
    return ShapeConceptModel().fit(scans)


@pytest.fixture(scope="module")
def paper(segmented) -> ShapeConceptModel:
    return ShapeConceptModel.preset("paper").fit(segmented)


@pytest.fixture(scope="module")
def new():
    scans = datasets.simulate(n_per_category=2, random_state=9)
    return [ShapeConceptModel().segment(scan) for scan in scans]


def concepts_of(model: ShapeConceptModel) -> set[frozenset[str]]:
    return {frozenset(model.scan_names_[i] for i in concept.members) for concept in model.concepts_}


def assert_same_rows(a, b) -> None:
    assert a.shape == b.shape and (a != b).nnz == 0


def test_what_is_learned(model, scans):
    assert len(model.concepts_) >= 2
    sizes = [concept.size for concept in model.concepts_]
    assert sizes == sorted(sizes, reverse=True) and min(sizes) >= 3
    labels = np.full(len(scans), -1)
    for number, concept in enumerate(model.concepts_):
        labels[concept.members] = number
        assert concept.medoid in concept.members
        assert 0 < concept.birth <= model.filtration_.concept_time_ < concept.death
    np.testing.assert_array_equal(model.labels_, labels)
    assert model.stimuli_.shape == (len(scans), len(model.ensemble_.columns_))
    np.testing.assert_array_equal(model.filtration_.labels_, labels)
    assert model.scan_names_ == [scan.name for scan in scans]
    assert model.scan_labels_ == [scan.label for scan in scans]
    assert model.skipped_ == {}
    # Not all is one: a category is mostly in one concept.
    most = [
        np.unique(labels[[s.label == category for s in scans]], return_counts=True)[1].max()
        for category in datasets.CATEGORIES
    ]
    assert sum(most) > 0.6 * len(scans)


def test_no_concept_of_the_paper_holds_more_than_half(paper, scans):
    assert len(paper.concepts_) >= 2
    sizes = [concept.size for concept in paper.concepts_]
    assert sizes == sorted(sizes, reverse=True) and min(sizes) >= 3 and max(sizes) <= len(scans) / 2
    assert paper.filtration_.concept_time_ == paper.filtration_.epsilon_max_
    for concept in paper.concepts_:
        assert 0 < concept.birth <= paper.filtration_.epsilon_max_ < concept.death


def test_responses_are_equation_3_of_the_stimuli(model, new):
    stimuli = model.stimuli(new)
    assert_same_rows(stimuli, model.ensemble_.transform([describe(one) for one in new]))
    assert_same_rows(model.stimuli_, model.ensemble_.stimuli_)
    responses = model.transform(new)
    assert responses.shape == (len(new), len(model.concepts_))
    np.testing.assert_array_equal(responses, model.response_.transform(stimuli))
    np.testing.assert_array_equal(model.predict(new), model.response_.predict(stimuli))


def test_stimuli_of_a_scan_do_not_depend_on_the_others(model, new):
    together = model.stimuli(new)
    for i, one in enumerate(new):
        assert_same_rows(model.stimuli([one]), together[[i]])


def test_training_scans_are_recognised(model, segmented):
    """Own prototypes count now, so that stimuli differ a little from those of the training."""
    predicted, labels = model.predict(segmented), model.labels_
    assert (predicted[labels >= 0] == labels[labels >= 0]).mean() > 0.85


def test_any_order_of_the_scans(model, segmented, new):
    order = np.random.default_rng(0).permutation(len(segmented))
    other = ShapeConceptModel().fit([segmented[i] for i in order])
    assert concepts_of(other) == concepts_of(model)
    np.testing.assert_array_equal(other.labels_ < 0, model.labels_[order] < 0)
    assert other.filtration_.epsilon_max_ == model.filtration_.epsilon_max_
    np.testing.assert_allclose(
        np.sort(other.transform(new), axis=1), np.sort(model.transform(new), axis=1), rtol=1e-6
    )


def test_any_number_of_jobs(model, scans, new):
    few = [scan for scan in scans if scan.label in ("box", "ball", "can")]
    one, two = (ShapeConceptModel(n_jobs=n_jobs).fit(few) for n_jobs in (1, 2))
    assert_same_rows(one.stimuli_, two.stimuli_)
    np.testing.assert_array_equal(one.labels_, two.labels_)
    assert concepts_of(one) == concepts_of(two)
    assert one.transform(new).tobytes() == two.transform(new).tobytes()


def test_alone_and_in_a_batch(model, new):
    batch, predicted, stimuli = model.transform(new), model.predict(new), model.stimuli(new)
    for k, one in enumerate(new):
        assert model.transform([one]).tobytes() == batch[[k]].tobytes()
        assert model.predict([one]) == predicted[k]
        assert_same_rows(model.stimuli([one]), stimuli[[k]])
    assert model.transform(reversed(new)).tobytes() == batch[::-1].tobytes()


def test_scans_segments_and_descriptions(model, scans, segmented):
    for inputs in (segmented, [describe(one) for one in segmented]):
        other = ShapeConceptModel().fit(iter(inputs))
        assert_same_rows(other.stimuli_, model.stimuli_)
        np.testing.assert_array_equal(other.labels_, model.labels_)
        assert other.scan_names_ == model.scan_names_ and other.scan_labels_ == model.scan_labels_
    some = slice(3, None, 11)
    expected = model.transform(segmented[some])
    assert model.transform(scans[some]).tobytes() == expected.tobytes()
    assert model.transform([describe(one) for one in segmented[some]]).tobytes() == expected.tobytes()
    mixed = [scans[3], segmented[14], describe(segmented[25])]
    assert model.transform(mixed).tobytes() == expected[:3].tobytes()
    # An array is a scan without a viewpoint.
    points = scans[3].points
    assert model.transform([points]).tobytes() == model.transform([Scan(points)]).tobytes()


def test_broken_scans_are_skipped(model, segmented, new):
    with pytest.warns(ScanWarning, match=r"2 of 44 scans are skipped: number 0: .*; number 5: ") as caught:
        other = ShapeConceptModel().fit([BROKEN, *segmented[:4], BROKEN, *segmented[4:]])
    assert {warning.filename for warning in caught if warning.category is ScanWarning} == {__file__}
    kept = np.delete(np.arange(44), [0, 5])
    assert list(other.skipped_) == [0, 5] and all("broken" in reason for reason in other.skipped_.values())
    assert_same_rows(other.stimuli_[kept], model.stimuli_)
    np.testing.assert_array_equal(other.labels_[kept], model.labels_)
    assert other.labels_[[0, 5]].tolist() == [-1, -1] and other.stimuli_[[0, 5]].nnz == 0
    assert [other.scan_names_[i] for i in kept] == model.scan_names_
    assert concepts_of(other) == concepts_of(model)

    with pytest.warns(ScanWarning, match="1 of 3 scans are skipped: number 1: ") as caught:
        responses = model.transform([new[0], BROKEN, new[1]])
    assert np.isnan(responses[1]).all()
    assert responses[[0, 2]].tobytes() == model.transform(new[:2]).tobytes()
    with pytest.warns(ScanWarning):
        predicted = model.predict([BROKEN, *new])
    assert predicted.tolist() == [-1, *model.predict(new)]


def test_many_broken_scans_are_told_in_brief(model, new):
    with pytest.warns(ScanWarning, match=r"5 of 6 .*number 2: [^;]*; \.\.\.$"):
        model.transform([BROKEN] * 5 + new[:1])


def test_nothing_but_broken_scans(model):
    for call in (ShapeConceptModel().fit, model.transform, model.predict, model.stimuli):
        with pytest.raises(ScanError, match="broken"):
            call([BROKEN, BROKEN])
    with pytest.raises(ScanError, match="broken"):
        model.explain(BROKEN)


def test_no_scans(model):
    with pytest.raises(ValueError, match="X must hold at least one scan, got none"):
        ShapeConceptModel().fit([])
    n_concepts = len(model.concepts_)
    assert model.transform([]).shape == (0, n_concepts) and model.predict([]).shape == (0,)
    assert model.stimuli([]).shape == (0, model.stimuli_.shape[1])


def test_a_single_scan_is_no_list(model, scans, segmented):
    described = describe(segmented[0])
    for single in (scans[0], segmented[0], described, scans[0].points, 5):
        for call in (ShapeConceptModel().fit, model.fit_transform, model.transform, model.predict):
            with pytest.raises(ValueError, match=r"got a single .*: wrap it in a list, \[X\]"):
                call(single)


@pytest.mark.parametrize("n", [1, 2])
def test_too_few_scans_for_concepts(segmented, n):
    with pytest.warns(UserWarning, match="no object is in a concept") as caught:
        model = ShapeConceptModel().fit(segmented[:n])
    assert any("no object" in str(warning.message) for warning in caught)
    assert model.labels_.tolist() == [-1] * n and model.concepts_ == []
    assert model.transform(segmented[:3]).shape == (3, 0)
    assert model.predict(segmented[:3]).tolist() == [-1] * 3
    assert model.get_feature_names_out().tolist() == []


def test_fit_again_forgets(segmented, model):
    other = ShapeConceptModel().fit(segmented[:20])
    assert_same_rows(other.fit(segmented).stimuli_, model.stimuli_)
    np.testing.assert_array_equal(other.labels_, model.labels_)


def test_names(model):
    named = copy.deepcopy(model)
    assert named.get_feature_names_out().tolist() == [f"concept{k}" for k in range(len(model.concepts_))]
    named.concepts_[1].name = "balls"
    others = [f"concept{k}" for k in range(2, len(model.concepts_))]
    assert named.get_feature_names_out().tolist() == ["concept0", "balls", *others]
    assert model.get_feature_names_out()[1] == "concept1"


def test_explain(model, segmented, scans):
    explanation = model.explain(segmented[0])
    assert explanation == model.ensemble_.explain(describe(segmented[0])) == model.explain(scans[0])
    assert explanation.motifs
    # Behind every entry of the row is a prototype that a constellation of the scan stimulates.
    row = model.stimuli([segmented[0]])
    assert {motif.column for motif in explanation.motifs} <= set(row.indices.tolist())


def test_explain_by_motifs(paper, segmented, scans):
    explanation = paper.explain(segmented[0])
    assert explanation == paper.ensemble_.explain(describe(segmented[0], "fpfh")) == paper.explain(scans[0])
    row = paper.stimuli([segmented[0]])
    assert len(explanation.motifs) == row.nnz > 0
    for motif in explanation.motifs:
        assert row[0, motif.column] == pytest.approx(motif.stimulus)


def test_clone_parameters_and_pickle(model, new):
    fresh = ShapeConceptModel(descriptor="fpfh", n_jobs=2)
    fresh.set_params(ensemble__dictionary__n_levels=3, ensemble__width=0.2)
    copied = clone(fresh)
    assert repr(copied.get_params()) == repr(fresh.get_params())
    assert copied.get_params()["ensemble__dictionary__n_levels"] == 3
    assert not hasattr(clone(model), "labels_")
    copied.set_params(filtration__min_concept_size=5, filtration__max_steps=10)
    assert (copied.filtration.min_concept_size, copied.filtration.max_steps) == (5, 10)
    assert fresh.get_params()["filtration__max_steps"] == 200
    for wrong in ("sigma", "filtration__sigma", "ensemble__dictionary__sigma"):
        with pytest.raises(ValueError, match="Invalid parameter"):
            copied.set_params(**{wrong: 1})
    again = pickle.loads(pickle.dumps(model))
    assert again.transform(new).tobytes() == model.transform(new).tobytes()


def test_parameters_are_stored_as_given():
    given = {
        "segmenter": Segmenter(max_segments=4),
        "descriptor": FPFH(),
        "ensemble": MotifHierarchyEnsemble(),
        "filtration": Filtration(5),
        "response": ConceptResponse("mahalanobis"),
        "n_jobs": 2,
    }
    model = ShapeConceptModel(**given)
    for name, value in given.items():
        assert getattr(model, name) is value and model.get_params(deep=False)[name] is value
    assert set(ShapeConceptModel().get_params(deep=False).values()) == {None, "surflet+fpfh+curvature"}


def test_fitting_leaves_the_stages_that_were_given(segmented):
    filtration, ensemble = Filtration(min_concept_size=4), MotifHierarchyEnsemble()
    model = ShapeConceptModel(filtration=filtration, ensemble=ensemble).fit(segmented)
    assert model.filtration is filtration and not hasattr(filtration, "labels_")
    assert model.ensemble is ensemble and not hasattr(ensemble, "hierarchies_")
    assert model.filtration_.min_concept_size == 4
    # What is set later is for the next fit.
    labels, rows = model.labels_.copy(), model.transform(segmented[:2])
    model.set_params(filtration__min_concept_size=20, descriptor="fpfh", segmenter__max_segments=1)
    np.testing.assert_array_equal(model.labels_, labels)
    assert model.transform(segmented[:2]).tobytes() == rows.tobytes()


def test_parameters_reach_their_stage(segmented):
    parameters = {
        "ensemble__dictionary__n_levels": 2, "ensemble__dictionary__metric": "euclidean",
        "ensemble__columns": "motifs", "ensemble__n_neighbours": 7, "ensemble__bandwidth": 0.3,
        "ensemble__leave_own_out": False, "ensemble__min_support": 3, "filtration__heat": "geodesic",
        "filtration__stop": "annexations", "response__distance": "mahalanobis",
        "filtration__min_concept_size": 2, "filtration__max_steps": 5, "descriptor": "fpfh",
    }  # fmt: skip
    two = ShapeConceptModel().set_params(**parameters).fit(segmented)
    assert two.ensemble_.hierarchies_.n_levels == 2 and two.ensemble_.dictionary_.metric == "euclidean"
    assert len(two.filtration_.annexations()[0]) <= 5
    found = two.get_params()
    for name, value in parameters.items():
        stage, _, rest = name.partition("__")
        assert found[name] == value
        assert not rest or getattr(two, f"{stage}_").get_params()[rest] == value
    coarse = ShapeConceptModel(segmenter=Segmenter(voxel_size=0.012, max_segments=2))
    scan = datasets.simulate_scan("box", 0)
    assert coarse.segment(scan).voxel_size == 0.012 and coarse.segment(scan).n_segments <= 2


def test_the_default_descriptor_can_be_built_from_its_parts(segmented, model, tmp_path):
    joint = Joint((Surflet(), FPFH(), Curvature()))
    other = ShapeConceptModel(descriptor=joint).fit(segmented)
    assert_same_rows(other.stimuli_, model.stimuli_)
    other.save(tmp_path / "m.safetensors")
    assert load_model(tmp_path / "m.safetensors").descriptor == joint


def test_preset_of_the_paper(segmented):
    paper = ShapeConceptModel.preset("paper")
    found = paper.get_params()
    assert found["descriptor"] == "fpfh" and found["response__distance"] == "mahalanobis"
    assert (found["filtration__heat"], found["filtration__stop"]) == ("geodesic", "annexations")
    assert (found["ensemble__columns"], found["ensemble__bandwidth"]) == ("motifs", 0.025)
    assert (found["ensemble__dictionary__n_levels"], found["ensemble__dictionary__metric"]) == (
        4,
        "euclidean",
    )
    assert (found["ensemble__leave_own_out"], found["ensemble__min_support"]) == (False, 1)
    changed = ShapeConceptModel.preset("paper", ensemble__dictionary__n_levels=2)
    assert changed.ensemble.dictionary.n_levels == 2
    assert ShapeConceptModel.preset("default").get_params() == ShapeConceptModel().get_params()
    assert MotifHierarchyEnsemble.preset("default").get_params() == MotifHierarchyEnsemble().get_params()
    paper.fit(segmented)
    # Nothing is left out: every scan activates all its own vertices, and each of them is a column.
    assert_same_rows(paper.stimuli_, paper.stimuli(segmented))
    assert paper.stimuli_.shape[1] == paper.ensemble_.hierarchies_.n_vertices
    assert set(PRESETS) == {"default", "paper"}
    with pytest.raises(ValueError, match="preset must be one of 'default', 'paper', got 'best'"):
        ShapeConceptModel.preset("best")


@pytest.mark.parametrize(
    ("parameter", "value"),
    [
        ("descriptor", "shape"),
        ("ensemble__dictionary__n_levels", 0),
        ("ensemble__dictionary__n_levels", True),
        ("ensemble__dictionary__metric", "cosine"),
        ("ensemble__bandwidth", 0),
        ("ensemble__width", float("inf")),
        ("ensemble__min_support", 0),
        ("ensemble__columns", "words"),
        ("ensemble__n_neighbours", 0),
        ("ensemble__leave_own_out", 2),
        ("filtration__min_concept_size", 1),
        ("filtration__min_concept_size", 3.0),
        ("filtration__max_steps", 0),
        ("filtration__heat", "mean"),
        ("filtration__stop", "late"),
        ("filtration__error_rate", 1.1),
        ("filtration__granularity", float("nan")),
        ("ensemble__resolution", 0),
        ("response__distance", "cosine"),
        ("segmenter__voxel_size", -1),
        ("segmenter__voxel_size", float("nan")),
        ("segmenter__seed_size", 0),
        ("segmenter__max_segments", 0),
        ("segmenter", "fine"),
        ("ensemble", 5),
        ("n_jobs", 1.5),
    ],
)
def test_parameters_out_of_range_are_refused_before_scans_are_read(parameter, value):
    def scans():
        raise AssertionError("scans are read")
        yield

    name = parameter.rpartition("__")[2]
    with pytest.raises(
        ValueError, match=f"The '{name}' parameter of .* must be .* Got '?{value!r}'? instead"
    ):
        ShapeConceptModel().set_params(**{parameter: value}).fit(scans())


def test_an_unfitted_model(segmented, tmp_path):
    model = ShapeConceptModel()
    for call in (model.transform, model.predict, model.stimuli):
        with pytest.raises(NotFittedError):
            call(segmented[:2])
    for call in (lambda: model.explain(segmented[0]), model.get_feature_names_out):
        with pytest.raises(NotFittedError):
            call()
    with pytest.raises(NotFittedError):
        model.save(tmp_path / "m.safetensors")


def test_fit_transform_describes_each_scan_once(segmented, scans, model):
    described = []

    class Counting:
        def describe(self, one):
            described.append(one.name)
            return get_descriptor("surflet+fpfh+curvature").describe(one)

    counting = ShapeConceptModel(descriptor=Counting()).set_params(ensemble__n_occlusions=0)
    rows = counting.fit_transform(scans)
    assert sorted(described) == sorted(scan.name for scan in scans)
    assert_same_rows(counting.stimuli_, model.stimuli_)
    assert rows.tobytes() == model.response_.transform(model.stimuli_).tobytes()
    # Own prototypes would count in rows of `transform`.
    assert not np.array_equal(rows, model.transform(segmented))
    np.testing.assert_array_equal(ShapeConceptModel().fit_predict(segmented), model.labels_)


def test_what_is_learned_is_the_models_own(model, segmented):
    assert model.n_features_in_ == 3
    own = ShapeConceptModel().fit(segmented)
    own.labels_[:] = -1
    np.testing.assert_array_equal(own.filtration_.labels_, model.labels_)


def test_column_names_are_unique(model):
    named = copy.deepcopy(model)
    for concept in named.concepts_:
        concept.name = "mug"
    assert len(set(named.get_feature_names_out())) == len(named.concepts_)
    named.concepts_[0].name, named.concepts_[1].name = "concept1", ""
    assert len(set(named.get_feature_names_out())) == len(named.concepts_)


def test_rows_as_data_frames(model, new):
    pandas = pytest.importorskip("pandas")
    framed = copy.deepcopy(model).set_output(transform="pandas")
    frame = framed.transform(new)
    assert isinstance(frame, pandas.DataFrame)
    assert frame.columns.tolist() == model.get_feature_names_out().tolist()
    np.testing.assert_array_equal(frame.to_numpy(), model.transform(new))


def test_in_a_pipeline(segmented, scans):
    labels = np.array([scan.label for scan in scans])
    pipeline = make_pipeline(ShapeConceptModel(), SVC()).fit(segmented, labels)
    responses = pipeline[0].transform(segmented)
    assert not np.isnan(responses).any()
    # The classifier learns from rows in which no scan's own motifs count.
    rows = pipeline[0].response_.transform(pipeline[0].stimuli_)
    expected = SVC().fit(rows, labels).predict(responses)
    np.testing.assert_array_equal(pipeline.predict(segmented), expected)
    # A scan without any stimulus gives a row of NaN, which an imputer takes.
    pipeline = make_pipeline(ShapeConceptModel(), SimpleImputer(), SVC())
    scores = cross_val_score(pipeline, segmented, labels, cv=2, error_score="raise")
    assert scores.mean() > 2 / 7
    with pytest.warns(ScanWarning):
        answers = pipeline.fit(segmented, labels).predict([*segmented[:3], BROKEN])
    assert len(answers) == 4


def test_concepts_at_another_granularity(model, new):
    n_finest = len(model.concepts_at(1.0))
    assert len(model.concepts_at(0.0)) <= len(model.concepts_) <= n_finest
    fine = model.at_granularity(1.0)
    assert len(fine.concepts_) == n_finest and fine.labels_.max() + 1 == n_finest
    assert fine.transform(new).shape == (len(new), n_finest)
    assert set(fine.predict(new)) <= set(range(-1, n_finest))
    assert fine.concept_tree_ is model.concept_tree_ and fine.stimuli_ is model.stimuli_
    assert model.labels_.max() + 1 == len(model.concepts_)
    expected = clone(model.response_).fit(model.stimuli_, fine.labels_)
    np.testing.assert_array_equal(fine.transform(new), expected.transform(model.stimuli(new)))
    with pytest.raises(ValueError, match="granularity must be a number from 0 to 1, got 2"):
        model.at_granularity(2)


def test_responses_of_groups_within_groups(model, segmented):
    tree = model.filtration_.group_tree()
    n_groups = len(tree.parents)
    members = [members_within(tree, group) for group in range(n_groups)]
    whole = [describe(one).description.whole() for one in segmented]
    between = {
        "stimuli": jensen_shannon_divergences(model.stimuli_),
        "whole": jensen_shannon_divergences(whole),
    }
    to_new = {"stimuli": jensen_shannon_divergences(model.stimuli(segmented[:5]), model.stimuli_)}
    to_new["whole"] = between["whole"][:5]
    of_training, of_new = model.transform_tree(), model.transform_tree(segmented[:5])
    assert of_training.shape == (len(segmented), 2 * n_groups) and of_new.shape == (5, 2 * n_groups)
    for start, kind in ((0, "stimuli"), (n_groups, "whole")):
        for group in range(n_groups):
            expected = to_new[kind][:, members[group]].mean(axis=1)
            # Whole objects are kept in half precision.
            assert np.allclose(of_new[:, start + group], expected, atol=1e-3)
            for scan in range(0, len(segmented), 5):
                others = members[group][members[group] != scan]
                expected = between[kind][scan, others].mean()
                assert np.isclose(of_training[scan, start + group], expected, atol=1e-3)
    # Those of the concepts are among them, and the coarsest come first.
    of_concepts = model.transform(segmented[:5])
    coarse = of_new[:, : len(model.concept_tree_.parents)]
    assert all(np.isclose(coarse, column[:, None]).all(axis=0).any() for column in of_concepts.T)
    fewer = model.transform_tree(segmented[:5], n_groups=4)
    assert np.allclose(fewer, np.concatenate([of_new[:, :4], of_new[:, n_groups : n_groups + 4]], axis=1))
    with pytest.raises(ValueError, match="n_groups must be an integer of at least 1, got 0"):
        model.transform_tree(n_groups=0)


def members_within(tree, group):
    """Objects in a group or in one that is a part of it."""
    inside = []
    for one, smallest in enumerate(tree.group_of_object.tolist()):
        while smallest not in (-1, group):
            smallest = tree.parents[smallest]
        if smallest == group:
            inside.append(one)
    return np.array(inside)


def test_responses_of_groups_with_scans_that_cannot_be_used(segmented):
    with pytest.warns(ScanWarning):
        model = ShapeConceptModel().fit([*segmented[:20], BROKEN, *segmented[20:]])
    whole = ShapeConceptModel().fit(segmented)
    of_training = model.transform_tree()
    assert np.isnan(of_training[20]).all()
    assert np.array_equal(np.delete(of_training, 20, axis=0), whole.transform_tree())
    with pytest.warns(ScanWarning):
        of_new = model.transform_tree([segmented[3], BROKEN])
    assert np.isnan(of_new[1]).all()
    assert np.array_equal(of_new[:1], whole.transform_tree([segmented[3]]))


def test_recognition(model, segmented):
    some = [*segmented[:4], DescribedObject(Description(np.zeros((1, 234)), blocks=(135, 33, 66)))]
    found = model.recognise(some)
    assert np.array_equal(found.responses[:4], model.transform(some[:4]))
    assert np.array_equal(found.concepts, model.predict(some))
    reminders = model.ensemble_.reminders([describe(one) for one in segmented[:4]]).toarray()
    for row, share, concept in zip(reminders, found.shares, found.concepts, strict=False):
        expected = [row[model.labels_ == k].sum() / row.sum() for k in range(len(model.concepts_))]
        assert np.allclose(share, expected)
        assert concept == np.argmax(expected)
    # What reminds of nothing is unknown, alone as among others.
    assert found.concepts[4] == -1 and not found.shares[4].any()
    assert model.predict(some[4:])[0] == -1
    for position in range(4):
        alone = model.recognise([some[position]])
        assert np.array_equal(alone.shares[0], found.shares[position])


def test_there_is_no_tree_where_a_time_makes_concepts(segmented):
    model = ShapeConceptModel.preset("paper").fit(segmented)
    with pytest.raises(ValueError, match="no significant splits"):
        model.transform_tree(segmented[:2])


def test_scans_may_come_from_a_generator(scans, model):
    streamed = ShapeConceptModel().fit(scan for scan in scans)
    assert_same_rows(streamed.stimuli_, model.stimuli_)
    assert streamed.scan_names_ == model.scan_names_ and streamed.scan_labels_ == model.scan_labels_
    with pytest.raises(ValueError, match="X must hold at least one scan, got none"):
        ShapeConceptModel().fit(iter([]))


def test_what_is_odd_in_scans_is_said_once(scans):
    in_millimetres = [Scan(1000 * scan.points, name=scan.name) for scan in scans[:5]]
    with pytest.warns(ScanWarning) as said:
        ShapeConceptModel().fit([*scans[5:], *in_millimetres])
    [notice] = [str(one.message) for one in said if "metres" in str(one.message)]
    assert notice.startswith(f"5 of {len(scans)} scans: {scans[0].name} is ")


def test_responses_of_groups_where_a_sample_stands_for_many(segmented, monkeypatch):
    monkeypatch.setattr(response_module, "LEAST_MEMBERS", 2)
    model = ShapeConceptModel(response=ConceptResponse(max_prototypes=8)).fit(segmented)
    members = model.response_.prototype_rows_
    assert len(members) < len(segmented) / 2
    tree = model.filtration_.group_tree()
    n_groups = len(tree.parents)
    of_training, of_new = model.transform_tree(), model.transform_tree(segmented[:4])
    for responses in (of_training, of_new):
        assert np.isfinite(responses).all() and responses.min() >= 0 and responses.max() <= 1
    divergences = jensen_shannon_divergences(model.stimuli_)
    for group in range(n_groups):
        # Of a group without a member in the sample, that of the smallest larger group with one.
        wider = group
        while not set(members_within(tree, wider)) & set(members):
            wider = tree.parents[wider]
        inside = np.intersect1d(members_within(tree, wider), members)
        for scan in range(0, len(segmented), 7):
            others = inside[inside != scan]
            if len(others):
                assert np.isclose(of_training[scan, group], divergences[scan, others].mean())


def test_responses_of_groups_where_there_are_none(segmented):
    with pytest.warns(UserWarning, match="no object is in a concept"):
        model = ShapeConceptModel().fit(segmented[:2])
    assert model.transform_tree().shape == (2, 0)
    assert model.transform_tree(segmented[:3]).shape == (3, 0)
    assert ShapeConceptModel().fit(segmented).transform_tree([]).shape[0] == 0
