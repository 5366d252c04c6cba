"""What docs/index.md says to be the same: segments of a scan, and what a model learns and answers.

The same whatever runs beside it, in any order, in any pose. What may differ, on another processor, cannot be
tested on one.
"""

import dataclasses
import hashlib
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from joblib import Parallel, delayed, parallel_config
from scipy.spatial.transform import Rotation
from threadpoolctl import threadpool_info, threadpool_limits

from shapeconcepts import Scan, ShapeConceptModel, segment
from shapeconcepts.datasets import CATEGORIES, simulate_scan
from shapeconcepts.model import PRESETS

# Scans of each kind.
LEARNED = {"ball": 8, "box": 7, "can": 6, "plate": 5}


def new_scans() -> list[Scan]:
    return [simulate_scan(category, index, random_state=5) for category in CATEGORIES for index in range(2)]


@pytest.fixture(scope="module")
def scans() -> list[Scan]:
    return new_scans()


@pytest.fixture(scope="module")
def alone(scans):
    return [segment(scan) for scan in scans]


def moved(scan: Scan, seed: int) -> tuple[Scan, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    turn, shift = Rotation.random(random_state=rng).as_matrix(), rng.uniform(-1, 1, 3)
    return Scan(scan.points @ turn.T + shift, turn @ scan.viewpoint + shift, name=scan.name), turn, shift


def point_labels(obj) -> np.ndarray:
    return np.append(obj.segment_labels, -1)[obj.point_to_voxel]


def assert_same_bits(one, other) -> None:
    for field in dataclasses.fields(one):
        first, second = getattr(one, field.name), getattr(other, field.name)
        if isinstance(first, np.ndarray):
            assert first.dtype == second.dtype and first.tobytes() == second.tobytes(), field.name
        else:
            assert first == second, field.name


def test_scans_are_worth_comparing(alone):
    assert {obj.n_segments for obj in alone} >= {1, 2, 3}


def test_again_and_in_another_order(scans, alone):
    for scan, obj in reversed(list(zip(scans, alone, strict=True))):
        assert_same_bits(segment(scan), obj)


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_in_parallel(scans, alone, n_jobs):
    parallel = Parallel(n_jobs=n_jobs, backend="loky")(delayed(segment)(scan) for scan in scans)
    for one, other in zip(parallel, alone, strict=True):
        assert_same_bits(one, other)


def test_in_threads(scans, alone):
    for one, other in zip(
        Parallel(n_jobs=2, backend="threading")(delayed(segment)(scan) for scan in scans), alone, strict=True
    ):
        assert_same_bits(one, other)


def test_order_of_the_points(scans, alone):
    for seed, (scan, obj) in enumerate(zip(scans, alone, strict=True)):
        order = np.random.default_rng(seed).permutation(len(scan))
        shuffled = segment(Scan(scan.points[order], scan.viewpoint, name=scan.name, label=scan.label))
        assert shuffled.n_segments == obj.n_segments, scan.name
        np.testing.assert_array_equal(shuffled.segment_edges, obj.segment_edges)
        np.testing.assert_array_equal(point_labels(shuffled), point_labels(obj)[order])
        np.testing.assert_array_equal(shuffled.point_to_voxel, obj.point_to_voxel[order])
        np.testing.assert_allclose(shuffled.points, obj.points, atol=1e-12)
        np.testing.assert_allclose(shuffled.normals, obj.normals, atol=1e-6)


def test_order_of_the_points_without_viewpoint(scans):
    for seed, scan in enumerate(scans[::3]):
        order = np.random.default_rng(seed).permutation(len(scan))
        obj, shuffled = segment(Scan(scan.points)), segment(Scan(scan.points[order]))
        np.testing.assert_array_equal(point_labels(shuffled), point_labels(obj)[order])
        np.testing.assert_allclose(shuffled.normals, obj.normals, atol=1e-6)


def test_rigid_motion(scans, alone):
    for seed, (scan, obj) in enumerate(zip(scans, alone, strict=True)):
        other, turn, shift = moved(scan, seed)
        result = segment(other)
        assert result.n_segments == obj.n_segments, scan.name
        np.testing.assert_array_equal(result.segment_edges, obj.segment_edges)
        assert (point_labels(result) == point_labels(obj)).mean() > 0.999, scan.name
        np.testing.assert_allclose(result.points, obj.points @ turn.T + shift, atol=1e-12)
        np.testing.assert_allclose(result.normals, obj.normals @ turn.T, atol=1e-6)


def few_scans() -> list[Scan]:
    """To learn from, every third without a viewpoint."""
    scans = [simulate_scan(kind, index, random_state=7) for kind, n in LEARNED.items() for index in range(n)]
    return [scan if i % 3 else dataclasses.replace(scan, viewpoint=None) for i, scan in enumerate(scans)]


def learned(preset: str, scans: list, **parameters: object) -> ShapeConceptModel:
    return ShapeConceptModel.preset(preset, **parameters).fit(scans)


def digests(model: ShapeConceptModel, new: list) -> dict[str, str]:
    """Of the bits of what a model learned, and of its answers."""
    ensemble, filtration = model.ensemble_, model.filtration_
    stimuli, answers = model.stimuli_, model.stimuli(new)
    arrays = {
        "words": ensemble.dictionary_.words_,
        "prototypes": [ensemble.hierarchies_.prototypes, ensemble.hierarchies_.prototype_vertices],
        "stimuli": [stimuli.indptr, stimuli.indices, stimuli.data],
        "tree": [filtration.space_.edges_, filtration.space_.divergences_],
        "filtration": [filtration.edges_, filtration.times_, filtration.p_values_],
        "concepts": [model.labels_, *(concept.members for concept in model.concepts_)],
        "stimuli of new": [answers.indptr, answers.indices, answers.data],
        "responses": [model.transform(new)],
        "predictions": [model.predict(new)],
    }
    return {
        name: hashlib.sha256(b"".join(np.ascontiguousarray(one).tobytes() for one in of_name)).hexdigest()
        for name, of_name in arrays.items()
    }


def constellations(model: ShapeConceptModel) -> list[tuple[int, int]]:
    """Scan and constellation of each prototype."""
    known = model.ensemble_.hierarchies_
    return list(zip(known.prototype_objects.tolist(), known.prototype_constellations.tolist(), strict=True))


@pytest.fixture(scope="module")
def few() -> list[Scan]:
    return few_scans()


@pytest.fixture(scope="module")
def segmented(few):
    return [segment(scan) for scan in few]


@pytest.fixture(scope="module")
def models(segmented):
    return {preset: learned(preset, segmented) for preset in PRESETS}


@pytest.fixture(scope="module")
def expected(models, alone):
    return {preset: digests(model, alone) for preset, model in models.items()}


@pytest.mark.parametrize("preset", PRESETS)
def test_models_are_worth_comparing(models, alone, preset):
    model = models[preset]
    sizes = [concept.size for concept in model.concepts_]
    assert len(sizes) >= 2 and model.stimuli_.nnz > 100
    # Concepts of one size are numbered by the content of rows, which the order of prototypes decides.
    assert preset == "paper" or len(set(sizes)) == len(sizes)
    assert len(set(model.predict(alone).tolist())) >= 3 and np.ptp(model.transform(alone)) > 0.1


@pytest.mark.parametrize("backend", ["loky", "threading"])
@pytest.mark.parametrize("preset", PRESETS)
def test_learning_in_several_jobs(few, scans, expected, preset, backend):
    with parallel_config(backend=backend):
        model = learned(preset, few, n_jobs=2)
        assert digests(model, scans) == expected[preset]


def test_in_another_process(expected):
    """With another seed of hashes, and another number of threads."""
    program = f"""
import json, sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from test_determinism import PRESETS, digests, few_scans, learned, new_scans
scans, new = few_scans(), new_scans()
print(json.dumps({{preset: digests(learned(preset, scans), new) for preset in PRESETS}}))
"""
    environment = {**os.environ, "PYTHONHASHSEED": "12345", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, stdout=subprocess.PIPE, text=True, check=True
    )
    assert json.loads(done.stdout) == expected


@pytest.mark.parametrize("n_threads", [1, 3])
@pytest.mark.parametrize("preset", PRESETS)
def test_number_of_threads_of_libraries(few, scans, expected, preset, n_threads):
    with threadpool_limits(n_threads):
        assert digests(learned(preset, few), scans) == expected[preset]


def threads_of_libraries() -> dict[str, int]:
    return {library["filepath"]: library["num_threads"] for library in threadpool_info()}


def test_models_that_are_learned_side_by_side(segmented, scans, expected):
    """In threads, which share the number of threads of libraries."""
    before = threads_of_libraries()
    with ThreadPoolExecutor(4) as threads:
        side_by_side = list(threads.map(lambda _: learned("paper", segmented), range(8)))
    assert threads_of_libraries() == before
    for model in side_by_side:
        assert digests(model, scans) == expected["paper"]


@pytest.mark.parametrize("preset", PRESETS)
def test_order_of_the_scans(segmented, models, alone, preset):
    """Rows and columns of the stimuli move, and nothing else; what is summed over columns is rounded anew."""
    model, order = models[preset], np.random.default_rng(3).permutation(len(segmented))
    other = learned(preset, [segmented[i] for i in order])
    words, other_words = (one.ensemble_.dictionary_.words_ for one in (model, other))
    assert [level.tobytes() for level in words] == [level.tobytes() for level in other_words]
    columns = np.arange(model.stimuli_.shape[1])
    if preset == "default":
        # A column is a prototype: a constellation of a scan.
        column_of = {behind: column for column, behind in enumerate(constellations(model))}
        moved = constellations(other)
        columns = np.array([column_of[order[scan], constellation] for scan, constellation in moved])
    for ours, theirs in (
        (model.stimuli_[order], other.stimuli_),
        (model.stimuli(alone), other.stimuli(alone)),
    ):
        assert ours.toarray()[:, columns].tobytes() == theirs.toarray().tobytes()
    np.testing.assert_array_equal(other.labels_, model.labels_[order])
    np.testing.assert_array_equal(other.predict(alone), model.predict(alone))
    np.testing.assert_allclose(other.transform(alone), model.transform(alone), rtol=1e-9)


@pytest.mark.parametrize("preset", PRESETS)
def test_a_scan_alone_and_among_others(models, scans, preset):
    model = models[preset]
    responses, predictions, stimuli = model.transform(scans), model.predict(scans), model.stimuli(scans)
    for i, scan in enumerate(scans):
        assert model.transform([scan]).tobytes() == responses[[i]].tobytes()
        assert model.predict([scan]).tolist() == [predictions[i]]
        assert (model.stimuli([scan]) != stimuli[[i]]).nnz == 0
