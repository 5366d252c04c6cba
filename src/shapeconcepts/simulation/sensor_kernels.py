"""Compiled loops of the simulated sensor: z-buffer, shadow of the projector, continuity."""

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

NOTHING = -1
# A pixel centre on the edge that two triangles share may fall outside both by rounding.
SLACK = 1e-9


@kernel
def rasterise(
    projected: NDArray[np.float64], faces: NDArray[np.int64], n_rows: int, n_columns: int
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Nearest triangle at every pixel centre.

    Parameters
    ----------
    projected : (v, 3) float64
        Column and row in pixels and inverse depth in 1/m of each vertex.
    faces : (f, 3) int64
    n_rows, n_columns : int
        Size of the image.

    Returns
    -------
    triangles : (n_rows, n_columns) int32
        Index of the nearest triangle, `NOTHING` where there is none.
    inverse_depth : (n_rows, n_columns) float64
        Its inverse depth, 0 where there is none. It is linear in the image, hence exact under perspective.
    """
    triangles = np.full((n_rows, n_columns), NOTHING, dtype=np.int32)
    inverse_depth = np.zeros((n_rows, n_columns))
    for triangle in range(len(faces)):
        a, b, c = faces[triangle, 0], faces[triangle, 1], faces[triangle, 2]
        ax, ay, az = projected[a, 0], projected[a, 1], projected[a, 2]
        bx, by, bz = projected[b, 0], projected[b, 1], projected[b, 2]
        cx, cy, cz = projected[c, 0], projected[c, 1], projected[c, 2]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0.0:
            continue
        first_column = max(int(np.ceil(min(ax, bx, cx))), 0)
        last_column = min(int(np.floor(max(ax, bx, cx))), n_columns - 1)
        first_row = max(int(np.ceil(min(ay, by, cy))), 0)
        last_row = min(int(np.floor(max(ay, by, cy))), n_rows - 1)
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                weight_b = ((column - ax) * (cy - ay) - (row - ay) * (cx - ax)) / area
                weight_c = ((bx - ax) * (row - ay) - (by - ay) * (column - ax)) / area
                if weight_b < -SLACK or weight_c < -SLACK or weight_b + weight_c > 1.0 + SLACK:
                    continue
                value = az + weight_b * (bz - az) + weight_c * (cz - az)
                if value > inverse_depth[row, column]:
                    inverse_depth[row, column] = value
                    triangles[row, column] = triangle
    return triangles, inverse_depth


@kernel
def lit_by_projector(disparity: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which pixels the pattern projector, right of the camera, reaches.

    In a rectified pair the projector sees the visible points of an image row in the same order as the camera.
    A point that comes after one on its right is hidden from the projector by that one.

    Parameters
    ----------
    disparity : (h, w) float64
        Pixels; 0 where nothing was hit.

    Returns
    -------
    lit : (h, w) bool
    """
    n_rows, n_columns = disparity.shape
    lit = np.zeros((n_rows, n_columns), dtype=np.bool_)
    for row in range(n_rows):
        leftmost = np.inf
        for column in range(n_columns - 1, -1, -1):
            if disparity[row, column] == 0.0:
                continue
            seen_at = column - disparity[row, column]
            lit[row, column] = seen_at <= leftmost
            leftmost = min(leftmost, seen_at)
    return lit


@kernel
def continuity(inverse_depth: NDArray[np.float64], tolerance: float) -> NDArray[np.float64]:
    """Share of the eight neighbours of each pixel whose depth is within a tolerance of its own.

    Parameters
    ----------
    inverse_depth : (h, w) float64
        1/m, 0 where nothing was hit.
    tolerance : float
        Largest difference of depth on one surface, relative to the depth.

    Returns
    -------
    share : (h, w) float64
    """
    n_rows, n_columns = inverse_depth.shape
    share = np.zeros((n_rows, n_columns))
    for row in range(n_rows):
        for column in range(n_columns):
            here = inverse_depth[row, column]
            if here == 0.0:
                continue
            count = 0
            for near_row in range(max(row - 1, 0), min(row + 2, n_rows)):
                for near_column in range(max(column - 1, 0), min(column + 2, n_columns)):
                    if abs(inverse_depth[near_row, near_column] - here) <= tolerance * here:
                        count += 1
            share[row, column] = (count - 1) / 8.0
    return share
