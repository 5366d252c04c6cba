"""Kernels of the Ensemble of Shape Functions."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel

GRID_SIZE = 64
N_BINS = 64
# Rows of the histograms.
_ANGLE, _AREA, _DISTANCE, _RATIO = 0, 3, 6, 9
# Kinds of lines and triangles, added to the row.
_IN, _OUT, _MIXED = 0, 1, 2
# A line with at most this many occupied voxels is outside: both ends always lie on the surface.
_ENDS = 7
# Triples of which no triangle can be made, for each that is wanted, before giving up.
_PATIENCE = 10


@kernel
def random_index(counter: int, n: int) -> np.int64:
    """A number below n that depends on the counter only (splitmix64, Steele et al. 2014)."""
    z = np.uint64(counter) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return np.int64((z >> np.uint64(32)) * np.uint64(n) >> np.uint64(32))


@kernel
def occupied_voxels(voxels: NDArray[np.int64]) -> NDArray[np.bool_]:
    """The grid with every voxel of a point and its 26 neighbours marked, (64, 64, 64)."""
    occupied = np.zeros((GRID_SIZE, GRID_SIZE, GRID_SIZE), np.bool_)
    for point in range(len(voxels)):
        x, y, z = voxels[point]
        for i in range(max(x - 1, 0), min(x + 2, GRID_SIZE)):
            for j in range(max(y - 1, 0), min(y + 2, GRID_SIZE)):
                for k in range(max(z - 1, 0), min(z + 2, GRID_SIZE)):
                    occupied[i, j, k] = True
    return occupied


@kernel
def trace(occupied: NDArray[np.bool_], start: NDArray[np.int64], end: NDArray[np.int64]) -> tuple[int, int]:
    """Voxels on the line between two, the ends included, and how many of them are occupied."""
    dx, dy, dz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    n_steps = max(abs(dx), abs(dy), abs(dz))
    n_occupied = 0
    for step in range(n_steps + 1):
        # Rounded to the nearest voxel in whole numbers.
        x = start[0] + (2 * dx * step + n_steps) // (2 * n_steps) if n_steps else start[0]
        y = start[1] + (2 * dy * step + n_steps) // (2 * n_steps) if n_steps else start[1]
        z = start[2] + (2 * dz * step + n_steps) // (2 * n_steps) if n_steps else start[2]
        n_occupied += occupied[x, y, z]
    return n_steps + 1, n_occupied


@kernel
def _bin(value: float, largest: float) -> int:
    return min(max(int(value / largest * (N_BINS - 1) + 0.5), 0), N_BINS - 1)


@kernel
def _line_kind(n_voxels: int, n_occupied: int) -> int:
    if n_occupied >= n_voxels - 1:
        return _IN
    return _OUT if n_occupied <= _ENDS else _MIXED


@kernel
def _triangle_kind(n_voxels: int, n_occupied: int) -> int:
    if n_occupied <= 3 * _ENDS:
        return _OUT
    return _IN if n_voxels - n_occupied < 4 else _MIXED


@kernel
def _angle_bin(opposite: float, one: float, other: float) -> int:
    """Bin of the acute angle between two sides of a triangle."""
    cosine = abs(one * one + other * other - opposite * opposite) / (2.0 * one * other)
    return _bin(math.acos(min(cosine, 1.0)), 0.5 * math.pi)


@kernel
def shape_functions(
    points: NDArray[np.float64], voxels: NDArray[np.int64], n_triples: int, smallest_area: float
) -> NDArray[np.float64]:
    """Histograms of angles, areas and distances of random triples of points.

    Parameters
    ----------
    points : (m, 3) float64
        At least three.
    voxels : (m, 3) int64
        Voxel of each point, 0 to 63.
    n_triples : int
    smallest_area : float
        Triples that span less are left out.

    Returns
    -------
    (10, 64) float64
        Angles, areas, distances (each inside, outside, mixed) and share inside of the mixed lines.
    """
    occupied = occupied_voxels(voxels)
    histograms = np.zeros((10, N_BINS))
    areas = np.empty(n_triples)
    area_rows = np.empty(n_triples, np.int64)
    distances = np.empty((n_triples, 3))
    distance_rows = np.empty((n_triples, 3), np.int64)
    triple = np.empty(3, np.int64)
    lengths = np.empty(3, np.int64)
    found = 0
    for trial in range(_PATIENCE * n_triples):
        if found == n_triples:
            break
        for corner in range(3):
            triple[corner] = random_index(3 * trial + corner + 1, len(points))
        # The side across each corner.
        for corner in range(3):
            first, second = triple[(corner + 1) % 3], triple[(corner + 2) % 3]
            dx = points[first, 0] - points[second, 0]
            dy = points[first, 1] - points[second, 1]
            dz = points[first, 2] - points[second, 2]
            distances[found, corner] = math.sqrt(dx * dx + dy * dy + dz * dz)
        a, b, c = distances[found]
        half = 0.5 * (a + b + c)
        area = math.sqrt(max(half * (half - a) * (half - b) * (half - c), 0.0))
        if area <= smallest_area:
            continue
        all_voxels, all_occupied = 0, 0
        for corner in range(3):
            n_voxels, n_occupied = trace(
                occupied, voxels[triple[(corner + 1) % 3]], voxels[triple[(corner + 2) % 3]]
            )
            kind = _line_kind(n_voxels, n_occupied)
            distance_rows[found, corner] = _DISTANCE + kind
            if kind == _MIXED:
                histograms[_RATIO, _bin(n_occupied / n_voxels, 1.0)] += 1.0
            lengths[corner] = n_voxels
            all_voxels += n_voxels
            all_occupied += n_occupied
        kind = _triangle_kind(all_voxels, all_occupied)
        for corner in range(3):
            angle = (
                _angle_bin(a, b, c)
                if corner == 0
                else _angle_bin(b, c, a)
                if corner == 1
                else _angle_bin(c, a, b)
            )
            histograms[_ANGLE + kind, angle] += lengths[corner] / (GRID_SIZE / 2)
        areas[found] = math.sqrt(area)
        area_rows[found] = _AREA + kind
        found += 1
    if found:
        largest_area, largest_distance = areas[:found].max(), distances[:found].max()
        for k in range(found):
            histograms[area_rows[k], _bin(areas[k], largest_area)] += 1.0
            for corner in range(3):
                histograms[distance_rows[k, corner], _bin(distances[k, corner], largest_distance)] += 1.0
    return histograms
