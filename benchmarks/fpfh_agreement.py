"""FPFH against Open3D's: agreement per point, and time in one thread, on the same points, normals and radius.

    python benchmarks/fpfh_agreement.py [FOLDER] [--every N]

FOLDER holds PCD scans in metres with the camera at the origin; by default ../shared/data/seven_shapes beside
the repository. Open3D makes the 5 mm voxels and the normals (1.5 cm) that both sides are given.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when Open3D is imported

import time
from pathlib import Path

import numpy as np
import open3d as o3d

from common import add_folder, command
from shapeconcepts.descriptors import FPFH, compute_fpfh
from shapeconcepts.segmentation.segmented_object import SegmentedObject

VOXEL_SIZE = 0.005
NORMAL_RADIUS = 0.015
RADIUS = 0.03


def voxels_with_normals(path: Path) -> o3d.geometry.PointCloud:
    cloud = o3d.io.read_point_cloud(str(path), remove_nan_points=True).voxel_down_sample(VOXEL_SIZE)
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamRadius(NORMAL_RADIUS))
    cloud.orient_normals_towards_camera_location(np.zeros(3))
    return cloud


def open3d_fpfh(cloud: o3d.geometry.PointCloud) -> np.ndarray:
    search = o3d.geometry.KDTreeSearchParamRadius(RADIUS)
    return np.asarray(o3d.pipelines.registration.compute_fpfh_feature(cloud, search).data).T


def in_one_segment(points: np.ndarray, normals: np.ndarray) -> SegmentedObject:
    labels = np.zeros(len(points), np.int32)
    return SegmentedObject(
        points, normals, labels, labels, np.empty((0, 2), np.int32), 1, np.arange(len(points)), VOXEL_SIZE
    )


def milliseconds(function, *arguments, repeats: int) -> float:
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function(*arguments)
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument(
        "--every", type=int, default=10, metavar="N", help="take every N-th scan (default: 10)"
    )
    options = parser.parse_args()
    paths = sorted(options.folder.rglob("*.pcd"))[:: options.every]
    if not paths:
        parser.error(f"no PCD files in {options.folder}")

    sizes, cosines, lowest, times = [], [], [], []
    for path in paths:
        cloud = voxels_with_normals(path)
        points, normals = np.asarray(cloud.points), np.asarray(cloud.normals)
        segmented = in_one_segment(points, normals)
        ours, theirs = compute_fpfh(points, normals, RADIUS), open3d_fpfh(cloud)
        lengths = np.linalg.norm(ours, axis=1) * np.linalg.norm(theirs, axis=1)
        with_neighbours = lengths > 0
        cosine = np.einsum("ij,ij->i", ours, theirs)[with_neighbours] / lengths[with_neighbours]
        sizes.append(len(points))
        cosines.append(cosine.mean())
        lowest.append(cosine.min())
        FPFH(RADIUS).describe(segmented)
        times.append(
            [
                milliseconds(FPFH(RADIUS).describe, segmented, repeats=5),
                milliseconds(compute_fpfh, points, normals, RADIUS, repeats=5),
                milliseconds(open3d_fpfh, cloud, repeats=3),
            ]
        )
    segment, per_point, peer = np.median(times, axis=0)
    ratios = np.median(np.array(times)[:, :2] / np.array(times)[:, 2:], axis=0)
    print(f"{len(paths)} scans of {options.folder.name}, {np.median(sizes):.0f} voxels (median)")
    print(f"Open3D {o3d.__version__}")
    print(
        f"cosine with Open3D per point: mean {np.mean(cosines):.6f}, lowest scan {min(cosines):.6f}, "
        f"lowest point {min(lowest):.6f}"
    )
    print("time in one thread, neighbours included, median over scans of the best of some runs:")
    print(f"  Open3D compute_fpfh_feature  {peer:7.2f} ms")
    print(f"  compute_fpfh                 {per_point:7.2f} ms  (median ratio {ratios[1]:.3f})")
    print(f"  FPFH().describe              {segment:7.2f} ms  (median ratio {ratios[0]:.3f})")


if __name__ == "__main__":
    main()
