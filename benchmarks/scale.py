"""Learning from described scans, from hundreds to a hundred thousand: time, memory, model file, responses.

    python benchmarks/scale.py make [--scans N] [--seed SEED] [--folder FOLDER] [--jobs N]
    python benchmarks/scale.py fit [--scans N ...] [--seed SEED] [--folder FOLDER] [--jobs N]
    python benchmarks/scale.py update [--scans N] [--seed SEED] [--folder FOLDER] [--jobs N]
    python benchmarks/scale.py cluster [--scans N] [--seed SEED] [--folder FOLDER]
    python benchmarks/scale.py exact [--scans N ...] [--seed SEED] [--folder FOLDER] [--jobs N]

`make` describes simulated scans of the seven categories in turn, with imagined occlusions, and keeps them in
files of 500; what is there already is not made again. `fit` learns from the first so many, each number in a
process of its own: seconds, peak memory, prototypes, size of the model file, concepts with their scores by
labels, and the time of a response to a new scan, from points, reading included, in one thread; and the
seconds that fast_hdbscan takes for the ten principal components of the histograms of whole objects (it takes
no more without another library), and up to 14,000 scans, scikit-learn's HDBSCAN for the histograms.
`update` learns from the first so many, and then from 40 more, one by one: median and largest time of each.
`cluster` learns from the first so many with two joblib jobs, with two Dask workers on this machine, and with
two of which one is killed: seconds, what was sent, and whether the models are the same. It needs the extra
`cluster`. `exact` learns as usual and in the exact way, with every prototype and each object in the tree:
concepts with their scores by labels, and the adjusted Rand index of both; also where both are cut at the same
granularity, that of the exact way.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import json
import pickle
import resource
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from functools import partial
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from threading import Timer

import fast_hdbscan
import joblib
import numpy as np
import psutil
from sklearn.cluster import HDBSCAN
from sklearn.decomposition import PCA
from sklearn.metrics import adjusted_rand_score

from common import command, print_table
from shapeconcepts import (
    DescribedObject,
    ScanError,
    ShapeConceptModel,
    datasets,
    describe,
    load_model,
    segment,
)
from shapeconcepts.evaluation import grouping_scores
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.parallel import map_in_order
from shapeconcepts.simulation.categories import CATEGORIES
from shapeconcepts.sources import read_scan

SIZES = (350, 4_200, 14_000)
AT_ONCE = 500
N_NEW = 20
N_UPDATES = 40
NEW_SEED = 999
RIVALS = ("fast_hdbscan", "HDBSCAN")
RIVAL_SIZE = 10
MOST_FOR_HDBSCAN = 14_000
# More than there are of anything.
ALL = 2**24


def object_number(number: int, seed: int) -> DescribedObject | None:
    """The n-th simulated scan, described; None where next to nothing of it is visible."""
    category = list(CATEGORIES)[number % len(CATEGORIES)]
    n_occlusions = ShapeConceptModel().get_params()["ensemble__n_occlusions"]
    try:
        scan = datasets.simulate_scan(category, number // len(CATEGORIES), random_state=seed)
        return describe(segment(scan), n_occlusions=n_occlusions)
    except ScanError:
        return None


def file_of(folder: Path, seed: int, part: int) -> Path:
    return folder / f"{seed}_{part:04d}.pickle"


def make(folder: Path, seed: int, n_scans: int, jobs: int) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    # A few scans in a thousand show nothing.
    for part in range(n_scans // AT_ONCE + 1 + n_scans // 100_000):
        path = file_of(folder, seed, part)
        if path.exists():
            continue
        numbers = range(part * AT_ONCE, (part + 1) * AT_ONCE)
        start = time.perf_counter()
        objects = list(map_in_order(partial(object_number, seed=seed), numbers, jobs, own_process=True))
        temporary = path.with_suffix(".part")
        temporary.write_bytes(pickle.dumps([one for one in objects if one]))
        temporary.rename(path)
        print(path.name, f"{time.perf_counter() - start:.0f} s", flush=True)


def stored(folder: Path, seed: int, n_scans: int) -> Iterator[DescribedObject]:
    left = n_scans
    for part in count():
        path = file_of(folder, seed, part)
        if not path.exists():
            sys.exit(f"{path} is missing: python benchmarks/scale.py make --scans {n_scans} --seed {seed}")
        for one in pickle.loads(path.read_bytes())[:left]:
            yield one
            left -= 1
        if left == 0:
            return


def fit(folder: Path, seed: int, n_scans: int, jobs: int) -> dict[str, float]:
    """What learning from so many takes; in a process of its own."""
    warnings.simplefilter("ignore")
    # Kernels are compiled, or read, before.
    ShapeConceptModel(n_jobs=jobs).fit([*stored(folder, seed, 60)])
    objects = list(stored(folder, seed, n_scans))
    before = _peak()
    model = ShapeConceptModel(n_jobs=jobs)
    start = time.perf_counter()
    model.fit(objects)
    seconds = time.perf_counter() - start
    peak = _peak()
    scores = grouping_scores(model.labels_, np.array([one.label for one in objects]))
    rivals = _rival_seconds(np.stack([one.description.whole() for one in objects]))
    del objects
    with TemporaryDirectory() as place:
        path = Path(place) / "model"
        model.save(path)
        loaded = load_model(path)
        size = path.stat().st_size
        response = _response_seconds(loaded, Path(place))
    return {
        "scans": n_scans,
        "fit": seconds,
        "peak": peak / 2**30,
        "objects": before / 2**30,
        "prototypes": len(model.ensemble_.hierarchies_.prototypes),
        "columns": model.stimuli_.shape[1],
        "model": size / 2**20,
        "response": 1000 * response,
        "concepts": len(model.concepts_),
        "explained": scores.explained,
        "information": scores.adjusted_mutual_information,
        **rivals,
    }


def _rival_seconds(rows: np.ndarray) -> dict[str, float]:
    """Seconds of HDBSCAN, by two libraries, for histograms (n, b), under the Hellinger distance."""
    rows = np.sqrt(rows).astype(np.float32)
    found = dict.fromkeys(RIVALS, np.nan)
    # What fast_hdbscan compiles, it compiles before.
    fast_hdbscan.HDBSCAN(min_cluster_size=RIVAL_SIZE).fit(_components(rows[:500]))
    start = time.perf_counter()
    fast_hdbscan.HDBSCAN(min_cluster_size=RIVAL_SIZE).fit(_components(rows))
    found["fast_hdbscan"] = time.perf_counter() - start
    if len(rows) <= MOST_FOR_HDBSCAN:
        start = time.perf_counter()
        HDBSCAN(min_cluster_size=RIVAL_SIZE, n_jobs=2, copy=True).fit(rows)
        found["HDBSCAN"] = time.perf_counter() - start
    return found


def update(folder: Path, seed: int, n_scans: int, jobs: int) -> list[str]:
    """Milliseconds of updates by one scan, from its description."""
    warnings.simplefilter("ignore")
    objects = list(stored(folder, seed, n_scans + N_UPDATES))
    model = ShapeConceptModel(n_jobs=jobs).fit(objects[:n_scans])
    # What is computed when it is first asked for is there.
    model.recognise(objects[:1])
    times = []
    for one in objects[n_scans:]:
        start = time.perf_counter()
        model.partial_fit([one])
        times.append(1000 * (time.perf_counter() - start))
    return [f"{n_scans:,}", f"{np.median(times):.0f}", f"{max(times):.0f}"]


def beside_exact(folder: Path, seed: int, n_scans: int, jobs: int) -> list[str]:
    """Concepts as usual and in the exact way, see the module."""
    warnings.simplefilter("ignore")
    objects = list(stored(folder, seed, n_scans))
    labels = np.array([one.label for one in objects])
    usual = ShapeConceptModel(n_jobs=jobs).fit(objects)
    exact = ShapeConceptModel(n_jobs=jobs)
    exact.set_params(ensemble__max_columns=ALL, filtration__max_vertices=ALL).fit(objects)
    scores = [grouping_scores(model.labels_, labels) for model in (usual, exact)]
    same_cut = usual.at_granularity(exact.filtration_.granularity_)
    indices = [adjusted_rand_score(model.labels_, exact.labels_) for model in (usual, same_cut)]
    return [
        f"{n_scans:,}",
        str(seed),
        f"{len(usual.concepts_)} / {len(exact.concepts_)}",
        *(f"{index:.3f}" for index in indices),
        " / ".join(f"{one.explained:.3f}" for one in scores),
        " / ".join(f"{one.adjusted_mutual_information:.3f}" for one in scores),
    ]


def on_cluster(folder: Path, seed: int, n_scans: int) -> list[list[str]]:
    """Two Dask workers beside two joblib jobs, and one of them killed on the way."""
    from distributed import Client, LocalCluster

    warnings.simplefilter("ignore")
    objects = list(stored(folder, seed, n_scans))
    ShapeConceptModel(n_jobs=2).fit(objects[:60])
    expected, seconds = _timed_fit(objects)
    rows = [["two jobs", f"{seconds:.1f}", "1", "", ""]]
    for is_killed in (False, True):
        with (
            LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
            Client(cluster, set_as_default=False) as client,
            joblib.parallel_config(backend="dask", client=client),
        ):
            # As for the jobs, what is compiled is read before.
            ShapeConceptModel().fit(objects[:60])
            before = psutil.net_io_counters(pernic=True)["lo"].bytes_sent
            timer = Timer(0.4 * seconds, _kill_one, [client])
            if is_killed:
                timer.start()
            model, on_workers = _timed_fit(objects)
            timer.cancel()
            sent = psutil.net_io_counters(pernic=True)["lo"].bytes_sent - before
        apart = abs(model.stimuli_ - expected.stimuli_)
        is_same = np.array_equal(model.labels_, expected.labels_) and apart.nnz == 0
        title = "two workers, one killed" if is_killed else "two workers"
        rows.append(
            [title, f"{on_workers:.1f}", f"{on_workers / seconds:.2f}", f"{sent / 2**20:.0f}", str(is_same)]
        )
    return rows


def _components(rows: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(PCA(10).fit_transform(rows))


def _timed_fit(objects: list[DescribedObject]) -> tuple[ShapeConceptModel, float]:
    model = ShapeConceptModel(n_jobs=2)
    start = time.perf_counter()
    model.fit(objects)
    return model, time.perf_counter() - start


def _kill_one(client: object) -> None:
    os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)


def _response_seconds(model: ShapeConceptModel, place: Path) -> float:
    paths = []
    for number in range(N_NEW):
        category = list(CATEGORIES)[number % len(CATEGORIES)]
        paths.append(place / f"{number}.pcd")
        write_pcd(paths[-1], datasets.simulate_scan(category, number, random_state=NEW_SEED))
    times = []
    for path in [paths[0], *paths]:
        start = time.perf_counter()
        model.recognise([read_scan(path)])
        times.append(time.perf_counter() - start)
    return float(np.median(times[1:]))


def _peak() -> int:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak * (1 if sys.platform == "darwin" else 1024)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument(
        "action",
        choices=("make", "fit", "update", "cluster", "exact", "one"),
        metavar="make | fit | update | cluster | exact",
    )
    parser.add_argument("--scans", nargs="+", type=int, default=SIZES, metavar="N")
    parser.add_argument("--seed", type=int, default=100)
    parser.add_argument("--folder", type=Path, default=Path(gettempdir()) / "shapeconcepts_scale")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    options = parser.parse_args()
    if options.action == "make":
        make(options.folder, options.seed, max(options.scans), options.jobs)
        return
    if options.action == "one":
        print(json.dumps(fit(options.folder, options.seed, options.scans[0], options.jobs)))
        return
    if options.action == "update":
        row = update(options.folder, options.seed, options.scans[-1], options.jobs)
        print_table(("scans", "update, ms", "largest"), [row])
        return
    if options.action == "exact":
        exact_rows = [
            beside_exact(options.folder, options.seed, n_scans, options.jobs) for n_scans in options.scans
        ]
        titles = ("scans", "seed", "concepts", "ARI", "ARI, same cut", "explained", "AMI")
        print_table(titles, exact_rows)
        return
    if options.action == "cluster":
        n_scans = options.scans[-1]
        rows = on_cluster(options.folder, options.seed, n_scans)
        print_table((f"{n_scans:,} scans", "fit, s", "of two jobs", "sent, MB", "same model"), rows)
        return
    rows = []
    for n_scans in options.scans:
        arguments = [sys.argv[0], "one", "--scans", n_scans, "--seed", options.seed]
        arguments += ["--folder", options.folder, "--jobs", options.jobs]
        done = subprocess.run([sys.executable, *map(str, arguments)], check=True, capture_output=True)
        found = json.loads(done.stdout)
        rows.append([f"{value:.4g}" for value in found.values()])
        print(*rows[-1], flush=True)
    titles = ("scans", "fit, s", "peak, GB", "objects, GB", "prototypes", "columns", "model, MB")
    print_table((*titles, "response, ms", "concepts", "explained", "AMI", *RIVALS), rows)


if __name__ == "__main__":
    main()
