"""Scans far from their origin, turned, and of any size: does a step fail, and are the segments the same?

    NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=/tmp/checked python benchmarks/far_away.py [folder] [--clouds N]

Small clouds of all kinds of degeneracy are segmented and described; nothing but a ScanError may come out. The
scans of a folder are rounded to 1 mm, as in a text file, and moved: their points must have the same labels as
at the origin. With NUMBA_BOUNDSCHECK=1, kernels check every index; their cache must then be another one.
"""

import warnings
from collections import Counter

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from common import add_folder, command, print_table, scans_in
from shapeconcepts import Scan, ScanError, describe, segment

OFFSETS = (0.0, 1e3, 1e4, 1e5, 1e6, 1e7)
SCALES = (1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0)
PLACES = {
    "1 km": (1e3, -1e3, 1e3),
    "UTM": (447_123.0, 5_411_234.0, 312.0),
    "ECEF": (4.2e6, 1.7e5, 4.78e6),
    "10,000 km": (1e7, 1e7, -1e7),
}


def small_cloud(random: np.random.Generator) -> NDArray[np.float64]:
    """Up to 60 points: at random, flat, on a line or lattice, in clumps, repeated; of any size, anywhere."""
    n = int(random.integers(1, 60))
    points = random.normal(size=(n, 3))
    kind = random.integers(7)
    if kind == 1:
        points[:, 2] = 0.0
    elif kind == 2:
        points[:, 1:] = 0.0
    elif kind == 3:
        points = np.rint(3 * points)
    elif kind == 4:
        points = points[random.integers(n, size=n)]
    elif kind == 5:
        points = 1e-6 * points + random.integers(2, size=(n, 1))
    elif kind == 6:
        points[0] *= 1e6
    points = points @ Rotation.random(rng=random).as_matrix().T
    offset = random.choice(OFFSETS) * random.normal(size=3)
    cloud = random.choice(SCALES) * points * 10.0 ** -random.integers(0, 12) + offset
    return np.rint(1e3 * cloud) / 1e3 if random.random() < 0.2 else cloud


def what_happens(cloud: NDArray[np.float64]) -> str:
    try:
        describe(segment(Scan(cloud)))
    except ScanError:
        return "ScanError"
    except Exception as error:
        return f"{type(error).__name__}: {error!s:.60}"
    return "described"


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--clouds", type=int, default=10_000, metavar="N")
    parser.add_argument("--scans", type=int, default=100, metavar="N")
    options = parser.parse_args()
    warnings.simplefilter("ignore")

    outcomes = Counter(what_happens(small_cloud(np.random.default_rng(i))) for i in range(options.clouds))
    print_table(("small clouds", "number"), outcomes.most_common())

    scans = scans_in(parser, options.folder)[: options.scans]
    rows = []
    for place, offset in PLACES.items():
        same = 0
        shares = []
        for scan in scans:
            points = np.rint(1e3 * scan.points) / 1e3
            there, here = (segment(Scan(cloud)) for cloud in (np.rint(1e3 * (points + offset)) / 1e3, points))
            labels = [one.segment_labels[one.point_to_voxel] for one in (there, here)]
            share = np.mean(labels[0] == labels[1])
            same += share == 1.0
            shares.append(share)
        rows.append((place, len(scans), same, f"{100 * np.mean(shares):.2f}", f"{100 * min(shares):.1f}"))
    print_table(("moved by", "scans", "same segments", "same points, %", "least, %"), rows)


if __name__ == "__main__":
    main()
