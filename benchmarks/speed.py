"""Time of preparing, segmenting and describing a scan, in one thread, beside Open3D's normals and FPFH.

    python benchmarks/speed.py [FOLDER] [--repeats N]

Takes the scans of 8,000 to 10,000 points in FOLDER, by default ../shared/data/seven_shapes beside the
repository. All kernels are warm. Open3D, where it is installed, gets the voxels that preparation made, with
the radii 1.5 cm for normals and 3 cm for FPFH. The sides take turns, scan by scan; shown is the median over
scans and repeats.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when Open3D is imported

import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np

from common import add_folder, command, print_table, scans_in
from shapeconcepts import FPFH, Scan, Surflet, segment
from shapeconcepts.preparation import prepare

try:
    import open3d as o3d
except (ImportError, OSError) as error:  # its wheel needs system libraries that may be missing
    print(f"Open3D is left out: {error}")
    o3d = None

N_POINTS = (8_000, 10_000)
LEAVES = (("leaf 5 mm", 0.005), ("leaf auto", "auto"))
NORMAL_RADIUS = 0.015
FPFH_RADIUS = 0.03


class Stopwatch:
    """Times of named steps, milliseconds."""

    def __init__(self) -> None:
        self.times: dict[str, list[float]] = defaultdict(list)

    def run(self, step: str, function: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        start = time.perf_counter()
        result = function(*arguments, **options)
        self.times[step].append(1e3 * (time.perf_counter() - start))
        return result

    def median(self, *steps: str) -> float:
        """Median of the sum of some steps."""
        return float(np.median(np.sum([self.times[step] for step in steps], axis=0)))


def open3d_normals_and_fpfh(points: np.ndarray) -> np.ndarray:
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamRadius(NORMAL_RADIUS))
    cloud.orient_normals_towards_camera_location(np.zeros(3))
    search = o3d.geometry.KDTreeSearchParamRadius(FPFH_RADIUS)
    return np.asarray(o3d.pipelines.registration.compute_fpfh_feature(cloud, search).data)


def time_scan(scan: Scan, voxel_size: float | str, watch: Stopwatch) -> None:
    prepared = watch.run("prepare", prepare, scan, voxel_size=voxel_size)
    segmented = watch.run("segment", segment, prepared)
    watch.run("fpfh", FPFH().describe, segmented)
    watch.run("surflet", Surflet().describe, segmented)
    if o3d is not None:
        watch.run("open3d", open3d_normals_and_fpfh, segmented.points)
    watch.times["voxels"].append(len(segmented.points))


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument(
        "--repeats", type=int, default=5, metavar="N", help="runs over all scans (default: 5)"
    )
    options = parser.parse_args()
    scans = [s for s in scans_in(parser, options.folder) if N_POINTS[0] <= len(s) <= N_POINTS[1]]
    if not scans:
        parser.error(f"{options.folder}: holds no scan of {N_POINTS[0]} to {N_POINTS[1]} points")
    print(f"{len(scans)} scans of {np.median([len(scan) for scan in scans]):.0f} points (median)")
    if o3d is not None:
        print(f"Open3D {o3d.__version__}")
    rows = []
    for title, voxel_size in LEAVES:
        time_scan(scans[0], voxel_size, Stopwatch())
        watch = Stopwatch()
        for _ in range(options.repeats):
            for scan in scans:
                time_scan(scan, voxel_size, watch)
        peer = watch.median("open3d") if o3d is not None else np.nan
        fpfh, surflet = (watch.median("prepare", "segment", step) for step in ("fpfh", "surflet"))
        steps = [watch.median(step) for step in ("prepare", "segment", "fpfh", "surflet")]
        rows.append(
            [title, f"{watch.median('voxels'):.0f}"]
            + [f"{figure:.1f}" for figure in (*steps, fpfh, surflet, peer)]
            + [f"{figure / peer:.3f}" for figure in (fpfh, surflet)]
        )
    print("milliseconds, median; sums are prepare + segment + describe, the ratio is that of the medians")
    titles = ("", "voxels", "prepare", "segment", "fpfh", "surflet")
    print_table((*titles, "sum, fpfh", "sum, surflet", "Open3D", "fpfh/Open3D", "surflet/Open3D"), rows)


if __name__ == "__main__":
    main()
