"""What a layout of a data set is: it takes scans one at a time, and writes them into a folder."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from shapeconcepts.export.catalogue import CatalogueEntry
from shapeconcepts.export.training_scans import FoundScan


class Place(NamedTuple):
    """Where a scan was written.

    Attributes
    ----------
    file : str
        Path inside the data set, with slashes.
    origin : (float, float, float)
        Metres: what was taken off its coordinates.
    """

    file: str
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Layout(Protocol):
    """A layout, which is made with the folder, as `FolderInMaking`, and the `Catalogue`."""

    def add(self, entry: CatalogueEntry, found: FoundScan) -> Place:
        """Write a scan.

        Raises
        ------
        ScanError
            If it cannot be written as the layout demands.
        OSError
            If the disk refuses it.
        """
        ...

    def finish(self, places: dict[int, Place]) -> None:
        """Write what tells of all scans.

        Parameters
        ----------
        places : dict of int to Place
            Of the scans that were written, by their rows in the model.
        """
        ...
