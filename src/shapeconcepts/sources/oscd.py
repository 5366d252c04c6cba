"""Object Shape Category Dataset: Kinect scans of seven categories of shapes (the paper's own data set).

http://www.robotics.jacobs-university.de/datasets/2017-object-shape-category-dataset-v01
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Unpack

from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.simulation.shapes import SHAPES
from shapeconcepts.sources.collection import (
    ScanFile,
    ScanList,
    collect,
    existing_folder,
    find_scan_files,
    iter_scans,
)
from shapeconcepts.sources.reader import ReadOptions

# The paper's figures call the can "barrel" and the box "parcel".
_SYNONYMS = {"barrel": "can", "parcel": "box", "teddybear": "teddy"}
_PLURALS = {"teddies": "teddy", "amphorae": "amphora"}
_NAMES = {name: name for name in SHAPES} | _SYNONYMS
_CATEGORIES = (
    _NAMES | _PLURALS | {f"{name}{end}": category for name, category in _NAMES.items() for end in ("s", "es")}
)

_SPLITS = {"train": "training", "test": "testing"}
_FOLDER_NAME = re.compile(r"(?:(train|test)(?:ing)?[\W_]*(?:set|data)?[\W_]*)?(.*)", re.DOTALL)


def load_oscd(folder: str | PathLike[str], **options: Unpack[ReadOptions]) -> ScanList:
    """Read the PCD files in folders that are named after the categories.

    Nothing but the paper tells how the data set's folders are called, so their names are read leniently:
    upper or lower case, singular or plural, "barrel" for can and "parcel" for box (as the paper's figures
    call them). A split may be given by folders such as ``training`` and ``testing`` (or ``train``, ``test``)
    above or below those of the categories, or in one word, as in ``trainbarrel``. Where no folder names a
    category, the name of the file may: ``training/can12.pcd``.

    Parameters
    ----------
    folder : path
        The unpacked data set.
    **options
        Those of `read_scan`.

    Returns
    -------
    ScanList
        In natural order of the files. `name` is the path inside the folder, of which `split_of` makes
        "training" or "testing"; `label` one of "sack", "can", "box", "teddy", "ball", "amphora", "plate".
        Files that cannot be read or that belong to no category are listed in `skipped`.

    Raises
    ------
    ScanError
        If there is no scan that can be read.
    """
    folder = existing_folder(folder)
    files = [file for file in find_scan_files(folder) if _is_pcd(file) or file.failure]
    if all(file.failure for file in files):
        raise ScanError(f"{folder}: holds no point cloud (.pcd)")
    return collect(_scans(files, options))


def split_of(scan: Scan) -> str | None:
    """The split that the folders in a scan's name give it to: "training", "testing", or None.

    Parameters
    ----------
    scan : Scan
        As `load_oscd` and `load_labelled` name it, like "training/can/can_12.pcd".
    """
    splits = (_meaning(part)[0] for part in Path(scan.name).parts[:-1])
    return next((split for split in splits if split is not None), None)


def is_oscd(files: Sequence[ScanFile]) -> bool:
    """Whether there are PCD files, all in one of the categories, and nothing else in folders beside them."""
    files = [file for file in files if not file.failure]
    clouds = [file for file in files if _is_pcd(file)]
    others_are_loose = all(_is_pcd(file) or len(file.inside.parts) == 1 for file in files)
    return bool(clouds) and others_are_loose and all(_category(file.inside) is not None for file in clouds)


def is_split_folder(name: str) -> bool:
    """Whether a folder's name tells a split and nothing else, such as "training" or "Test_set"."""
    split, rest = _meaning(name)
    return split is not None and not rest


def _scans(files: Iterable[ScanFile], options: ReadOptions) -> Iterator[Scan | ScanError]:
    for file in files:
        category = _category(file.inside)
        if category is None and not file.failure:
            yield ScanError(f"{file.path}: is in no folder named after one of {', '.join(SHAPES)}")
        else:
            yield from iter_scans([file._replace(label=category)], **options)


def _is_pcd(file: ScanFile) -> bool:
    return file.path.suffix.lower() == ".pcd"


def _category(inside: Path) -> str | None:
    """Category by a file's path in the data set's folder."""
    *folders, _ = inside.parts
    for name in folders:
        category = _CATEGORIES.get(_meaning(name)[1])
        if category is not None:
            return category
    if not all(is_split_folder(name) for name in folders):
        return None
    return _CATEGORIES.get(_meaning(inside.stem.rstrip("0123456789_- "))[1])


def _meaning(name: str) -> tuple[str | None, str]:
    """Split that a name begins with, if any, and the rest of it, in lower case."""
    match = _FOLDER_NAME.fullmatch(name.lower())
    assert match is not None  # the pattern fits every name
    split, rest = match[1], match[2]
    if split is None or (rest and rest not in _CATEGORIES):
        return None, name.lower()
    return _SPLITS[split], rest
