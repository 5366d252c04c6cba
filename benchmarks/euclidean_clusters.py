"""What users of Open3D do to find objects in a scene: planes by RANSAC, then clusters of what is left."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from shapeconcepts import Scene

VOXEL_SIZE = 0.005
PLANE_DISTANCE = 0.01
# A room has more large planes than one: table, wall, floor. None of an object is as large.
SMALLEST_PLANE = 0.15
CLUSTER_DISTANCE = 0.02
CLUSTER_NEIGHBOURS = 10
FEWEST_POINTS = 300


class Cluster(NamedTuple):
    """A cluster's points, as places in the scene's flat points; it never tells that it may be several."""

    indices: NDArray[np.int64]
    may_be_several: bool = False


def plane_and_clusters(scene: Scene) -> list[Cluster]:
    """Clusters (DBSCAN) of the points that are in no large plane, on a grid of 5 mm."""
    o3d.utility.random.seed(0)
    places = np.flatnonzero(np.isfinite(scene.points.reshape(-1, 3)).all(axis=1))
    points = scene.points.reshape(-1, 3)[places]
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    voxels, _, members = cloud.voxel_down_sample_and_trace(VOXEL_SIZE, points.min(axis=0), points.max(axis=0))
    left = np.arange(len(members))
    while len(left) > SMALLEST_PLANE * len(members):
        _, plane = voxels.select_by_index(left).segment_plane(PLANE_DISTANCE, 3, 1000)
        if len(plane) < SMALLEST_PLANE * len(members):
            break
        left = np.delete(left, plane)
    clusters = np.asarray(
        voxels.select_by_index(left).cluster_dbscan(eps=CLUSTER_DISTANCE, min_points=CLUSTER_NEIGHBOURS)
    )
    found = []
    for number in range(clusters.max(initial=-1) + 1):
        own = np.concatenate([members[voxel] for voxel in left[clusters == number]])
        if len(own) >= FEWEST_POINTS:
            found.append(Cluster(places[own]))
    return found
