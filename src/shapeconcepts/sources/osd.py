"""Object Segmentation Database: labelled table-top scenes of a Kinect (Richtsfeld et al. 2012).

As re-annotated by S. Alexandrov (mOSD) in the data repository of the Point Cloud Library.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import Scan, ScanError, measured_rows
from shapeconcepts.sources.collection import ScanFile, ScanList, collect, existing_folder, find_scan_files
from shapeconcepts.sources.reader import read_scan

# Scenes of boxes and of cylindric objects (paper, table of the data sets).
CATEGORIES = {
    "box": {"learn": range(0, 17), "test": range(0, 16)},
    "can": {"learn": range(33, 45), "test": range(31, 43)},
}
FIRST_OBJECT_LABEL = 20

_SCENE_NAME = re.compile(r"(learn|test)(\d{1,9})")


def load_osd(folder: str | PathLike[str]) -> ScanList:
    """Cut the objects out of the labelled scenes in a folder.

    In the annotation, 0 is an invalid point, 1 to 9 the table, and from 20 on every decade one object. The
    last digit tells disjoint visible parts of it apart.

    Parameters
    ----------
    folder : path
        Folder with scenes such as ``learn33.pcd`` or ``learn/learn33.pcd``.

    Returns
    -------
    ScanList
        One scan per object, by scene and decade. `name` is scene and decade ("learn33/3" holds the labels 30
        to 39), `label` "box" or "can" by the number of the scene (paper) and None for the others,
        `point_labels` the annotation, `viewpoint` the camera, (0, 0, 0).

    Raises
    ------
    ScanError
        If there is no scene, or none can be read and has labels. One scene that cannot is left out, listed in
        `ScanList.skipped`, and a ScanWarning tells so.
    """
    folder = existing_folder(folder)
    results = list(_objects(find_scan_files(folder)))
    if not results:
        raise ScanError(f"{folder}: holds no scene (.pcd) with labelled objects")
    return collect(results)


def _objects(files: Iterable[ScanFile]) -> Iterator[Scan | ScanError]:
    for file in files:
        try:
            if file.failure:
                raise ScanError(f"{file.path}: {file.failure}")
            if file.path.suffix.lower() == ".pcd":
                yield from scene_objects(read_scan(file.path))
        except ScanError as error:
            yield error


def is_labelled_scene(labels: NDArray[np.int64] | None) -> bool:
    """Whether point labels number a table and the objects on it, as in the Object Segmentation Database.

    There is the table's first part, 1, or that of each object, its decade: other numbers mean something else.
    """
    if labels is None:
        return False
    found = np.unique(labels[labels > 0])
    decades = np.unique(found // 10)
    is_scene = len(decades) >= 2 and bool(decades[0] == 0 and decades[1] >= 2)
    return is_scene and bool(found[0] == 1 or np.isin(10 * decades[1:], found).all())


def scene_objects(scene: Scan) -> list[Scan]:
    """Objects of a labelled scene, see `load_osd`.

    They have the label of the scene, unless that is the name of a split; without one, that of `load_osd`.

    Raises
    ------
    ScanError
        If the scene has no labels.
    """
    if scene.point_labels is None:
        raise ScanError(f"{scene.name}: has no field label, which tells the objects of a scene apart")
    stem = Path(scene.name).stem
    viewpoint = np.zeros(3) if scene.viewpoint is None and is_scene_name(stem) else scene.viewpoint
    valid = measured_rows(scene.points) & (scene.point_labels >= FIRST_OBJECT_LABEL)
    if viewpoint is not None and not viewpoint.any():
        # Of the camera itself, what lies behind it was not measured.
        valid &= scene.points[:, 2] > 0.0
    points, labels = scene.points[valid], scene.point_labels[valid]
    decades = labels // 10
    return [
        Scan(
            points[decades == decade],
            viewpoint=viewpoint,
            name=f"{stem}/{decade}",
            label=scene.label or scene_category(stem),
            point_labels=labels[decades == decade],
            notices=scene.notices,
        )
        for decade in np.unique(decades)
    ]


def is_scene_name(stem: str) -> bool:
    """Whether a file's name without suffix is that of a scene, such as "learn33"."""
    return _SCENE_NAME.fullmatch(stem) is not None


def scene_category(stem: str) -> str | None:
    """Category of a scene's objects by its file's name: "learn33" gives "can"; None where it says nothing."""
    match = _SCENE_NAME.fullmatch(stem)
    if match is None:
        return None
    part, number = match[1], int(match[2])
    return next((name for name, scenes in CATEGORIES.items() if number in scenes[part]), None)
