"""How the time and memory of preparing and segmenting grow with the number of points.

    python benchmarks/growth.py [--points N ...]

Three surfaces, each with 1 mm of noise: the visible faces of a cube that grows with its number of points,
three to a voxel of 5 mm ("larger cube"); stairs of 12 cm that grow likewise, with more steps than an object
has segments ("longer stairs"); and a cube of 30 cm that is sampled more and more densely ("denser cube").
Each size runs in a process of its own, with warm kernels: shown are the median time of three runs, and the
peak memory of the whole process.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import json
import resource
import subprocess
import sys
import time

import numpy as np
from numpy.typing import NDArray

from common import command, print_table

SIZES = (3_000, 10_000, 30_000, 100_000, 300_000)
VOXEL_SIZE = 0.005
POINTS_PER_VOXEL = 3
DENSE_EDGE = 0.3
STEP = 0.12
NOISE = 0.001
RUNS = 3


def cube(n_points: int, edge: float, generator: np.random.Generator) -> NDArray[np.float64]:
    """Points (n, 3) on the three faces of a cube that meet in its corner at (0, 0, 0)."""
    points = edge * generator.random((n_points, 3))
    points[np.arange(n_points), generator.integers(0, 3, n_points)] = 0
    return points


def stairs(n_points: int, width: float, generator: np.random.Generator) -> NDArray[np.float64]:
    """Points (n, 3) on steps that rise away from the sensor, as wide as they are long in all."""
    along = width * generator.random(n_points)
    step, place = np.divmod(along, 2 * STEP)
    depth = step * STEP + np.maximum(place - STEP, 0)
    height = step * STEP + np.minimum(place, STEP)
    return np.column_stack([width * generator.random(n_points), depth, height])


def make_points(shape: str, n_points: int) -> NDArray[np.float64]:
    generator = np.random.default_rng(0)
    area = n_points / POINTS_PER_VOXEL * VOXEL_SIZE**2
    if shape == "longer stairs":
        points = stairs(n_points, np.sqrt(area), generator)
    else:
        points = cube(n_points, np.sqrt(area / 3) if shape == "larger cube" else DENSE_EDGE, generator)
    return points + generator.normal(0, NOISE, points.shape)


def measure(shape: str, n_points: int) -> None:
    """Print what one size takes, as JSON."""
    from shapeconcepts import Scan, segment
    from shapeconcepts.preparation import prepare

    viewpoint = np.array([-1.0, -2.0, -3.0 if "cube" in shape else 3.0])
    segment(Scan(make_points(shape, 3_000), viewpoint))
    scan = Scan(make_points(shape, n_points), viewpoint)
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        prepared = prepare(scan, voxel_size=VOXEL_SIZE)
        middle = time.perf_counter()
        segmented = segment(prepared)
        times.append((middle - start, time.perf_counter() - middle))
    seconds = np.median(times, axis=0)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    memory = peak * (1 if sys.platform == "darwin" else 1024)
    print(json.dumps([len(segmented.points), segmented.n_segments, *seconds, memory]))


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--points", type=int, nargs="+", default=SIZES, metavar="N", help="numbers of points")
    parser.add_argument("--measure", nargs=2, metavar=("SHAPE", "N"), help="only one size, printed as JSON")
    options = parser.parse_args()
    if options.measure:
        measure(options.measure[0], int(options.measure[1]))
        return
    rows, exponents = [], []
    for shape in ("larger cube", "longer stairs", "denser cube"):
        totals = []
        for n_points in options.points:
            arguments = [sys.executable, __file__, "--measure", shape, str(n_points)]
            answer = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout
            voxels, n_segments, prepare_seconds, segment_seconds, memory = json.loads(answer)
            totals.append(prepare_seconds + segment_seconds)
            seconds = (f"{value:.3f}" for value in (prepare_seconds, segment_seconds, totals[-1]))
            rows.append([shape, n_points, voxels, n_segments, *seconds, f"{memory / 1e6:.0f}"])
        if len(totals) > 1:
            exponents.append(f"{shape} {np.polyfit(np.log(options.points), np.log(totals), 1)[0]:.2f}")
    print_table(("", "points", "voxels", "segments", "prepare, s", "segment, s", "sum, s", "peak, MB"), rows)
    if exponents:
        print("exponent of the time over the number of points: " + ", ".join(exponents))


if __name__ == "__main__":
    main()
