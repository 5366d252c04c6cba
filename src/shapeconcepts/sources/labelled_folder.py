"""Finds out which labelled data lie in a folder, and reads them."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Unpack

from shapeconcepts.scan import ScanError
from shapeconcepts.sources.collection import (
    ScanFile,
    ScanList,
    collect,
    existing_folder,
    find_scan_files,
    iter_scans,
)
from shapeconcepts.sources.oscd import is_oscd, is_split_folder, load_oscd
from shapeconcepts.sources.osd import is_labelled_scene, is_scene_name, load_osd
from shapeconcepts.sources.reader import ReadOptions, read_scan_silently
from shapeconcepts.sources.washington import is_washington, load_washington


def load_labelled(folder: str | PathLike[str], **options: Unpack[ReadOptions]) -> ScanList:
    """Read the labelled scans in a folder, whichever data set it holds.

    * Files named and placed like ``apple_1/apple_1_1_1.pcd``: `load_washington`.
    * PCD files that are labelled scenes, directly in the folder or named like ``learn/learn0.pcd``:
      `load_osd`.
    * PCD files in folders named after the paper's categories: `load_oscd`.
    * Any other folder of category folders: all files that `read_scan` reads, labelled by their outermost
      folder; if all of them lie in folders such as ``training`` and ``testing``, by the outermost other one.

    Parameters
    ----------
    folder : path
    **options
        Those of `read_scan`. Scenes of `load_osd` and objects of `load_washington` are read as published.

    Returns
    -------
    ScanList
        Scans with a label. Those without one are listed in `skipped`, like those that cannot be read.

    Raises
    ------
    ScanError
        If there is no labelled scan that can be read.
    """
    folder = existing_folder(folder)
    scans = _load(folder, options)
    labelled = ScanList((scan for scan in scans if scan.label is not None), scans.skipped)
    labelled.skipped += [ScanError(f"{scan.name}: has no label") for scan in scans if scan.label is None]
    if not labelled:
        raise _nothing_labelled(folder)
    return labelled


def _load(folder: Path, options: ReadOptions) -> ScanList:
    if is_washington(folder):
        return load_washington(folder)
    files = find_scan_files(folder)
    if _are_scenes(files):
        return load_osd(folder)
    if is_oscd(files):
        return load_oscd(folder, **options)
    files = labelled_by_folder(files)
    if all(file.label is None or file.failure for file in files):
        raise _nothing_labelled(folder)
    return collect(iter_scans(files, **options))


def _are_scenes(files: Sequence[ScanFile]) -> bool:
    """Whether the first file that can be a scene of the data set, and can be read, is a labelled scene."""
    for file in files:
        if file.failure:
            continue
        in_place = len(file.inside.parts) == 1 or is_scene_name(file.path.stem)
        if in_place and file.path.suffix.lower() == ".pcd":
            try:
                return is_labelled_scene(read_scan_silently(file.path).point_labels)
            except ScanError:
                continue
    return False


def labelled_by_folder(files: Sequence[ScanFile]) -> list[ScanFile]:
    """Files labelled by their outermost folder; of those in folders of splits, by the outermost other one."""
    # A single folder of that name may as well be a category of toy trains.
    read = [file for file in files if not file.failure]
    split = all(any(map(is_split_folder, file.inside.parts[:-1])) for file in read)
    labelled = []
    for file in files:
        folders = [name for name in file.inside.parts[:-1] if not (split and is_split_folder(name))]
        labelled.append(file._replace(label=folders[0] if folders else None))
    return labelled


def _nothing_labelled(folder: Path) -> ScanError:
    return ScanError(
        f"{folder}: holds no labelled scans, that is neither a folder for each category, nor scenes of the "
        "Object Segmentation Database, nor objects of the Washington RGB-D Object Dataset"
    )
