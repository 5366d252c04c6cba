"""Are segments and descriptions the same after a rigid motion?

    python benchmarks/rigid_motion.py [FOLDER] [--seed N] [--verbose]

FOLDER holds a folder of scans for each category, by default ../shared/data/seven_shapes beside the
repository. Every scan is turned at random and moved by up to 1 m along each axis, its viewpoint with it,
and its coordinates are rounded to 32 bit. Shown are the share of scans with the same number of segments,
and the Jensen-Shannon divergence (bits) of the description of the whole object from that of the unmoved
scan.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from scipy.special import entr

from common import add_folder, command, percent, print_table, scans_in
from shapeconcepts import FPFH, Scan, Surflet, segment

DESCRIPTORS = (FPFH(), Surflet())
SIMPLE = ("box", "can", "ball")
LARGEST_DIVERGENCE = 0.005


def moved(scan: Scan, generator: np.random.Generator) -> Scan:
    turn = Rotation.random(random_state=generator).as_matrix()
    shift = generator.uniform(-1, 1, 3)
    points = (scan.points @ turn.T + shift).astype(np.float32)
    viewpoint = None if scan.viewpoint is None else turn @ scan.viewpoint + shift
    return replace(scan, points=points, viewpoint=viewpoint)


def divergence(p: NDArray[np.float64], q: NDArray[np.float64]) -> float:
    """Jensen-Shannon divergence in bits."""
    return float((entr((p + q) / 2) - (entr(p) + entr(q)) / 2).sum() / np.log(2))


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--seed", type=int, default=0, help="seed of the motions (default: 0)")
    parser.add_argument("--verbose", action="store_true", help="list the scans that change")
    options = parser.parse_args()
    generator = np.random.default_rng(options.seed)
    scans = scans_in(parser, options.folder)
    labels = np.array([scan.label for scan in scans])
    counts, divergences = [], []
    for scan in scans:
        pair = segment(scan), segment(moved(scan, generator))
        counts.append([segmented.n_segments for segmented in pair])
        divergences.append(
            [divergence(*(descriptor.describe(s).whole() for s in pair)) for descriptor in DESCRIPTORS]
        )
        if options.verbose and (counts[-1][0] != counts[-1][1] or max(divergences[-1]) > LARGEST_DIVERGENCE):
            print(f"{scan.name}: {counts[-1][0]} and {counts[-1][1]} segments, divergences {divergences[-1]}")
    same = np.array([before == after for before, after in counts])
    close = np.array(divergences) <= LARGEST_DIVERGENCE
    is_simple = np.isin(labels, SIMPLE)
    groups = [(label, labels == label) for label in sorted(set(labels))]
    groups += [
        ("boxes, cans, balls", is_simple),
        ("the rest", ~is_simple),
        ("all", np.ones(len(scans), bool)),
    ]
    print_table(
        ("", "scans", "same segments, %", *(f"{type(d).__name__} within 0.005, %" for d in DESCRIPTORS)),
        [[n, m.sum(), percent(same[m]), *(percent(column) for column in close[m].T)] for n, m in groups],
    )
    print(
        "median and largest divergence: "
        + ", ".join(
            f"{type(d).__name__} {np.median(column):.1e} and {column.max():.1e}"
            for d, column in zip(DESCRIPTORS, np.transpose(divergences), strict=True)
        )
    )


if __name__ == "__main__":
    main()
