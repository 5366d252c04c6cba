"""Time and memory of learning motifs and of stimuli, in one thread, with warm kernels.

    python benchmarks/motif_speed.py

350 scans of ../shared/data/seven_shapes train hierarchies, the others are transformed one by one. "described"
starts from histograms of the segments, "segmented" from segments, so that it includes the description. The
worst case is an object of 12 segments that are all adjacent, with random histograms: 4,095 constellations. It
meets hierarchies in which such an object lies already. What is computed once after learning (bandwidths of
single prototypes) is shown by itself: the first row, of a small object, after that object was learned.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import pickle
import re
import time
import warnings
from itertools import combinations
from pathlib import Path

import numpy as np

from common import add_folder, command, ensembles, print_table, scans_in
from shapeconcepts import DescribedObject, describe, segment
from shapeconcepts.descriptors import Description

N_TRAINING = 350
REPEATS = 3


def peak_memory() -> int:
    """Largest resident memory since the last reset, bytes (Linux)."""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(re.search(r"VmHWM:\s+(\d+)", status).group(1))


def reset_peak_memory() -> None:
    Path("/proc/self/clear_refs").write_text("5")


def worst_case(n_bins: int, with_pairs: bool, seed: int) -> DescribedObject:
    generator = np.random.default_rng(seed)
    pairs = np.array(list(combinations(range(12), 2)), np.int32)
    segments = generator.dirichlet(np.full(n_bins, 0.3), 12)
    pair_histograms = generator.dirichlet(np.full(n_bins, 0.3), len(pairs))
    if not with_pairs:
        return DescribedObject(Description(segments), pairs, "twelve segments")
    return DescribedObject(Description(segments, pairs, pair_histograms), pairs, "twelve segments")


def seconds(function, *arguments) -> float:
    start = time.perf_counter()
    function(*arguments)
    return time.perf_counter() - start


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    segmented = [segment(scan) for scan in scans_in(parser, options.folder)]
    order = np.random.default_rng(0).permutation(len(segmented))
    training, new = ([segmented[i] for i in part] for part in (order[:N_TRAINING], order[N_TRAINING:]))
    rows = []
    for name, (descriptor, ensemble) in ensembles().items():

        def describe_and(method, objects, descriptor=descriptor):
            return method([describe(one, descriptor) for one in objects])

        described, new_described = ([describe(one, descriptor) for one in part] for part in (training, new))
        ensemble.fit(described[:20]).transform(new_described[:1])
        _ = ensemble.stimuli_
        fit_described = np.median([seconds(ensemble.fit, described) for _ in range(REPEATS)])
        training_rows = seconds(getattr, ensemble, "stimuli_")
        fit_segmented = np.median([seconds(describe_and, ensemble.fit, training) for _ in range(REPEATS)])
        each_described = 1e3 * np.array(
            [seconds(ensemble.transform, [one]) for one in new_described * REPEATS]
        )
        each_segmented = 1e3 * np.array([seconds(describe_and, ensemble.transform, [one]) for one in new])
        size = len(pickle.dumps(ensemble)) / 1e6
        n_bins, with_pairs = described[0].description.n_bins, len(described[0].description.pairs) > 0
        ensemble.partial_fit([worst_case(n_bins, with_pairs, seed=1)])
        first_row = seconds(ensemble.transform, new_described[:1])
        reset_peak_memory()
        before = peak_memory()
        worst = seconds(ensemble.transform, [worst_case(n_bins, with_pairs, seed=2)])
        worst_memory = (peak_memory() - before) / 1e6
        rows.append(
            [
                name,
                f"{fit_described:.2f} + {training_rows:.2f}",
                f"{fit_segmented:.2f}",
                f"{np.median(each_described):.2f} / {np.percentile(each_described, 99):.1f}",
                f"{np.median(each_segmented):.2f} / {np.percentile(each_segmented, 99):.1f}",
                f"{first_row:.2f}",
                f"{worst:.2f}",
                f"{worst_memory:.0f}",
                f"{size:.1f}",
            ]
        )
    print(f"{len(training)} training objects")
    print_table(
        (
            "",
            "fit described + stimuli_, s",
            "fit segmented, s",
            "transform described, median / 99 %, ms",
            "transform segmented, ms",
            "first row, s",
            "worst case, s",
            "its memory, MB",
            "model, MB",
        ),
        rows,
    )


if __name__ == "__main__":
    main()
