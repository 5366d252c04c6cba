"""Meshes in files and folders, scanned from all around."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Unpack

from shapeconcepts.parameters import check_integer
from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.sources.collection import ScanFile, ScanList, Source, collect, find_scan_files, iter_scans
from shapeconcepts.sources.labelled_folder import labelled_by_folder
from shapeconcepts.sources.reader import ReadOptions, read_views

_NAME = re.compile(r"(?P<mesh>.*)/view \d+ of (?P<count>\d+)", re.DOTALL)


def load_views(
    source: Source, n_views: int, *, strict: bool = False, **options: Unpack[ReadOptions]
) -> ScanList:
    """Scan each mesh in files and folders from sides spread over the sphere around it.

    Parameters
    ----------
    source : path or iterable of paths
        As in `read_scans`: the name of a sub-folder is the label. Files that hold no mesh are read as scans.
    n_views : int
        Of each mesh, from 1.
    strict : bool
        As in `read_scans`.
    **options
        Those of `read_scan`, see `iter_scans`.

    Returns
    -------
    ScanList
        All views of a mesh have it as their `instance`, and so stay on one side of a split.

    Raises
    ------
    ScanError
        As `read_scans`.
    ValueError
        If `n_views` is not a positive integer.
    """
    check_integer("n_views", n_views, 1)
    files = labelled_by_folder(find_scan_files(source))
    results = (result for file in files for result in _views_or_error(file, n_views, options))
    return collect(results, strict=strict)


def views_of_file(file: ScanFile, n_views: int, **options: Unpack[ReadOptions]) -> list[Scan]:
    """Views of the mesh in a file, called after it; none where it holds no mesh.

    Of the options of `read_scan`, those of meshes count.

    Raises
    ------
    ScanError
        If the file cannot be read, or the mesh not be scanned.
    """
    if file.failure:
        return []
    return [
        replace(view, name=f"{file.name}/{view_name(view)}", label=file.label, instance=file.name)
        for view in read_views(file.path, n_views, units=options.get("units", "auto"), up=options.get("up"))
    ]


def view_name(scan: Scan) -> str:
    """What a view is called among those of its mesh."""
    return scan.name.rpartition("/")[2]


def mesh_and_count(name: str) -> tuple[str, int] | None:
    """The mesh that a scan called like this is a view of, and of how many; None where it is no view."""
    match = _NAME.fullmatch(name)
    return (match["mesh"], int(match["count"])) if match else None


def _views_or_error(file: ScanFile, n_views: int, options: ReadOptions) -> Iterator[Scan | ScanError]:
    try:
        views = views_of_file(file, n_views, **options)
    except ScanError as error:
        yield error
        return
    yield from views or iter_scans([file], **options)
