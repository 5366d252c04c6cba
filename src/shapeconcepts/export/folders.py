"""The layout `folders`: a folder for each concept, with the files of its scans."""

from __future__ import annotations

from pathlib import PurePosixPath

from shapeconcepts.export.catalogue import NONE, Catalogue, CatalogueEntry
from shapeconcepts.export.layout import Place
from shapeconcepts.export.near_origin import near_origin
from shapeconcepts.export.safe_names import safe_name, safe_names
from shapeconcepts.export.training_scans import FoundScan
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.io.whole_folder import FolderInMaking
from shapeconcepts.io.write_pcd import pcd_content

INDEX = "index.csv"


class FoldersLayout:
    """Original files, in the folders of their concepts, the most typical ones first.

    Scans that have no file of their own (objects of a scene, views of a mesh, scans in memory) are written as
    PCD, in metres.
    """

    def __init__(self, folder: FolderInMaking, catalogue: Catalogue) -> None:
        self._folder = folder
        concepts = [one for one in catalogue.classes if one.number >= 0]
        # A folder that is called concept3 shall be that of number 3, whatever others are called.
        concepts.sort(key=lambda one: bool(one.name))
        names = safe_names([one.name or f"concept{one.number}" for one in concepts], taken=[NONE, INDEX])
        self._name_of = {one.number: name for one, name in zip(concepts, names, strict=True)}
        self._name_of[-1] = NONE
        self._prefix_of: dict[int, str] = {}
        for one in catalogue.classes:
            members = [entry.row for entry in catalogue.entries if entry.concept == one.number]
            width = max(len(str(len(members) - 1)), 3)
            self._prefix_of |= {index: f"{place:0{width}}" for place, index in enumerate(members)}

    def add(self, entry: CatalogueEntry, found: FoundScan) -> Place:
        """Copy the file of a scan, or write one."""
        folder, prefix = self._name_of[entry.concept], self._prefix_of[entry.row]
        if found.file is not None:
            suffix = found.file.suffix.lower()
            stem = safe_name(found.file.stem)
            place = Place(f"{folder}/{prefix}_{stem}{suffix}")
            content = read_regular_file(found.file)
        else:
            # Of the name, what tells a view or an object from others, and what it is one of.
            stem = safe_name("_".join(PurePosixPath(entry.name).parts[-2:]))
            moved, origin = near_origin(found.scan)
            place, content = Place(f"{folder}/{prefix}_{stem}.pcd", origin), pcd_content(moved)
        self._folder.write(place.file, content)
        return place

    def finish(self, places: dict[int, Place]) -> None:
        """Nothing is left to do: the index tells of all."""
