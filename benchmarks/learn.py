"""Time of `shapeconcepts learn` and `shapeconcepts respond`, from the start of the process to its end.

    python benchmarks/learn.py [--scans N] [--jobs N]

N scans of ../shared/data/seven_shapes, evenly from all categories, are learned from, with a model and a
report, in an empty cache of segmented scans ("cold") and once more ("warm"). The others are responded to in
one thread: "each scan" is the time of the whole command, less the time of the same command for a single scan,
divided by the scans that it has more, so that the start and the loading of the model do not count. Kernels
are compiled and cached by a run before that does not count either. Medians.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from common import add_folder, command, print_table
from shapeconcepts.sources import find_scan_files

COMMAND = Path(sys.executable).with_name("shapeconcepts")


def run(folder: Path, *arguments: object, one_thread: bool = False) -> tuple[float, float]:
    """Seconds by the clock from start to end of the command, and of all cores together (Linux)."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache"), "COLUMNS": "200"}
    if not one_thread:
        # As a user has it.
        del environment["OMP_NUM_THREADS"]
    before, start = os.times(), time.perf_counter()
    subprocess.run(
        [COMMAND, *map(str, arguments)], env=environment, check=True, stdout=subprocess.DEVNULL, cwd=folder
    )
    after = os.times()
    work = after.children_user + after.children_system - before.children_user - before.children_system
    return time.perf_counter() - start, work


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--scans", type=int, default=350, metavar="N", help="to learn from (default: 350)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes (default: 2)")
    parser.add_argument("--repeats", type=int, default=3, metavar="N", help="runs (default: 3)")
    options = parser.parse_args()
    files = [file.path.resolve() for file in find_scan_files(options.folder)]
    training = [files[i * len(files) // options.scans] for i in range(min(options.scans, len(files)))]
    new = [file for file in files if file not in set(training)] or files
    cold, warm, single, many = [], [], [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        learn = ("learn", *training, "--model", "m", "--report", "r.html", "--jobs", options.jobs)
        run(folder, "learn", *training[:20], "--model", "m", "--report", "r.html", "--no-cache")
        for _ in range(options.repeats):
            shutil.rmtree(folder / "cache", ignore_errors=True)
            cold.append(run(folder, *learn))
            warm.append(run(folder, *learn))
            respond = ("respond", "m", "--format", "csv", "--jobs", 1)
            single.append(run(folder, *respond, new[0], one_thread=True))
            many.append(run(folder, *respond, *new, one_thread=True))

    def middle(runs: list[tuple[float, float]]) -> list[str]:
        return [f"{statistics.median(times):.2f}" for times in zip(*runs, strict=True)]

    each = [
        [(m - s) / (len(new) - 1) for m, s in zip(*pair, strict=True)]
        for pair in zip(many, single, strict=True)
    ]
    print_table(
        ("", "by the clock", "of all cores"),
        [
            [f"learn, {len(training)} scans, cold cache, s", *middle(cold)],
            ["the same, warm cache, s", *middle(warm)],
            ["respond, 1 scan, s", *middle(single)],
            [f"respond, {len(new)} scans, s", *middle(many)],
            [
                "each scan, ms",
                *(f"{1e3 * statistics.median(times):.1f}" for times in zip(*each, strict=True)),
            ],
        ],
    )


if __name__ == "__main__":
    main()
