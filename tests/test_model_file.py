"""Models are saved and loaded without losing a bit."""

import errno
import os
import signal
import stat
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from safetensors import safe_open
from sklearn.exceptions import NotFittedError

from model_file_examples import (
    DESCRIPTOR,
    LIKE_THE_PAPER,
    described_objects,
    differences,
    fitted_model,
    refusal,
)
from shapeconcepts import (
    FPFH,
    Joint,
    ModelError,
    MotifHierarchyEnsemble,
    SegmentDictionary,
    ShapeConceptModel,
    Surflet,
    load_model,
)
from shapeconcepts.descriptors import Curvature, Description
from shapeconcepts.model_file.container import read_container, write_container


@pytest.fixture(scope="module", params=[{}, LIKE_THE_PAPER], ids=["default", "like the paper"])
def model(request):
    return fitted_model(**request.param)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model.safetensors"


def saved_and_loaded(model, path):
    model.save(path)
    return load_model(path)


def test_the_example_is_worth_saving(model):
    assert len(model.concepts_) >= 2
    assert list(model.skipped_) == [2]
    assert model.filtration_.concept_time_ is not None and model.stimuli_.nnz > 100
    assert (model.response_.whitening_.shape[1] >= 2) == (model.response_.distance == "mahalanobis")
    assert (model.predict(described_objects(4, seed=1)) >= 0).any()


def test_every_attribute_survives_to_the_last_bit(model, path):
    assert differences(model, saved_and_loaded(model, path)) == []


def test_answers_are_the_same_to_the_last_bit(model, path):
    loaded = saved_and_loaded(model, path)
    objects = described_objects(4, seed=1)
    for answer in ("transform", "predict", "stimuli"):
        assert differences(getattr(model, answer)(objects), getattr(loaded, answer)(objects)) == []
    for one in objects:
        assert differences(model.explain(one), loaded.explain(one)) == []
    assert differences(model.ensemble_.stimuli_, loaded.ensemble_.stimuli_) == []
    assert model.filtration_.concept_time_ == loaded.filtration_.concept_time_
    assert model.filtration_.epsilon_max_ == loaded.filtration_.epsilon_max_


def test_the_filtration_goes_on(model, path):
    ours, theirs = model.filtration_, saved_and_loaded(model, path).filtration_
    for time in np.linspace(0, 1, 7):
        assert differences(ours.groups_at(time, 2), theirs.groups_at(time, 2)) == []
        if ours.stop == "persistence":
            assert differences(ours.concepts_at(time), theirs.concepts_at(time)) == []
    assert differences(ours.annexations(), theirs.annexations()) == []
    assert differences(ours.diagram(), theirs.diagram()) == []
    assert list(ours.graph().edges(data=True)) == list(theirs.graph().edges(data=True))
    assert list(ours.graph().nodes(data=True)) == list(theirs.graph().nodes(data=True))


def test_names_of_groups_that_are_no_concepts(path):
    """Also of those that are parts of each other."""
    model = fitted_model()
    cuts = [0.0, *np.minimum(1.0001 * model.concept_tree_.granularities, 1.0), 1.0]
    others = {one for cut in cuts for one in model.concepts_at(cut)}.difference(model.concepts_)
    assert any(set(a.members) < set(b.members) for a in others for b in others)
    for number, concept in enumerate(sorted(others, key=lambda one: one.birth)):
        concept.name = f"group {number}"
    loaded = saved_and_loaded(model, path)
    assert loaded.filtration_._group_names() == model.filtration_._group_names() != []
    for cut in cuts:
        assert differences(model.concepts_at(cut), loaded.concepts_at(cut)) == []


def test_what_belongs_together_is_one(model, path):
    loaded = saved_and_loaded(model, path)
    assert loaded.concepts_ is loaded.filtration_.concepts_
    np.testing.assert_array_equal(loaded.labels_, loaded.filtration_.labels_)


def test_repeated_scans(path):
    """They are one vertex of the space, which counts them all."""
    objects = [one for one in described_objects(10) for _ in range(4)]
    ensemble = MotifHierarchyEnsemble(SegmentDictionary(3), leave_own_out=False)
    model = ShapeConceptModel(descriptor=DESCRIPTOR, ensemble=ensemble).fit(objects)
    multiplicities = model.filtration_.space_.multiplicities_
    assert min(multiplicities) >= 4 and sum(multiplicities) == 160
    assert differences(model, saved_and_loaded(model, path)) == []


def test_a_model_without_stimuli(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        ensemble = MotifHierarchyEnsemble(SegmentDictionary(1))
        model = ShapeConceptModel(descriptor=DESCRIPTOR, ensemble=ensemble).fit(described_objects(1)[:1])
    assert model.stimuli_.nnz == 0
    loaded = saved_and_loaded(model, path)
    assert differences(model, loaded) == []
    objects = described_objects(2)
    assert differences(model.stimuli(objects), loaded.stimuli(objects)) == []


def test_names_survive(model, path):
    loaded = saved_and_loaded(model, path)
    assert loaded.get_feature_names_out().tolist() == model.get_feature_names_out().tolist()
    assert loaded.concepts_[1].name == 'näme "1"\n\udcff'
    assert loaded.skipped_ == model.skipped_
    assert loaded.scan_names_[2] == "not\udcff a scan"
    assert "not\\udcff a scan" in loaded.skipped_[2]
    assert loaded.scan_labels_ == model.scan_labels_


def test_saving_again_gives_the_same_bytes(model, path):
    loaded = saved_and_loaded(model, path)
    content = path.read_bytes()
    assert loaded.save(path) is None
    assert path.read_bytes() == content
    model.save(path)
    assert path.read_bytes() == content


def test_n_jobs_stays_behind(path):
    model = fitted_model()
    model.save(path)
    content = path.read_bytes()
    model.set_params(n_jobs=3).ensemble_.set_params(n_jobs=2)
    model.save(path)
    assert path.read_bytes() == content
    assert load_model(path).n_jobs is None


@pytest.mark.parametrize(
    "descriptor",
    [
        "fpfh",
        "surflet+fpfh",
        FPFH(),
        FPFH(radius=0.045),
        Surflet(scale="metric"),
        Curvature(radius=0.035),
        Joint((FPFH(0.04), Joint((Surflet(), Curvature()), normal_radius=0.01))),
    ],
)
def test_built_in_descriptors_survive(descriptor, path):
    loaded = saved_and_loaded(fitted_model(descriptor=descriptor), path)
    assert loaded.descriptor == descriptor
    assert loaded.descriptor_ == descriptor


def test_parameters_survive(path):
    parameters = {
        "ensemble__dictionary__n_levels": np.int64(2),
        "ensemble__dictionary__metric": "euclidean",
        "ensemble__columns": "motifs",
        "ensemble__n_neighbours": np.int32(7),
        "ensemble__resolution": 0.01,
        "ensemble__max_columns": 70,
        "ensemble__width": 0.4,
        "ensemble__bandwidth": np.float32(0.25),
        "ensemble__leave_own_out": False,
        "ensemble__min_support": 1,
        "filtration__heat": "geodesic",
        "ensemble__n_occlusions": 1,
        "filtration__stop": "annexations",
        "filtration__min_concept_size": 2,
        "filtration__max_steps": 7,
        "filtration__error_rate": 0.2,
        "filtration__granularity": 0.3,
        "filtration__max_vertices": 100,
        "response__distance": "mahalanobis",
        "response__n_nearest": 8,
        "response__max_components": 20,
        "response__variance_kept": 0.9,
        "response__max_prototypes": 4000,
        "segmenter__voxel_size": 0.004,
        "segmenter__seed_size": 0.015,
        "segmenter__max_segments": 9,
        "segmenter__min_share": 0.05,
        "segmenter__min_voxels": 20,
        "descriptor": FPFH(radius=np.float64(0.05)),
    }
    model = fitted_model(**parameters)
    loaded = saved_and_loaded(model, path)
    found = {name: value for name, value in loaded.get_params().items() if name in parameters}
    assert found == parameters
    # Every parameter there is, but for those of the machine and for whole stages.
    left = loaded.get_params().keys() - parameters.keys()
    stages = {"segmenter", "ensemble", "ensemble__dictionary", "filtration", "response"}
    assert left == stages | {"n_jobs", "ensemble__n_jobs", "filtration__n_jobs", "descriptor__radius"}
    objects = described_objects(3, seed=2, descriptor=FPFH())
    assert differences(model.transform(objects), loaded.transform(objects)) == []


@pytest.mark.parametrize("learned", [{}, LIKE_THE_PAPER], ids=["default", "like the paper"])
def test_parameters_that_were_set_after_learning_change_nothing(learned, path):
    """A file holds the stages as they were fitted: a model is not learned again before `fit`."""
    model = fitted_model(**learned)
    objects = described_objects(3, seed=2)
    expected = [model.transform(objects), model.predict(objects), model.explain(objects[1])]
    parameters = {name: model.get_params()[name] for name in LIKE_THE_PAPER}
    others = (
        {name: ShapeConceptModel().get_params()[name] for name in LIKE_THE_PAPER}
        if learned
        else LIKE_THE_PAPER
    )
    model.set_params(**{**others, "ensemble__dictionary__n_levels": 12, "segmenter__max_segments": 5})
    # Nor does it matter to the fitted ensemble.
    columns = others["ensemble__columns"]
    model.ensemble_.set_params(columns=columns, bandwidth=0.5, min_support=9, n_neighbours=3)
    loaded = saved_and_loaded(model, path)
    assert {name: loaded.get_params()[name] for name in LIKE_THE_PAPER} == parameters
    for one in (model, loaded):
        found = [one.transform(objects), one.predict(objects), one.explain(objects[1])]
        assert differences(expected, found) == []


def test_a_model_without_concepts(path):
    objects = described_objects(1)[:2]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        ensemble = MotifHierarchyEnsemble(SegmentDictionary(1), min_support=1, leave_own_out=False)
        model = ShapeConceptModel(descriptor=DESCRIPTOR, ensemble=ensemble).fit(objects)
    assert model.filtration_.epsilon_max_ is None
    loaded = saved_and_loaded(model, path)
    assert differences(model, loaded) == []
    assert loaded.transform(objects).shape == (2, 0)
    assert loaded.predict(objects).tolist() == [-1, -1]


def test_other_tools_can_read_the_file(model, path):
    model.save(path)
    with safe_open(path, framework="np") as file:
        assert np.array_equal(file.get_tensor("concepts.labels"), model.labels_)
        assert list(file.metadata()) == ["shapeconcepts"]


def test_own_descriptors_cannot_be_saved(path):
    class Own:
        def describe(self, segmented):
            return Description(np.ones((segmented.n_segments, 2)))

    class Derived(FPFH):
        pass

    path.write_text("old")
    for descriptor in (Own(), Derived()):
        with pytest.raises(
            ModelError, match=r"stage of one's own.* FPFH, Surflet, Curvature, PointDistances, Joint.*, got"
        ):
            fitted_model(descriptor=descriptor).save(path)
    assert path.read_text() == "old"


def test_an_unfitted_model_cannot_be_saved(path):
    with pytest.raises(NotFittedError):
        ShapeConceptModel().save(path)
    assert not path.exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda model: model.concepts_.pop(), "concepts.labels"),
        (lambda model: setattr(model.concepts_[0], "name", 5), r"concept_names\[0\] must be a string, got 5"),
        (lambda model: model.scan_labels_.__setitem__(3, 7), r"scan_labels\[3\]"),
        (lambda model: model.scan_names_.pop(), "scan_names must be a list of 40"),
        (
            lambda model: model.ensemble_.partial_fit(described_objects(1)),
            "objects.distances must have shape",
        ),
        (lambda model: model.response_.set_params(n_nearest=0), "'n_nearest' parameter of ConceptResponse"),
        (lambda model: model.filtration_.set_params(heat="warm"), "'heat' parameter of Filtration"),
        (lambda model: model.segmenter_.set_params(voxel_size=np.nan), "cannot be saved"),
        (lambda model: setattr(model.concepts_[0], "name", object()), "cannot be saved"),
    ],
)
def test_a_model_whose_parts_do_not_fit_cannot_be_saved(change, message, path):
    model = fitted_model()
    change(model)
    with pytest.raises(ModelError, match=message):
        model.save(path)
    assert not path.exists()


@pytest.mark.parametrize("failure", [OSError(errno.ENOSPC, "disk full"), KeyboardInterrupt()])
def test_a_failed_writer_leaves_the_old_file_and_nothing_else(model, path, monkeypatch, failure):
    def fail(descriptor):
        raise failure

    path.write_text("old")
    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(type(failure)):
        model.save(path)
    assert path.read_text() == "old"
    assert os.listdir(path.parent) == [path.name]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_killed_writer_leaves_the_old_file_whole(model, path):
    model.save(path)
    content = path.read_bytes()
    tensors, description = read_container(path)
    child = os.fork()
    if child == 0:
        os.fsync = lambda descriptor: os.kill(os.getpid(), signal.SIGKILL)
        write_container(path, tensors, description)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.WTERMSIG(status) == signal.SIGKILL
    assert path.read_bytes() == content
    (left_over,) = set(os.listdir(path.parent)) - {path.name}
    assert left_over.startswith(".shapeconcepts-")


def test_it_is_on_disk_before_it_takes_its_place(model, path, monkeypatch):
    order = []
    monkeypatch.setattr(os, "fsync", lambda descriptor: order.append(os.fstat(descriptor).st_size))
    replace = Path.replace
    monkeypatch.setattr(Path, "replace", lambda a, b: (order.append("replace"), replace(a, b)))
    model.save(path)
    assert order == [path.stat().st_size, "replace"]


@pytest.mark.skipif(os.name != "posix", reason="POSIX permissions")
def test_permissions(model, path):
    mask = os.umask(0o027)
    try:
        model.save(path)
        assert stat.S_IMODE(path.stat().st_mode) == 0o640
        path.chmod(0o600)
        model.save(path)
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    finally:
        os.umask(mask)


@pytest.mark.skipif(os.name != "posix", reason="POSIX links")
@pytest.mark.parametrize("is_there", [True, False])
def test_a_link_stays_one(model, tmp_path, is_there):
    (tmp_path / "models").mkdir()
    link, target = tmp_path / "latest", tmp_path / "models" / "one"
    link.symlink_to(Path("models") / "one")
    if is_there:
        target.write_text("old")
    model.save(link)
    assert link.is_symlink()
    assert differences(load_model(target), load_model(link)) == []


def test_impossible_places(model, tmp_path):
    with pytest.raises(FileNotFoundError):
        model.save(tmp_path / "absent" / "model")
    with pytest.raises(ModelError, match="is not a regular file"):
        model.save(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        for use in (model.save, load_model):
            with pytest.raises(ModelError, match="pipe: is not a regular file"):
                use(tmp_path / "pipe")
    assert [name for name in os.listdir(tmp_path) if name != "pipe"] == []


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="permissions do not bind this user")
def test_a_write_protected_file_is_kept(model, path):
    path.write_text("old")
    path.chmod(0o400)
    with pytest.raises(PermissionError):
        model.save(path)
    path.chmod(0o000)
    with pytest.raises(ModelError, match="cannot be read"):
        load_model(path)


watched: list[str] = []
is_watching = False


def _watch(event: str, arguments: tuple) -> None:
    if not is_watching:
        return
    writes = event == "open" and isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR)
    if writes or event.split(".")[0] in (
        "os",
        "pickle",
        "exec",
        "compile",
        "import",
        "subprocess",
        "marshal",
    ):
        watched.append(f"{event} {arguments}")


def test_loading_neither_writes_nor_runs_anything(model, path):
    global is_watching
    expected = saved_and_loaded(model, path)
    path.chmod(0o444)
    path.parent.chmod(0o555)
    sys.addaudithook(_watch)
    is_watching = True
    try:
        loaded = load_model(path)
    finally:
        is_watching = False
        path.parent.chmod(0o755)
    assert watched == []
    assert differences(expected, loaded) == []


@pytest.mark.parametrize(
    ("preset", "parameters"),
    [("default", {}), ("default", {"ensemble__width": 0.3, "descriptor": Surflet("metric")}), ("paper", {})],
)
def test_scans_of_the_simulated_sensor(preset, parameters, path):
    from shapeconcepts import datasets, segment

    scans = datasets.simulate(n_per_category=3, random_state=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = ShapeConceptModel.preset(preset, **parameters).fit(scans)
    loaded = saved_and_loaded(model, path)
    assert differences(model, loaded) == []
    new = segment(scans[4])
    for answer in ("transform", "predict", "stimuli"):
        answers = [getattr(one, answer)([new, scans[0]]) for one in (model, loaded)]
        assert differences(*answers) == []
    assert differences(model.explain(scans[7]), loaded.explain(scans[7])) == []


def test_a_thinned_model_answers_and_learns_on_like_the_one_that_was_saved(tmp_path):
    model = fitted_model(ensemble__max_columns=50)
    assert model.ensemble_.hierarchies_.is_thinned
    path = tmp_path / "model"
    model.save(path)
    tensors, _ = read_container(path)
    assert (tensors["stimuli.columns"].dtype, tensors["stimuli.values"].dtype) == (np.uint16, np.float16)
    loaded = load_model(path)
    assert differences(model, loaded) == []
    assert differences(model.stimuli_, loaded.stimuli_) == []
    more = described_objects(5, seed=1)
    assert differences(model.ensemble_.partial_fit(more), loaded.ensemble_.partial_fit(more)) == []
    assert differences(model.ensemble_.stimuli_, loaded.ensemble_.stimuli_) == []
    tensors["prototypes.counts"][:] = 1
    write_container(path, tensors, read_container(path)[1])
    assert "prototypes" in refusal(path)
