"""`shapeconcepts watch`, killed again and again while scans arrive: none is lost, none counts twice.

    python benchmarks/watch_kills.py [--kills N] [--scans N]

A model of 24 simulated scans watches a folder into which others are moved, one after the other. It is killed
by SIGKILL at random moments, 0 to 9 s after its start, and started again; after each kill the model is
loaded. In the end every scan is to be in it once.
"""

import os
import signal
import subprocess
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread

import numpy as np

from common import command, print_table
from shapeconcepts import ShapeConceptModel, datasets, load_model
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.simulation.categories import CATEGORIES

SECONDS = 9.0


def write_scans(folder: Path, n_scans: int, seconds: float) -> None:
    """Scans that arrive evenly within so many seconds, each moved into the folder when it is whole."""
    start = time.monotonic()
    for number in range(n_scans):
        category = list(CATEGORIES)[number % len(CATEGORIES)]
        whole = folder.parent / f"{number}.part"
        write_pcd(whole, datasets.simulate_scan(category, number, random_state=77))
        whole.rename(folder / f"{number}.pcd")
        time.sleep(max(start + seconds * number / n_scans - time.monotonic(), 0))


def watch(folder: Path, model: Path, *options: str) -> subprocess.Popen:
    arguments = [
        "-m",
        "shapeconcepts",
        "watch",
        str(folder),
        "--model",
        str(model),
        "--every",
        "0.1",
        *options,
    ]
    return subprocess.Popen(
        [sys.executable, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--kills", type=int, default=50, metavar="N")
    parser.add_argument("--scans", type=int, default=500, metavar="N")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rng = np.random.default_rng(0)
    with TemporaryDirectory() as place:
        folder, model = Path(place) / "scans", Path(place) / "m.safetensors"
        folder.mkdir()
        first = datasets.simulate(4, categories=list(CATEGORIES)[:6], random_state=1)
        ShapeConceptModel().fit(first).save(model)
        writer = Thread(
            target=write_scans, args=(folder, options.scans, 0.5 * options.kills * SECONDS), daemon=True
        )
        writer.start()
        grown = []
        for _ in range(options.kills):
            process = watch(folder, model, "--save-every", "2")
            time.sleep(rng.uniform(0, SECONDS))
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
            grown.append(len(load_model(model).scan_names_))
        writer.join()
        process = watch(folder, model, "--once")
        code = process.wait()
        counts = Counter(load_model(model).scan_names_[len(first) :])
        names = {f"{number}.pcd" for number in range(options.scans)}
        rows = [
            ["kills", str(options.kills)],
            ["of these, after the model had grown", str(int((np.diff(grown, prepend=len(first)) > 0).sum()))],
            ["models that could not be loaded", "0"],
            ["exit code in the end", str(code)],
            ["scans lost", str(len(names - set(counts)))],
            ["scans counted twice", str(sum(count > 1 for count in counts.values()))],
        ]
    print_table(("watch", ""), rows)


if __name__ == "__main__":
    main()
