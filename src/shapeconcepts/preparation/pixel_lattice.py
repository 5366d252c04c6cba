"""Where the sensor was, from the pixel lattice that a depth image leaves in its point cloud."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from shapeconcepts.preparation.pixel_lattice_kernels import propose_lattices, refine_camera

_N_SAMPLES = 200
_N_NEIGHBOURS = 8
# Most clouds are settled by the first few points.
_PROPOSING = (slice(0, 8), slice(8, 48))
_N_PROBES = 270
_N_REFINED = 8
# Pixels from a whole number within which a pair counts, one Gauss-Newton step each: wide enough at first for
# the perspective that a proposal lacks, narrow at last to leave out points that are not on the lattice.
_TOLERANCES = np.array([0.25, 0.2, 0.15, 0.12, 0.1, 0.07, 0.05, 0.03, 0.03, 0.03])
_MIN_MATCHES = 0.06
_ENOUGH_MATCHES = 0.25
_SAME_VIEWPOINT = 0.05
_MAX_ERROR = 0.003
_MAX_DISTORTION = 0.01
_FOCAL_LENGTHS = (100.0, 5000.0)
_MIN_RELATIVE_DEPTH = 0.1
_MAX_OFF_AXIS = np.cos(np.radians(42.0))


def viewpoint_from_pixel_lattice(points: NDArray[np.float64]) -> tuple[NDArray[np.float64] | None, bool]:
    """Position of the sensor, where the points lie on the rays of a pixel lattice.

    A depth camera measures along the rays of its pixels, and depth noise and quantisation move a point along
    its ray only. Seen from the sensor the points are therefore an exact square lattice, and from nowhere
    else. Two neighbours of a point propose such a lattice; the proposals that fit best are refined to a
    perspective camera (a projective one, by Gauss-Newton on the pixel differences of neighbouring points,
    which have to be whole numbers). The camera is believed if its pixels are square, its focal length and
    field of view those of a camera, and far more pairs fit than chance allows. Its centre is the viewpoint.
    All this holds in any rigid frame, in any unit, for a part of the points, and where other points (merged
    pixels) are not on the lattice.

    Parameters
    ----------
    points : (n, 3) float64
        Finite points as measured, not averaged. Their order does not matter.

    Returns
    -------
    viewpoint : (3,) float64 or None
        None where there is no lattice, and where it leaves the side open: points exactly on one plane look
        the same from both.
    is_certain : bool
        True where no point hides another, or no other viewpoint was found. Otherwise points have been merged,
        and the viewpoint may be one beside the sensor from which quantised depth looks like a lattice too.
    """
    if len(points) <= _N_NEIGHBOURS:
        return None, False
    origin = points.mean(axis=0)
    centred = points - origin
    sample = centred[order_free_sample(points, _N_SAMPLES)]
    tree = cKDTree(centred, leafsize=64, balanced_tree=False, compact_nodes=False)
    neighbours = centred[tree.query(sample, _N_NEIGHBOURS + 1)[1][:, 1:]]
    differences = neighbours - sample[:, None]
    starts = np.repeat(sample, _N_NEIGHBOURS, axis=0)
    ends = np.ascontiguousarray(neighbours.reshape(-1, 3))
    probes = differences[:, : _N_NEIGHBOURS // 2].reshape(-1, 3)
    probes = np.ascontiguousarray(probes[:: -(-len(probes) // _N_PROBES)])

    viewpoints: list[NDArray[np.float64]] = []
    qualities: list[float] = []
    for proposing in _PROPOSING:
        scores, lattices = propose_lattices(np.ascontiguousarray(differences[proposing]), probes)
        for lattice in _distinct(scores, lattices):
            camera = np.vstack([lattice, np.zeros(3)])
            n_matches, error = refine_camera(starts, ends, camera, _TOLERANCES)
            matches = n_matches / len(starts)
            if not (matches > _MIN_MATCHES and error < _MAX_ERROR and _is_plausible(camera)):
                continue
            hidden = _hidden_share(centred, camera)
            if hidden == 0.0 and matches > _ENOUGH_MATCHES:
                return _centre(camera) + origin, True
            viewpoints.append(_centre(camera))
            qualities.append(matches * (1.0 - hidden))
    if not viewpoints:
        return None, False
    best = viewpoints[int(np.argmax(qualities))]
    spread = np.linalg.norm(np.array(viewpoints) - best, axis=1).max()
    return best + origin, bool(spread < _SAME_VIEWPOINT * np.linalg.norm(best))


def order_free_sample(points: NDArray[np.float64], n_samples: int) -> NDArray[np.int64]:
    """Rows of up to `n_samples` points, spread as at random but chosen by a hash of the coordinates alone."""
    bits = np.ascontiguousarray(points).view(np.uint64)
    key = np.zeros(len(points), dtype=np.uint64)
    for axis in range(3):
        key = (key ^ bits[:, axis]) * np.uint64(0xBF58476D1CE4E5B9)
        key ^= key >> np.uint64(31)
    n_samples = min(n_samples, len(points))
    chosen = np.argpartition(key, n_samples - 1)[:n_samples]
    return chosen[np.argsort(key[chosen], kind="stable")]


def _distinct(scores: NDArray[np.float64], lattices: NDArray[np.float64]) -> NDArray[np.float64]:
    """The best-scored lattices, at most `_N_REFINED`, no two of them with the same line of sight."""
    kept: list[int] = []
    lines = np.cross(lattices[:, 0], lattices[:, 1])
    lines /= np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), 1e-300)
    for proposal in np.argsort(-scores, kind="stable"):
        if scores[proposal] <= 0 or len(kept) == _N_REFINED:
            break
        if not (np.abs(lines[kept] @ lines[proposal]) > 0.995).any():
            kept.append(int(proposal))
    return lattices[kept]


def _hidden_share(centred: NDArray[np.float64], camera: NDArray[np.float64]) -> float:
    """Share of the points that are on the same pixel as another.

    Quantised disparity is a lattice along the rays, so that views from beside the sensor can be
    whole-numbered too. But only from the sensor itself no point hides another.
    """
    depths = 1.0 + centred @ camera[2]
    if depths.min() < _MIN_RELATIVE_DEPTH:
        return 1.0
    pixels = centred @ camera[:2].T / depths[:, None]
    corner = np.angle(np.exp(2j * np.pi * pixels[:: -(-len(pixels) // _N_PROBES)]).mean(axis=0)) / (
        2.0 * np.pi
    )
    pixels = np.rint(pixels - corner)
    codes = np.sort(pixels[:, 0] * 2.0**24 + pixels[:, 1])
    return float(np.count_nonzero(codes[1:] == codes[:-1]) / len(codes))


def _is_plausible(camera: NDArray[np.float64]) -> bool:
    """Whether a camera has square pixels and the focal length and field of view of a depth camera."""
    depth_gradient = np.linalg.norm(camera[2])
    if depth_gradient == 0.0 or np.linalg.matrix_rank(camera / np.abs(camera).max(axis=1, keepdims=True)) < 3:
        return False
    axis = camera[2] / depth_gradient
    image_rows = camera[:2] - np.outer(camera[:2] @ axis, axis)
    u_length, v_length = np.linalg.norm(image_rows, axis=1)
    skew = abs(image_rows[0] @ image_rows[1]) / (u_length * v_length)
    centre = _centre(camera)
    return bool(
        abs(u_length / v_length - 1.0) < _MAX_DISTORTION
        and skew < _MAX_DISTORTION
        and _FOCAL_LENGTHS[0] < u_length / depth_gradient < _FOCAL_LENGTHS[1]
        and -axis @ centre > _MAX_OFF_AXIS * np.linalg.norm(centre)
    )


def _centre(camera: NDArray[np.float64]) -> NDArray[np.float64]:
    """Centre of a camera: the point at pixel 0/0."""
    return np.linalg.solve(camera, np.array([0.0, 0.0, -1.0]))
