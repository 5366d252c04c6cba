"""P-values of novelty: calibrated by the training scans, and the promise they keep."""

from __future__ import annotations

import json
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model_file_examples import LIKE_THE_PAPER, described_objects, fitted_model
from shapeconcepts import Scan, ShapeConceptModel, datasets, load_model
from shapeconcepts.concepts import novelty
from shapeconcepts.concepts.novelty import Novelty
from shapeconcepts.io.write_pcd import write_pcd
from test_cli_learn import run


def random_wholes(rng: np.random.Generator, n: int, alpha: float = 1.0) -> np.ndarray:
    return rng.dirichlet(np.full(7, alpha), n).astype(np.float16)


def slow_distance(p: np.ndarray, q: np.ndarray) -> float:
    p, q = p.astype(float), q.astype(float)
    if not p.any() or not q.any():
        return 1.0
    return 1 - float(np.sqrt(p / p.sum() * q / q.sum()).sum())


@settings(deadline=None, max_examples=40)
@given(st.integers(1, 30), st.integers(1, 10), st.integers(0, 2**32 - 1))
def test_p_values_agree_with_slow_ones(n, m, seed):
    rng = np.random.default_rng(seed)
    training, new = random_wholes(rng, n), random_wholes(rng, m).astype(float)
    training[rng.random(n) < 0.1] = 0
    calibrated = Novelty(training)
    expected = [
        min([slow_distance(training[i], training[j]) for j in range(n) if j != i], default=1.0)
        for i in range(n)
    ]
    np.testing.assert_allclose(calibrated.distances, expected, atol=1e-6)
    distances = calibrated.distances_of(new)
    slow = [min(slow_distance(one, other) for other in training) for one in new.astype(np.float16)]
    np.testing.assert_allclose(distances, slow, atol=1e-6)
    p_values = calibrated.p_values(distances, np.full(m, -1), np.full(n, -1))
    for distance, p_value in zip(distances, p_values, strict=True):
        assert p_value == (1 + (calibrated.distances >= distance).sum()) / (n + 1)


def test_the_promise_is_kept_for_scans_of_something_known():
    rng = np.random.default_rng(0)
    false_alarms = []
    for _ in range(20):
        training, new = random_wholes(rng, 200, 3.0), random_wholes(rng, 200, 3.0)
        calibrated = Novelty(training)
        distances = calibrated.distances_of(new.astype(float))
        p_values = calibrated.p_values(distances, np.full(200, -1), np.full(200, -1))
        false_alarms.append([(p_values <= rate).mean() for rate in (0.01, 0.05, 0.1, 0.2)])
    found = np.mean(false_alarms, axis=0)
    np.testing.assert_array_less(np.abs(found - [0.01, 0.05, 0.1, 0.2]), [0.01, 0.015, 0.02, 0.03])


def test_a_large_concept_keeps_the_promise_for_itself():
    rng = np.random.default_rng(0)
    # A tight concept and a wide one: by all together, all that is called unknown would be of the wide one.
    tight, wide = (
        rng.dirichlet(concentration, 300).astype(np.float16) for concentration in ([500, 1, 1], [1, 1, 1])
    )
    concept_of = np.repeat([0, 1], 200)
    calibrated = Novelty(np.concatenate([tight[:200], wide[:200]]))
    for concept, new in enumerate((tight[200:], wide[200:])):
        distances = calibrated.distances_of(new.astype(float))
        p_values = calibrated.p_values(distances, np.full(100, concept), concept_of)
        assert (p_values <= 0.1).mean() == pytest.approx(0.1, abs=0.08)
    few = np.where(np.arange(400) < 50, 0, -1)
    by_all = calibrated.p_values(distances, np.full(100, -1), few)
    np.testing.assert_array_equal(calibrated.p_values(distances, np.zeros(100, int), few), by_all)


def test_a_sample_is_compared_with_where_there_are_many(monkeypatch):
    rng = np.random.default_rng(0)
    training, new = random_wholes(rng, 500), random_wholes(rng, 100)
    monkeypatch.setattr(novelty, "MOST_COMPARED", 100)
    calibrated, order = Novelty(training, n_jobs=2), rng.permutation(500)
    np.testing.assert_array_equal(Novelty(training[order]).distances, calibrated.distances[order])
    distances = calibrated.distances_of(new.astype(float))
    p_values = calibrated.p_values(distances, np.full(100, -1), np.full(500, -1))
    assert 0.02 <= (p_values <= 0.1).mean() <= 0.2
    assert (calibrated.distances > 0).all()


@pytest.fixture(scope="module")
def model():
    return fitted_model()


def test_a_p_value_is_the_same_alone_and_in_a_batch(model):
    new = described_objects(3, seed=7)
    together = model.recognise(new).p_values
    assert together.shape == (12,)
    assert [model.recognise([one]).p_values[0] for one in new] == together.tolist()


@pytest.mark.parametrize("parameters", [{}, LIKE_THE_PAPER])
def test_unknown_is_what_has_a_small_p_value(parameters):
    model, new = fitted_model(**parameters), described_objects(3, seed=7)
    recognition = model.recognise(new, unknown_rate=0.3)
    is_unknown = recognition.p_values <= 0.3
    assert 0 < is_unknown.sum() < len(new)
    assert (recognition.concepts[is_unknown] == -1).all()
    np.testing.assert_array_equal(model.predict(new, unknown_rate=0.3), recognition.concepts)
    assert (model.predict(new, unknown_rate=1.0) == -1).all()
    with pytest.warns(UserWarning, match=r"promise a rate of 0\.025 at best, got unknown_rate 0\.01"):
        concepts = model.predict(new, unknown_rate=0.01)
    np.testing.assert_array_equal(concepts, model.predict(new, unknown_rate=1 / 41 - 1e-9 + 1e-3))


@pytest.mark.parametrize("rate", [-0.1, 1.1, float("nan"), "0.1", True])
def test_a_rate_out_of_range(model, rate):
    with pytest.raises(ValueError, match="unknown_rate must be a number from 0 to 1, got"):
        model.predict(described_objects(1), unknown_rate=rate)


def test_a_scan_that_cannot_be_described_has_no_p_value(model):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        recognition = model.recognise(
            [Scan(np.full((5, 3), np.nan)), described_objects(1)[0]], unknown_rate=0.5
        )
    assert np.isnan(recognition.p_values).tolist() == [True, False]
    assert recognition.concepts[0] == -1


def test_a_loaded_model_gives_the_same(model, tmp_path):
    model.save(tmp_path / "model")
    loaded, new = load_model(tmp_path / "model"), described_objects(3, seed=7)
    np.testing.assert_array_equal(loaded.novelty_.distances, model.novelty_.distances)
    np.testing.assert_array_equal(loaded.recognise(new).p_values, model.recognise(new).p_values)


def test_a_new_kind_is_found_from_the_command_line(tmp_path):
    scans = datasets.simulate(n_per_category=12, random_state=2, categories=("box", "teddy"))
    plates = datasets.simulate(n_per_category=4, random_state=2, categories=("plate",))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        ShapeConceptModel().fit(scans).save(tmp_path / "model")
    for scan in plates:
        write_pcd(tmp_path / f"{scan.name}.pcd", scan)
    arguments = ("respond", tmp_path / "model", tmp_path, "--format", "jsonl", "--unknown-rate")
    lines = [json.loads(line) for line in run(*arguments, 0.1).stdout.splitlines()]
    assert len(lines) == 4
    assert [line["concept"] for line in lines] == ["unknown"] * 4
    assert all(0 < line["p_value"] <= 0.1 for line in lines)
    result = run(*arguments, 0.001)
    assert "24 training scans promise a rate of 0.04 at best" in " ".join(result.stderr.split())
    assert run(*arguments, 1.5).exit_code == 2
