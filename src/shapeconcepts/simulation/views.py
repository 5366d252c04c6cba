"""Scans of a mesh from all around, as the simulated sensor would take them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.parameters import check_integer
from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.simulation.sensor import KINECT, scan_mesh
from shapeconcepts.simulation.sensor_model import SensorModel

_GOLDEN_ANGLE = np.pi * (3.0 - 5.0**0.5)


def views(
    vertices: ArrayLike,
    faces: ArrayLike,
    n_views: int,
    *,
    noise: bool = True,
    sensor: SensorModel = KINECT,
    random_state: int = 0,
    name: str = "",
    label: str | None = None,
) -> list[Scan]:
    """Scan a triangle mesh from sides that are spread evenly over the sphere around it.

    Parameters
    ----------
    vertices, faces
        As in `scan_mesh`.
    n_views : int
        From 1.
    noise, sensor
        As in `scan_mesh`.
    random_state : int
        Seed of distances and noise.
    name : str
        The mesh. Its views are "name/view 3 of 24", and the mesh is the `instance` of each.
    label : str, optional
        Of every view.

    Returns
    -------
    list of Scan
        Without sides from which nothing is visible, such as the edge of a sheet.

    Raises
    ------
    ScanError
        If the mesh cannot be scanned, or nothing is visible from any side.
    ValueError
        If `n_views` is not a positive integer.
    """
    check_integer("n_views", n_views, 1)
    scans, failures = [], []
    for number, direction in enumerate(directions_around(n_views)):
        try:
            scan = scan_mesh(
                vertices,
                faces,
                view_direction=direction,
                noise=noise,
                sensor=sensor,
                random_state=np.random.default_rng((random_state, number)),
                name=name,
                label=label,
            )
        except ScanError as error:
            failures.append(error)
            continue
        title = f"{name}/view {number + 1} of {n_views}"
        scans.append(
            Scan(scan.points, viewpoint=scan.viewpoint, name=title, label=label, instance=name or "mesh")
        )
    if not scans:
        raise failures[0]
    return scans


def directions_around(n: int) -> NDArray[np.float64]:
    """Unit vectors that are spread evenly over the sphere, on a spiral with golden angles (Vogel 1979).

    Parameters
    ----------
    n : int
        From 1.

    Returns
    -------
    (n, 3) float64
        From the top, z = 1, to the bottom.
    """
    z = 1.0 - (2.0 * np.arange(n) + 1.0) / n
    azimuth = _GOLDEN_ANGLE * np.arange(n)
    across = np.sqrt(1.0 - z**2)
    return np.column_stack([across * np.cos(azimuth), across * np.sin(azimuth), z])
