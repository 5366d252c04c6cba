"""Learning on the workers of a Dask cluster: the same concepts, whatever becomes of a worker."""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings

import joblib
import numpy as np
import pytest

from shapeconcepts import ShapeConceptModel, datasets
from shapeconcepts.cluster import active_cluster, map_on_cluster
from shapeconcepts.parallel import map_in_order
from test_cli_learn import run

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
    ) as cluster:
        yield cluster


@pytest.fixture
def client(cluster):
    with distributed.Client(cluster, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
        yield client


@pytest.fixture(scope="module")
def scans():
    return datasets.simulate(n_per_category=6, random_state=5)


@pytest.fixture(scope="module")
def expected(scans):
    return learned(scans, n_jobs=1)


def learned(scans, **parameters):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # So few columns that prototypes stand for others.
        return ShapeConceptModel(**parameters).set_params(ensemble__max_columns=100).fit(scans)


def assert_same(model, other):
    np.testing.assert_array_equal(model.labels_, other.labels_)
    assert abs(model.stimuli_ - other.stimuli_).max() == 0
    np.testing.assert_array_equal(
        model.ensemble_.hierarchies_.prototypes, other.ensemble_.hierarchies_.prototypes
    )


def square(number):
    return os.getpid(), number**2


def slow_square(number):
    time.sleep(0.05)
    return os.getpid(), number**2


def test_work_is_done_by_the_workers_in_order(client):
    assert active_cluster() is None
    with joblib.parallel_config(backend="dask", client=client):
        assert active_cluster() is client
        results = list(map_in_order(square, iter(range(300))))
    assert [result for _, result in results] == [number**2 for number in range(300)]
    processes = {process for process, _ in results}
    assert len(processes) == 2
    assert os.getpid() not in processes


def test_a_stream_is_taken_only_a_little_ahead(client):
    taken = 0

    def chunks():
        nonlocal taken
        for number in range(1000):
            taken += 1
            yield [number]

    results = map_on_cluster(client, sum, chunks())
    assert next(results) == 0
    assert taken <= 16
    results.close()


def test_an_error_of_the_work_is_raised(client):
    with pytest.raises(ZeroDivisionError):
        list(map_on_cluster(client, lambda number: 1 // number, [1, 0]))


def test_a_cluster_learns_the_same(client, scans, expected):
    with joblib.parallel_config(backend="dask", client=client):
        assert_same(learned(scans), expected)


def test_a_worker_that_is_killed_costs_nothing_but_its_block(client):
    with joblib.parallel_config(backend="dask", client=client):
        results = map_in_order(slow_square, iter(range(400)))
        found = [next(results)]
        os.kill(found[0][0], signal.SIGKILL)
        found += results
    assert [result for _, result in found] == [number**2 for number in range(400)]


def test_a_model_is_the_same_where_a_worker_is_killed(client, scans, expected):
    victim = next(iter(client.run(os.getpid).values()))
    timer = threading.Timer(0.5, os.kill, (victim, signal.SIGKILL))
    timer.start()
    with joblib.parallel_config(backend="dask", client=client):
        model = learned(scans)
    timer.join()
    assert_same(model, expected)


def test_learn_on_a_cluster(cluster, client, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("simulate", "scans", "--n-per-category", "4").exit_code == 0
    common = ("learn", "scans", "--no-cache", "--model")
    assert run(*common, "here.safetensors").exit_code == 0
    result = run(*common, "there.safetensors", "--cluster", cluster.scheduler_address)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "here.safetensors").read_bytes() == (tmp_path / "there.safetensors").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--cluster", "tcp://127.0.0.1:1"), "no Dask scheduler answers at 'tcp://127.0.0.1:1'"),
        (("--cluster", "nonsense::"), "no Dask scheduler answers at 'nonsense::'"),
        (("--cluster", "tcp://127.0.0.1:1", "--jobs", "2"), "--jobs"),
    ],
)
def test_a_cluster_that_cannot_be_used(tmp_path, monkeypatch, arguments, message):
    monkeypatch.setattr("shapeconcepts.cli.cluster_option._SECONDS_TO_CONNECT", 2)
    result = run("learn", "--model", str(tmp_path / "m.safetensors"), *arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.output.replace("│", " ").split())


def test_workers_of_another_version_are_named(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr("shapeconcepts.version.__version__", "9.9")
    result = run("learn", "--model", str(tmp_path / "m"), "--cluster", cluster.scheduler_address)
    assert result.exit_code == 2
    assert "expected 9.9" in " ".join(result.output.replace("│", " ").split())
