"""Time of learning from segmented scans in one job and in several: threads, and processes.

    python benchmarks/jobs.py [folder] [--scans N] [--jobs N] [--repeats N]

In turns, after one round that compiles and starts the processes; medians. Processes are joblib's (loky), and
stay from one round to the next; the first round is shown beside. Stimuli must be the same to the last bit.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import time
import warnings

import joblib
import numpy as np

from common import add_folder, command, print_table, scans_in
from shapeconcepts import ScanError, SegmentedObject, ShapeConceptModel, segment


def seconds(segmented: list[SegmentedObject], n_jobs: int, backend: str | None) -> tuple[float, bytes]:
    """Time of a fit, and the stimuli that it gave."""
    start = time.perf_counter()
    with joblib.parallel_config(backend=backend) if backend else joblib.parallel_config():
        model = ShapeConceptModel(n_jobs=n_jobs).fit(segmented)
    return time.perf_counter() - start, model.stimuli_.data.tobytes()


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--scans", type=int, default=300, metavar="N")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    parser.add_argument("--repeats", type=int, default=7, metavar="N")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    segmented = []
    for scan in scans_in(parser, options.folder)[: options.scans]:
        try:
            segmented.append(segment(scan))
        except ScanError as error:
            print(error)
    ways = {
        "one job": (1, None),
        f"{options.jobs} jobs, as they come": (options.jobs, None),
        f"{options.jobs} processes": (options.jobs, "loky"),
    }
    taken: dict[str, list[float]] = {way: [] for way in ways}
    stimuli = set()
    for _ in range(options.repeats + 1):
        for way, (n_jobs, backend) in ways.items():
            duration, rows = seconds(segmented, n_jobs, backend)
            taken[way].append(duration)
            stimuli.add(rows)
    assert len(stimuli) == 1, "the stimuli differ"
    one = np.array(taken["one job"][1:])
    rows = [
        (way, f"{np.median(times[1:]):.2f}", f"{np.median(times[1:] / one):.2f}", f"{times[0]:.2f}")
        for way, times in taken.items()
    ]
    print_table((f"fit of {len(segmented)} segmented scans", "s", "of one job", "first round, s"), rows)


if __name__ == "__main__":
    main()
