"""The layout of labelCloud (Sager et al. 2022): point clouds, and a cuboid around each object.

Labels are of its format ``centroid_rel``.
"""

from __future__ import annotations

import json

from shapeconcepts.export.catalogue import Catalogue, CatalogueEntry
from shapeconcepts.export.class_colours import colour_of
from shapeconcepts.export.layout import Place
from shapeconcepts.export.near_origin import near_origin
from shapeconcepts.export.numbered_names import numbered_names
from shapeconcepts.export.training_scans import FoundScan
from shapeconcepts.export.upright_box import upright_box
from shapeconcepts.io.whole_folder import FolderInMaking
from shapeconcepts.io.write_pcd import pcd_content
from shapeconcepts.printable import encodable

# As many as labelCloud writes itself.
_DIGITS = 8


class LabelCloudLayout:
    """A project of labelCloud: opened in its folder, the program shows each scan with its box."""

    def __init__(self, folder: FolderInMaking, catalogue: Catalogue) -> None:
        self._folder, self._catalogue = folder, catalogue
        self._stem_of = numbered_names(catalogue)

    def add(self, entry: CatalogueEntry, found: FoundScan) -> Place:
        """Write the points of a scan, and the upright box around them."""
        moved, origin = near_origin(found.scan)
        stem, box = self._stem_of[entry.row], upright_box(moved.points)
        centre, dimensions = box.centre.round(_DIGITS).tolist(), box.dimensions.round(_DIGITS).tolist()
        place = f"pointclouds/{stem}.pcd"
        label = {
            "folder": "pointclouds",
            "filename": f"{stem}.pcd",
            "path": place,
            "objects": [
                {
                    "name": encodable(self._catalogue.class_of(entry).title),
                    "centroid": dict(zip("xyz", centre, strict=True)),
                    "dimensions": dict(zip(("length", "width", "height"), dimensions, strict=True)),
                    "rotations": {"x": 0.0, "y": 0.0, "z": round(box.yaw, _DIGITS)},
                }
            ],
        }
        self._folder.write(place, pcd_content(moved))
        self._folder.write(f"labels/{stem}.json", _document(label))
        return Place(place, origin)

    def finish(self, places: dict[int, Place]) -> None:
        """Write the classes."""
        classes = sorted(self._catalogue.classes, key=lambda one: one.identifier)
        document = {
            "classes": [
                {
                    "name": encodable(one.title),
                    "id": one.identifier,
                    "color": "#" + bytes(colour_of(one).tolist()).hex(),
                }
                for one in classes
            ],
            "default": 0,
            "type": "object_detection",
            "format": "centroid_rel",
            "created_with": {"name": "labelCloud", "version": "1.1.0"},
        }
        self._folder.write("labels/_classes.json", _document(document))


def _document(content: object) -> bytes:
    return (json.dumps(content, indent=4, allow_nan=False) + "\n").encode("ascii")
