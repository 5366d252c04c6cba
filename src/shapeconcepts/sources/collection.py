"""Reads many scans: files, folders, and folders of category folders."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import NamedTuple, Unpack

from shapeconcepts.io.depth_image import DEPTH_SUFFIXES, MASK_SUFFIXES, Mask
from shapeconcepts.scan import Scan, ScanError, ScanWarning
from shapeconcepts.sources.notices import in_few_words
from shapeconcepts.sources.other_formats import refusal_of_format
from shapeconcepts.sources.other_tables import what_else_it_is
from shapeconcepts.sources.reader import SCAN_SUFFIXES, ReadOptions, read_scan_silently

Source = str | PathLike[str] | Iterable[str | PathLike[str]]


class ScanFile(NamedTuple):
    """A file to read, the name and label that its scan gets, and its path inside the folder given.

    Or what cannot be read, such as a folder that cannot be listed: `failure` says why, and reading it gives
    that as its error. What was found in a folder may be something else than a scan.
    """

    path: Path
    name: str
    label: str | None
    inside: Path
    failure: str = ""
    is_found: bool = False


class ScanList(list[Scan]):
    """A list of scans that also knows which files could not be read.

    Attributes
    ----------
    skipped : list of ScanError
        One for each file that is missing from the list; the message names the file and the reason.
    """

    def __init__(self, scans: Iterable[Scan] = (), skipped: Iterable[ScanError] = ()) -> None:
        super().__init__(scans)
        self.skipped = list(skipped)


def find_scan_files(source: Source) -> list[ScanFile]:
    """List what `read_scans` reads, in its order, without opening a file.

    Parameters
    ----------
    source : path or iterable of paths
        Files and folders. A folder gives all files below it with a known suffix, hidden ones left out, in
        natural order (2 before 10). Files in its sub-folders get the sub-folder's name as their label.

    Returns
    -------
    list of ScanFile
        A file from a folder is named by its path inside that folder, any other by the given path. A folder
        that cannot be listed is among them, so that it is reported like a file that cannot be read.

    Raises
    ------
    ScanError
        If a folder holds no scan, or no source is given.
    """
    paths = [source] if isinstance(source, str | PathLike) else list(source)
    if not paths:
        raise ScanError("no file or folder to read scans from is given")
    files: list[ScanFile] = []
    for path in map(Path, paths):
        files += (
            _files_below(path) if os.path.isdir(path) else [ScanFile(path, str(path), None, Path(path.name))]
        )
    return files


def iter_scans(files: Iterable[ScanFile], **options: Unpack[ReadOptions]) -> Iterator[Scan | ScanError]:
    """Read files one after the other; a file that cannot be read gives its error instead of a scan.

    Parameters
    ----------
    files : iterable of ScanFile
        As `find_scan_files` lists them.
    **options
        Those of `read_scan`. Of depth images, several may share one mask, or `mask` is a folder that holds a
        mask of the same name (and sub-folder) for each. Other scans have none.

    Yields
    ------
    Scan or ScanError
        One for each file, in the same order. Nothing warns; scans have their notices. Of files that were
        found in a folder, tables that are no scans, such as calibrations and trajectories, are errors, too.
    """
    for file in files:
        try:
            if file.failure:
                raise ScanError(f"{file.path}: {file.failure}")
            own_options: ReadOptions = {**options, "mask": mask_of(file, options)}
            scan = read_scan_silently(file.path, **own_options)
            if file.is_found and (other := what_else_it_is(file.path)):
                raise ScanError(f"{file.path}: {other}")
            yield replace(scan, name=file.name, label=file.label)
        except ScanError as error:
            yield error


def read_scans(source: Source, *, strict: bool = False, **options: Unpack[ReadOptions]) -> ScanList:
    """Read all scans in files, in a folder, or in a folder of category folders.

    Parameters
    ----------
    source : path or iterable of paths
        Files and folders, see `find_scan_files`. Names of sub-folders become the labels.
    strict : bool
        Raise at the first file that cannot be read. By default such files are left out, listed in
        `ScanList.skipped`, and one ScanWarning tells so. Others tell of what should be looked at in scans,
        see `Scan.notices`.
    **options
        Those of `read_scan`, see `iter_scans`.

    Returns
    -------
    ScanList
        The scans, in natural order of their files.

    Raises
    ------
    ScanError
        If there is nothing to read, no file can be read, or with `strict` one cannot.
    """
    return collect(iter_scans(find_scan_files(source), **options), strict=strict)


def collect(results: Iterable[Scan | ScanError], *, strict: bool = False) -> ScanList:
    """List the scans among results, and the errors as skipped; ScanWarnings tell of them, and of notices.

    Parameters
    ----------
    results : iterable of Scan or ScanError
        One for each file, at least one.
    strict : bool
        Raise at the first error.

    Raises
    ------
    ScanError
        If no result is a scan, or with `strict` one is not.
    """
    scans = ScanList()
    for result in results:
        if isinstance(result, Scan):
            scans.append(result)
        elif strict:
            raise result
        else:
            scans.skipped.append(result)
    n_skipped = len(scans.skipped)
    if not scans:
        others = f" (and {n_skipped - 1} other files cannot be read either)" if n_skipped > 1 else ""
        raise ScanError(f"{scans.skipped[0]}{others}")
    if scans.skipped:
        reasons = [str(error) for error in scans.skipped[:3]]
        more = ["..."] if n_skipped > 3 else []
        warnings.warn(
            f"{n_skipped} of {n_skipped + len(scans)} scans are left out: " + "; ".join(reasons + more),
            ScanWarning,
            stacklevel=3,
        )
    notices = [(scan.name, notice) for scan in scans for notice in scan.notices]
    for sentence in in_few_words(notices, len(scans)):
        warnings.warn(sentence, ScanWarning, stacklevel=3)
    return scans


def existing_folder(folder: str | PathLike[str]) -> Path:
    """The path of a folder; ScanError where there is none."""
    folder = Path(folder)
    if not os.path.isdir(folder):
        raise ScanError(f"{folder}: there is no such folder")
    return folder


def mask_of(file: ScanFile, options: ReadOptions) -> Mask | None:
    """The mask of one of several files: in a folder of masks, that of the same place and name.

    It may have another suffix, as masks are images whatever the depths are in. Of a file that was named, and
    not found in a folder, the folders in its path count from the last one on.
    """
    suffix, mask = file.path.suffix.lower(), options.get("mask")
    is_depth = suffix in DEPTH_SUFFIXES or (suffix == ".npy" and options.get("intrinsics") is not None)
    if not is_depth:
        return None
    if not (isinstance(mask, str | PathLike) and os.path.isdir(mask)):
        return mask
    places = [file.inside]
    if not file.is_found:
        parts = file.path.parts
        places += [Path(*parts[-k:]) for k in range(2, len(parts)) if not Path(*parts[-k:]).is_absolute()]
    for place in places:
        for ending in (suffix, *MASK_SUFFIXES):
            if os.path.exists(found := (Path(mask) / place).with_suffix(ending)):
                return found
    return Path(mask) / file.inside


def _files_below(folder: Path) -> list[ScanFile]:
    unlisted: list[tuple[Path, str]] = []
    found = [(path, refusal_of_format(path.suffix.lower())) for path in scan_paths(folder, unlisted, True)]
    files = []
    for path, failure in sorted(
        [*found, *unlisted], key=lambda one: _natural_order(one[0].relative_to(folder))
    ):
        inside = path.relative_to(folder)
        label = inside.parts[0] if len(inside.parts) > 1 else None
        files.append(ScanFile(path, inside.as_posix(), label, inside, failure, is_found=True))
    if not files:
        raise ScanError(f"{folder}: holds no scans, that is no files {' '.join(SCAN_SUFFIXES)}")
    return files


def scan_paths(
    folder: Path, unlisted: list[tuple[Path, str]], with_other_formats: bool = False
) -> Iterator[Path]:
    """Files below a folder with a known suffix, hidden ones left out, in no particular order.

    Folders that cannot be listed are added to `unlisted`, with the reason. Other formats are those that may
    hold scans, but are not read.
    """

    def skip(error: OSError) -> None:
        unlisted.append((Path(error.filename), f"cannot be listed ({error.strerror})"))

    # Linked folders count, but not when they lead back to where one comes from.
    seen: set[str] = set()
    for place, folders, names in os.walk(folder, onerror=skip, followlinks=True):
        seen.add(os.path.realpath(place))
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and os.path.realpath(os.path.join(place, name)) not in seen
        )
        for name in names:
            suffix = Path(name).suffix.lower()
            is_other = with_other_formats and refusal_of_format(suffix)
            if not name.startswith(".") and (suffix in SCAN_SUFFIXES or is_other):
                yield Path(place, name)


def _natural_order(path: Path) -> list[tuple[list[tuple[int, str]], str]]:
    """Sort key in which numbers within names compare as numbers, and equal ones by their text."""
    return [
        ([(int(piece), "") if piece.isdecimal() else (-1, piece) for piece in re.split(r"(\d+)", part)], part)
        for part in path.parts
    ]
