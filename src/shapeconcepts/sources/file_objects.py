"""The objects in a file: one, several where it is a labelled scene, or the views of a mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import Unpack

from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.sources.collection import ScanFile, iter_scans
from shapeconcepts.sources.mesh_views import views_of_file
from shapeconcepts.sources.oscd import is_split_folder
from shapeconcepts.sources.osd import is_labelled_scene, scene_objects
from shapeconcepts.sources.reader import ReadOptions

_TAKEN_APART = "is an object of a scene that point labels tell apart: --no-scenes keeps scenes whole"


def objects_of_file(
    file: ScanFile, scenes: bool | None = None, n_views: int | None = None, **options: Unpack[ReadOptions]
) -> list[Scan]:
    """Scans of the objects in a file.

    Parameters
    ----------
    file : ScanFile
    scenes : bool or None
        Whether a point cloud is a labelled scene; None: if its labels look like it, see `is_labelled_scene`.
        Its objects then say so among their notices.
    n_views : int or None
        From how many sides a mesh is scanned; None: from one.
    **options
        Those of `read_scan`.

    Raises
    ------
    ScanError
        If the file cannot be read, or is to be a scene and holds no labelled object.
    """
    views = views_of_file(file, n_views, **options) if n_views else []
    if views:
        return views
    [scan] = iter_scans([file], **options)
    if isinstance(scan, ScanError):
        raise scan
    if not (is_labelled_scene(scan.point_labels) if scenes is None else scenes):
        return [scan]
    objects = scene_objects(replace(scan, label=category_folder(file)))
    if not objects:
        raise ScanError(f"{file.path}: holds no labelled object, that is no label of 20 or more")
    return objects if scenes else [replace(one, notices=(*one.notices, _TAKEN_APART)) for one in objects]


def category_folder(file: ScanFile) -> str | None:
    """The label that a file has by its folder; None where that only tells a split, such as "test"."""
    return None if file.label is None or is_split_folder(file.label) else file.label
