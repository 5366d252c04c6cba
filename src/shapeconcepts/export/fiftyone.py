"""The layout of FiftyOne: a `FiftyOneDataset` of three-dimensional scenes, with a concept and a box each."""

from __future__ import annotations

import json
from typing import Any

from shapeconcepts.export.catalogue import Catalogue, CatalogueEntry
from shapeconcepts.export.fiftyone_fields import SAMPLE_FIELDS
from shapeconcepts.export.layout import Place
from shapeconcepts.export.near_origin import near_origin
from shapeconcepts.export.numbered_names import numbered_names
from shapeconcepts.export.training_scans import FoundScan
from shapeconcepts.export.upright_box import UprightBox, upright_box
from shapeconcepts.io.whole_folder import FolderInMaking
from shapeconcepts.io.write_pcd import pcd_content
from shapeconcepts.printable import encodable

# Of the format: later ones read it, and bring it up to date.
_VERSION = "1.0.0"
# FiftyOne wants a time, and the same data set shall be the same to the last bit.
_LONG_AGO = {"$date": "2000-01-01T00:00:00Z"}


class FiftyOneLayout:
    """Samples with the fields `concept`, `box` and what the catalogue knows; in `data/` are their points."""

    def __init__(self, folder: FolderInMaking, catalogue: Catalogue) -> None:
        self._folder, self._catalogue = folder, catalogue
        self._stem_of = numbered_names(catalogue)
        self._box_of: dict[int, UprightBox] = {}

    def add(self, entry: CatalogueEntry, found: FoundScan) -> Place:
        """Write the points of a scan, and the scene that shows them."""
        moved, origin = near_origin(found.scan)
        stem = self._stem_of[entry.row]
        self._box_of[entry.row] = upright_box(moved.points)
        self._folder.write(f"data/{stem}.pcd", pcd_content(moved))
        self._folder.write(f"data/{stem}.fo3d", _document(_scene(f"{stem}.pcd")))
        return Place(f"data/{stem}.fo3d", origin)

    def finish(self, places: dict[int, Place]) -> None:
        """Write the samples, and what their fields are."""
        written = [entry for entry in self._catalogue.entries if entry.row in places]
        samples = [
            self._sample(number, entry, places[entry.row].file) for number, entry in enumerate(written)
        ]
        titles = [encodable(one.title) for one in self._catalogue.classes]
        dataset = {
            "name": "shapeconcepts",
            "slug": "shapeconcepts",
            "version": _VERSION,
            "created_at": _LONG_AGO,
            "last_loaded_at": _LONG_AGO,
            "persistent": False,
            "media_type": "3d",
            "group_media_types": {},
            "tags": [],
            "info": {},
            "app_config": {},
            "classes": {"concept": titles, "box": titles},
            "default_classes": titles,
            "mask_targets": {},
            "default_mask_targets": {},
            "skeletons": {},
            "sample_fields": SAMPLE_FIELDS,
            "frame_fields": [],
            "saved_views": [],
            "workspaces": [],
            "annotation_runs": {},
            "brain_methods": {},
            "evaluations": {},
            "runs": {},
        }
        self._folder.write("samples.json", _document({"samples": samples}))
        self._folder.write("metadata.json", _document(dataset))

    def _sample(self, number: int, entry: CatalogueEntry, file: str) -> dict[str, Any]:
        one, box = self._catalogue.class_of(entry), self._box_of[entry.row]
        title = encodable(one.title)
        return {
            "_id": _identifier(number, 0),
            "filepath": file,
            "tags": ["medoid"] if entry.is_medoid else [],
            "_media_type": "3d",
            # A place in random order, for views that are sampled; FiftyOne divides by it.
            "_rand": ((number + 1) * 0.6180339887498949) % 1,
            "concept": {"_id": _identifier(number, 1), "_cls": "Classification", "tags": [], "label": title},
            "box": {
                "_cls": "Detections",
                "detections": [
                    {
                        "_id": _identifier(number, 2),
                        "_cls": "Detection",
                        "attributes": {},
                        "tags": [],
                        "label": title,
                        "location": box.centre.tolist(),
                        "dimensions": box.dimensions.tolist(),
                        "rotation": [0.0, 0.0, box.yaw],
                    }
                ],
            },
            "scan": encodable(entry.name),
            "folder_label": None if entry.label is None else encodable(entry.label),
            "concept_number": one.number,
            "concept_key": one.key,
            "response": entry.response,
            "p_value": entry.p_value,
            "is_medoid": entry.is_medoid,
            "rank": entry.rank,
        }


def _scene(pcd: str) -> dict[str, Any]:
    """A scene of FiftyOne's format .fo3d with one point cloud, whose file lies beside it."""
    unmoved = {
        "visible": True,
        "position": [0.0, 0.0, 0.0],
        "quaternion": [0.0, 0.0, 0.0, 1.0],
        "scale": [1.0, 1.0, 1.0],
    }
    cloud = {
        "_type": "PointCloud",
        "name": "scan",
        **unmoved,
        "children": [],
        "centerGeometry": False,
        "pcdPath": pcd,
        "defaultMaterial": {
            "_type": "PointCloudMaterial",
            "opacity": 1.0,
            "shadingMode": "height",
            "customColor": "#ffffff",
            "pointSize": 2.0,
            "attenuateByDistance": False,
        },
        "flagForProjection": True,
    }
    camera = {
        "position": None,
        "lookAt": None,
        "aspect": None,
        "up": "Z",
        "fov": 50.0,
        # Objects are small: with the usual tenth of a metre, one could not come close.
        "near": 0.001,
        "far": 2000.0,
    }
    scene = {"_type": "Scene", "name": "Scene", **unmoved, "children": [cloud]}
    return {**scene, "__FO3D_VERSION": "1.0", "camera": camera, "lights": None, "background": None}


def _identifier(number: int, part: int) -> dict[str, str]:
    """Of a sample (part 0), or of its labels."""
    return {"$oid": f"{4 * number + part + 1:024x}"}


def _document(content: object) -> bytes:
    return (json.dumps(content, allow_nan=False) + "\n").encode("ascii")
