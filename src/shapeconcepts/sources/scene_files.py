"""Scenes in files: the same formats as those of scans."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.cloud import Cloud
from shapeconcepts.io.mesh import Mesh
from shapeconcepts.scan import ScanError
from shapeconcepts.scene import Scene
from shapeconcepts.sources.reader import ReadOptions, read_content, scan_of_cloud


def read_scene(path: str | PathLike[str], **options: Unpack[ReadOptions]) -> Scene:
    """Read a scene: several objects among other things, in a file of any format of `read_scan`.

    Clouds that are stored as the pixels of an image, and depth images, stay organised.

    Parameters
    ----------
    path : str or path
        The file.
    **options
        Those of `read_scan`.

    Returns
    -------
    Scene
        With the file's name, without its suffix, as its name.

    Raises
    ------
    ScanError
        If the file cannot be read, or holds a mesh.
    ValueError
        If a parameter is out of range.
    """
    path = Path(path)
    content = read_content(path, **options)
    if isinstance(content, Mesh):
        raise ScanError(f"{path}: is a mesh, and scenes are point clouds or depth images")
    scan = scan_of_cloud(path, content, **options)
    return Scene(
        _organised(scan.points, content, np.nan),
        scan.viewpoint,
        name=path.stem,
        point_labels=None if scan.point_labels is None else _organised(scan.point_labels, content, 0),
        notices=scan.notices,
    )


def _organised(values: NDArray, cloud: Cloud, nothing: float) -> NDArray:
    """Values of the points of a cloud in the pixels of its image; as they are where it is none."""
    if cloud.image_shape is None:
        return values
    height, width = cloud.image_shape
    if cloud.pixels is None:
        return values.reshape(height, width, *values.shape[1:])
    image = np.full((height * width, *values.shape[1:]), nothing, values.dtype)
    image[cloud.pixels] = values
    return image.reshape(height, width, *values.shape[1:])
