"""A file says some things twice, in parameters and in tensors: where they disagree, it is refused."""

import warnings

import numpy as np
import pytest

from model_file_examples import (
    DESCRIPTOR,
    LIKE_THE_PAPER,
    described_objects,
    differences,
    fitted_model,
    forge,
    refusal,
)
from shapeconcepts import (
    FPFH,
    Joint,
    MotifHierarchyEnsemble,
    Scan,
    SegmentDictionary,
    ShapeConceptModel,
    describe,
    load_model,
    segment,
)
from shapeconcepts.descriptors.registry import DESCRIPTORS, get_descriptor


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model"


def stage(name, **parameters):
    return lambda _, description: description["stages"][name].update(parameters)


def dictionary(**parameters):
    return lambda _, description: description["stages"]["ensemble"]["dictionary"].update(parameters)


def descriptor(value):
    return lambda _, description: description["stages"].update(descriptor=value)


JOINT = {
    "type": "Joint",
    "descriptors": [{"type": "PointDistances"}, {"type": "FPFH", "radius": 0.03}],
    "normal_radius": 0.02,
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (descriptor("fpfh"), "descriptor fpfh gives 33 bins, tensor dictionary.words has 14"),
        (descriptor({"type": "FPFH", "radius": 0.03}), "descriptor FPFH(radius=0.03) gives 33 bins, tensor"),
        (descriptor(JOINT), "gives 47 bins, tensor dictionary.words has 14"),
        (dictionary(n_levels=4), "ensemble.dictionary.n_levels is 4, tensor dictionary.level_sizes has 3"),
        (dictionary(n_levels=2), "ensemble.dictionary.n_levels is 2, tensor dictionary.level_sizes has 3"),
        (dictionary(metric="euclidean"), "dictionary.words must hold the means of the segments"),
        (stage("ensemble", n_occlusions=0), "ensemble.n_occlusions is 0, tensor imagined.prototypes names"),
        (lambda _, d: d.update(epsilon_max=0.5), "epsilon_max must be "),
        (lambda _, d: d.update(concept_time=0.5), "concept_time must be "),
    ],
)
@pytest.mark.parametrize("sound", ["default", "like_the_paper"])
def test_parameters_that_disagree(sound, path, change, message, request):
    assert message in refusal(forge(request.getfixturevalue(sound), path, change))


def one_column_less(tensors, description):
    """Of prototypes, the last; no row has an entry there."""
    last = len(tensors["stimuli.sources"]) - 1
    tensors["stimuli.sources"] = tensors["stimuli.sources"][:-1]
    tensors["response.mean"] = tensors["response.mean"][:-1]
    tensors["response.whitening"] = tensors["response.whitening"][:-1]
    kept = tensors["stimuli.columns"] < last
    rows = np.repeat(np.arange(len(tensors["stimuli.row_lengths"])), tensors["stimuli.row_lengths"])
    tensors["stimuli.row_lengths"] = np.bincount(rows[kept], minlength=len(tensors["stimuli.row_lengths"]))
    tensors["stimuli.columns"] = tensors["stimuli.columns"][kept]
    tensors["stimuli.values"] = tensors["stimuli.values"][kept]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (stage("ensemble", max_columns=50), "prototypes.counts must say that "),
        (one_column_less, "stimuli.sources must hold "),
        (stage("ensemble", columns="motifs"), "stimuli.sources must hold "),
        (stage("ensemble", leave_own_out=False), "ensemble.leave_own_out is false, no entry"),
        (stage("filtration", heat="geodesic"), "filtration.heat must be 'divergence' where stop is 'persis"),
        (
            stage("filtration", granularity=0.01),
            "granularity must be 0.01, as the parameters of filtration say",
        ),
        (stage("filtration", min_concept_size=4), "filtration.min_concept_size 4, and NaN else, got "),
        (stage("filtration", min_concept_size=2), "filtration.min_concept_size 2, and NaN else, got "),
        (stage("filtration", error_rate=0.0), "concepts.labels must name the groups at the granularity"),
        (stage("response", distance="mahalanobis"), "response.whitening must have 1 to 30 components"),
    ],
)
def test_parameters_of_the_default_that_disagree(default, path, change, message):
    assert message in refusal(forge(default, path, change))


def another_label(tensors, description):
    labels = tensors["concepts.labels"]
    moved = np.setdiff1d(np.flatnonzero(labels == 0), tensors["concepts.medoids"])[0]
    labels[moved] = 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (stage("ensemble", min_support=1), "stimuli.sources must hold the "),
        (stage("ensemble", min_support=5), "stimuli.sources must hold the "),
        (stage("ensemble", columns="prototypes"), "stimuli.sources must hold"),
        (stage("filtration", max_steps=7), "epsilon_max must be "),
        (stage("filtration", min_concept_size=30), "epsilon_max must be None, as the parameters"),
        (
            stage("filtration", min_concept_size=2),
            "concepts.labels must name the groups of at least filtration.min_",
        ),
        (another_label, "concepts.labels must name the groups of at least filtration.min_concept_size 3"),
        (stage("response", distance="divergence"), "response.whitening must have 0 to 0 components"),
        (stage("response", max_components=2), "response.whitening must have 1 to 2 components"),
    ],
)
def test_parameters_of_the_paper_that_disagree(like_the_paper, path, change, message):
    assert message in refusal(forge(like_the_paper, path, change))


def test_own_stimuli_that_should_be_left_out(path):
    model = fitted_model(ensemble__leave_own_out=False)
    model.save(path)
    forge(path, path, stage("ensemble", leave_own_out=True))
    assert "ensemble.leave_own_out is true, " in refusal(path)


def test_too_many_imagined_occlusions(default, path):
    def change(tensors, _):
        for name in ("imagined.histograms", "imagined.prototypes"):
            tensors[name] = np.concatenate([tensors[name]] * 3)

    assert "ensemble.n_occlusions is 2, tensor imagined.prototypes names one prototype 3 times" in refusal(
        forge(default, path, change)
    )


def test_p_values_of_splits_that_are_not_tested(default, like_the_paper, path):
    def change(tensors, _):
        p_values = tensors["filtration.p_values"]
        p_values[np.isnan(p_values)] = 0.5

    for sound in (default, like_the_paper):
        assert "filtration.p_values must hold " in refusal(forge(sound, path, change))


@pytest.mark.parametrize(
    "parameters",
    [
        {"ensemble__max_columns": 20},
        {"ensemble__max_columns": 1},
        {"ensemble__leave_own_out": False, "ensemble__max_columns": 3},
        {"ensemble__leave_own_out": False, "ensemble__width": 1e-6},
        {"ensemble__n_occlusions": 0, "ensemble__dictionary__metric": "euclidean"},
        {"ensemble__dictionary__n_levels": 12},
        {"ensemble__dictionary__n_levels": 1, "ensemble__columns": "motifs", "ensemble__min_support": 1},
        {"ensemble__columns": "motifs", "ensemble__min_support": 1, "ensemble__leave_own_out": False},
        {"ensemble__columns": "motifs", "ensemble__min_support": 40},
        {"filtration__min_concept_size": 20},
        {"filtration__granularity": 0.0},
        {"filtration__granularity": 1.0, "filtration__error_rate": 1.0},
        {"filtration__stop": "annexations"},
        {"filtration__stop": "annexations", "filtration__min_concept_size": 30},
        {"filtration__max_vertices": 5},
        {**LIKE_THE_PAPER, "response__max_components": 1},
        {**LIKE_THE_PAPER, "response__variance_kept": 0.0},
        {"response__distance": "mahalanobis", "filtration__max_steps": 1},
    ],
)
def test_sound_models_are_loaded(path, parameters):
    model = fitted_model(**parameters)
    model.save(path)
    assert differences(model, load_model(path)) == []


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("objects", ["one", "equal", "two kinds"])
def test_sound_models_of_few_scans_are_loaded(path, preset, objects):
    model = ShapeConceptModel.preset(preset)
    described = described_objects(3, descriptor=model.descriptor)
    described = {"one": described[:1], "equal": described[:1] * 9, "two kinds": described[::2]}[objects]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model.fit(described)
    model.save(path)
    assert differences(model, load_model(path)) == []


@pytest.mark.parametrize("granularity", [0.0, 0.12, 0.9])
def test_sound_models_at_another_granularity_are_loaded(path, granularity):
    model = fitted_model().at_granularity(granularity)
    model.save(path)
    assert load_model(path).filtration_.granularity_ == granularity


def test_objects_of_another_descriptor_cannot_be_saved(path):
    ensemble = MotifHierarchyEnsemble(SegmentDictionary(1))
    model = ShapeConceptModel(ensemble=ensemble).fit(described_objects(3, descriptor=DESCRIPTOR))
    with pytest.raises(ValueError, match=r"cannot be saved: descriptor surflet.* gives 234 bins, .* has 14"):
        model.save(path)


@pytest.mark.parametrize("one", [*DESCRIPTORS, FPFH(0.05), Joint((FPFH(), Joint((FPFH(),))))])
def test_descriptors_tell_how_many_bins_they_give(one):
    random = np.random.default_rng(0)
    points = np.column_stack([random.uniform(-0.05, 0.05, (2000, 2)), np.ones(2000)])
    points[1000:, 2] += np.abs(points[1000:, 0])
    description = describe(segment(Scan(points, np.zeros(3))), one).description
    assert get_descriptor(one).n_bins == description.n_bins
