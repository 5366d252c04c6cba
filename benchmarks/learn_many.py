"""`shapeconcepts learn` on very many files: time of each, memory, and what a kill costs.

    python benchmarks/learn_many.py [--scans N ...] [--seed SEED] [--folder FOLDER] [--jobs N] [--killed]

Simulated scans of the seven categories are written to FOLDER, unless they are there; `learn` then makes a
model and a report from so many of them, with an empty cache. Memory is that of all its processes together,
shared parts counted once (PSS, Linux), looked at every 0.2 s. With --killed it is killed by SIGKILL as soon
as half of its scans are in the cache, and started again: "kept" are the scans that the cache holds then,
"made" those that the second run described. What was worked on when it was killed, a scan in each job, is in
none of them and the only work that is done twice.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import signal
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir

import psutil

from common import command, print_table
from shapeconcepts import ScanError, datasets
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.parallel import map_in_order
from shapeconcepts.simulation.categories import CATEGORIES

COMMAND = Path(sys.executable).with_name("shapeconcepts")
EVERY = 0.2


def write_scan(task: tuple[Path, int, int]) -> Path | None:
    """The n-th simulated scan as a file in a folder of its category; None where nothing much is visible."""
    folder, seed, number = task
    category = CATEGORIES[number % len(CATEGORIES)]
    path = folder / category / f"{number // len(CATEGORIES):05d}.pcd"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            write_pcd(path, datasets.simulate_scan(category, number // len(CATEGORIES), random_state=seed))
        except ScanError:
            return None
    return path


def learn(
    files: list[Path], place: Path, jobs: int, until_kept: int | None = None
) -> tuple[float, float, float]:
    """Seconds, and the largest memory in GB of all processes and of the first; killed at so many kept."""
    listing = place / "scans"
    if not listing.exists():
        listing.mkdir()
        for number, path in enumerate(files):
            (listing / path.parent.name).mkdir(exist_ok=True)
            (listing / path.parent.name / f"{number}.pcd").symlink_to(path.resolve())
    arguments = [
        "learn",
        listing,
        "--model",
        place / "model",
        "--report",
        place / "report.html",
        "--jobs",
        jobs,
    ]
    environment = {**os.environ, "XDG_CACHE_HOME": str(place / "cache")}
    del environment["OMP_NUM_THREADS"]
    start = time.perf_counter()
    with (place / "said").open("w") as said:
        process = subprocess.Popen(
            [COMMAND, *map(str, arguments)], env=environment, stdout=subprocess.DEVNULL, stderr=said
        )
    largest = first = 0.0
    watched = psutil.Process(process.pid)
    while process.poll() is None:
        time.sleep(EVERY)
        sizes = list(map(_memory, [watched, *_children(watched)]))
        largest, first = max(largest, sum(sizes)), max(first, sizes[0])
        if until_kept is not None and len(kept(place)) >= until_kept:
            process.send_signal(signal.SIGKILL)
            process.wait()
            return time.perf_counter() - start, largest, first
    if process.returncode:
        sys.exit((place / "said").read_text())
    return time.perf_counter() - start, largest, first


def kept(place: Path) -> set[Path]:
    """Entries of the cache of descriptions."""
    return {
        path
        for path in (place / "cache/shapeconcepts/descriptions").rglob("*")
        if path.is_file() and path.name[0] != "."
    }


def _children(process: psutil.Process) -> list[psutil.Process]:
    try:
        return process.children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def _memory(process: psutil.Process) -> float:
    try:
        return process.memory_full_info().pss / 2**30
    except (psutil.NoSuchProcess, psutil.AccessDenied):
        return 0.0


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--scans", nargs="+", type=int, default=[350, 20_000], metavar="N")
    parser.add_argument("--seed", type=int, default=100)
    parser.add_argument("--folder", type=Path, default=Path(gettempdir()) / "shapeconcepts_files")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    parser.add_argument("--killed", action="store_true", help="kill it half-way, and start it again")
    options = parser.parse_args()
    tasks = [
        (options.folder / str(options.seed), options.seed, number) for number in range(max(options.scans))
    ]
    files = [path for path in map_in_order(write_scan, tasks, options.jobs) if path]
    rows = []
    for n_scans in options.scans:
        with TemporaryDirectory() as name:
            place = Path(name)
            first_run = ["", ""]
            if options.killed:
                learn(files[:n_scans], place, options.jobs, until_kept=n_scans // 2)
                time.sleep(1.0)
                before = kept(place)
            seconds, largest, first = learn(files[:n_scans], place, options.jobs)
            if options.killed:
                first_run = [f"{len(before):,}", f"{len(kept(place) - before):,}"]
            size = (place / "report.html").stat().st_size / 2**20
        figures = (
            f"{seconds:.0f}",
            f"{1000 * seconds / n_scans:.1f}",
            f"{largest:.2f}",
            f"{first:.2f}",
            f"{size:.1f}",
        )
        rows.append((f"{n_scans:,}", *figures, *first_run))
        print(*rows[-1], flush=True)
    titles = (
        "scans",
        "learn, s",
        "each, ms",
        "all processes, GB",
        "the first, GB",
        "report, MB",
        "kept",
        "made",
    )
    print_table(titles, rows)


if __name__ == "__main__":
    main()
