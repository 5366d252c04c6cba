"""The scans of a model in the folders that the user gave, and nowhere else."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from shapeconcepts.export.training_scans import ScansInFiles, UnusableScan
from shapeconcepts.scan import ScanError, scan_errors
from shapeconcepts.segmentation import SegmentedObject, Segmenter
from shapeconcepts.sources.collection import ScanFile, find_scan_files
from shapeconcepts.sources.reader import ReadOptions


class FoundScans:
    """Scans by their rows, found by their names.

    Parameters
    ----------
    names : sequence of str
        Of the scans of a model.
    places : sequence of Path
        Files and folders. A file that leads out of its folder, by a link, is not read.
    reading : ReadOptions

    Attributes
    ----------
    files : list of ScanFile
        With a failure where they are not to be read.
    """

    def __init__(self, names: Sequence[str], places: Sequence[Path], reading: ReadOptions) -> None:
        self._has_places = bool(places)
        self.files = [file for place in places for file in _files_within(place)]
        self._scans = ScansInFiles(names, range(len(names)), self.files, reading)
        self._names, self._missing = names, set(self._scans.missing)

    def segmented(self, row: int, segmenter: Segmenter) -> SegmentedObject:
        """A scan with its segments.

        Raises
        ------
        ScanError
            If it is not there, or cannot be used.
        """
        if row in self._missing:
            where = "is not in the folders of scans" if self._has_places else "no folder of scans is given"
            raise ScanError(f"{self._names[row]}: {where}")
        found = self._scans.read_one(row)
        if isinstance(found, UnusableScan):
            raise ScanError(found.reason)
        with scan_errors(found.scan.name, "segmented"):
            return segmenter.segment(found.scan)

    def path_of(self, row: int) -> Path | None:
        """The file that holds a scan, where that is known."""
        return self._scans.path_of(row)


def _files_within(place: Path) -> list[ScanFile]:
    files = find_scan_files(place)
    if not place.is_dir():
        return files
    whole = os.path.realpath(place)
    real_folder = cache(os.path.realpath)

    def is_within(path: Path) -> bool:
        real = os.path.realpath(path) if path.is_symlink() else real_folder(path.parent)
        return os.path.commonpath([whole, real]) == whole

    refusal = "leads out of the folder of scans"
    return [file if is_within(file.path) else file._replace(failure=refusal) for file in files]
