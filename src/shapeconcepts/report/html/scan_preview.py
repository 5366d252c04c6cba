"""A scan made small enough that a thousand of them fit into one page."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.report.camera import view_axes
from shapeconcepts.report.html.object_size import object_sides
from shapeconcepts.report.palette import SEGMENT_COLOURS
from shapeconcepts.segmentation import SegmentedObject

NO_SEGMENT = 15


@dataclass(frozen=True, eq=False)
class ScanPreview:
    """A few hundred surface elements of a scan, as the sensor saw it.

    Attributes
    ----------
    positions : (k, 3) uint8
        Right, up and towards the sensor. 255 steps are `extent`, and the middle of the object is at 127.5.
    normals : (k, 2) uint8
        Components to the right and up of the unit normals, turned towards the sensor: 0 is -1, 255 is 1.
    segments : (k,) uint8
        Colour number of each element's segment, 15 for none.
    sizes : (k,) uint8
        How full of points its cell is, 0 to 15.
    extent : float
        Longest side of the object's bounding box in this frame, metres.
    spacing : float
        Edge length of the cells that the elements stand for, metres.
    sides : tuple of 3 float
        Size of the object along axes of its own, the longest first, metres.
    """

    positions: NDArray[np.uint8]
    normals: NDArray[np.uint8]
    segments: NDArray[np.uint8]
    sizes: NDArray[np.uint8]
    extent: float
    spacing: float
    sides: tuple[float, float, float]

    def to_bytes(self) -> bytes:
        """Six bytes for each element: position, normal, and 16 times its size plus its segment."""
        return np.column_stack([self.positions, self.normals, 16 * self.sizes + self.segments]).tobytes()

    def thinned(self, n_points: int) -> ScanPreview:
        """At most so many of its elements, evenly picked and the larger."""
        n = len(self.positions)
        if n <= n_points:
            return self
        kept = np.arange(n_points) * n // n_points
        return replace(
            self,
            positions=self.positions[kept],
            normals=self.normals[kept],
            segments=self.segments[kept],
            sizes=self.sizes[kept],
            spacing=self.spacing * float(np.sqrt(n / n_points)),
        )


def preview(segmented: SegmentedObject, n_points: int = 400) -> ScanPreview:
    """Thin a scan out to what a report shows of it.

    Points that share a cell of a coarser grid and a segment become one surface element at their mean, so the
    shape and the borders of segments stay. The elements do not depend on the order of the points beyond
    rounding.

    Parameters
    ----------
    segmented : SegmentedObject
    n_points : int
        Largest number of elements, at least 1.

    Returns
    -------
    ScanPreview

    Raises
    ------
    ValueError
        If `n_points` is not positive.
    """
    if n_points < 1:
        raise ValueError(f"n_points must be at least 1, got {n_points!r}")
    axes = view_axes(segmented.points, segmented.normals, segmented.viewpoint)
    points, normals = segmented.points @ axes.T, segmented.normals @ axes.T
    points -= (points.min(axis=0) + points.max(axis=0)) / 2
    extent = float(np.ptp(points, axis=0).max())
    element, spacing = _elements(points, segmented.segment_labels, segmented.voxel_size, n_points)
    counts = np.bincount(element)
    means = [np.bincount(element, column) / counts for column in np.hstack([points, normals]).T]
    positions, directions = np.stack(means[:3], axis=1), np.stack(means[3:], axis=1)
    # A disc has two sides: the one towards the sensor is told by two numbers.
    directions[directions[:, 2] < 0] *= -1
    directions /= np.maximum(np.linalg.norm(directions, axis=1), 1e-12)[:, None]
    labels = np.full(len(counts), -1)
    labels[element] = segmented.segment_labels
    return ScanPreview(
        _quantised(positions / max(extent, 1e-12) + 0.5),
        _quantised(directions[:, :2] / 2 + 0.5),
        np.where(labels < 0, NO_SEGMENT, labels % len(SEGMENT_COLOURS)).astype(np.uint8),
        np.rint(15 * np.minimum(np.sqrt(counts / np.median(counts)), 1)).astype(np.uint8),
        extent,
        spacing,
        object_sides(segmented),
    )


def _elements(
    points: NDArray[np.float64], labels: NDArray[np.int32], voxel_size: float, n_points: int
) -> tuple[NDArray[np.int64], float]:
    """Element of each point, and the edge length of the finest cells that give at most `n_points` elements.

    More segments than elements: then they share, cell by cell.
    """
    if len(points) <= n_points:
        return np.arange(len(points)), voxel_size
    edge = voxel_size * float(np.sqrt(len(points) / n_points))
    coarsest = 2 * float(np.abs(points).max()) + edge
    best, spacing = _cells(points, labels, coarsest), coarsest
    if best.max() >= n_points:
        best = best * n_points // (best.max() + 1)
    # Surfaces: the number of cells falls with the square of their edge.
    for _ in range(5):
        cells = _cells(points, labels, edge)
        n_cells = int(cells.max()) + 1
        if n_cells <= n_points and edge < spacing:
            best, spacing = cells, edge
        edge *= float(np.sqrt(n_cells / n_points)) * 1.005
    return best, spacing


def _cells(points: NDArray[np.float64], labels: NDArray[np.int32], edge: float) -> NDArray[np.int64]:
    """Number of each point's pair of cell and segment."""
    keys = labels.astype(np.int64) - int(labels.min())
    for column in np.floor(points.T / edge).astype(np.int64):
        column -= column.min()
        keys = keys * (int(column.max()) + 1) + column
    return np.unique(keys, return_inverse=True)[1].ravel()


def _quantised(values: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.rint(np.clip(values, 0, 1) * 255).astype(np.uint8)
