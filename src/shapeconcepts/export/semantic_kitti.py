"""The layout of SemanticKITTI (Behley et al. 2019): points, and a label for each, in numbered files.

As its development kit, https://github.com/PRBonn/semantic-kitti-api, reads it.
"""

from __future__ import annotations

import numpy as np

from shapeconcepts.export.catalogue import Catalogue, CatalogueEntry
from shapeconcepts.export.class_colours import colour_of
from shapeconcepts.export.layout import Place
from shapeconcepts.export.near_origin import near_origin
from shapeconcepts.export.training_scans import FoundScan
from shapeconcepts.io.whole_folder import FolderInMaking
from shapeconcepts.scan import ScanError

SEQUENCE = "sequences/00"
_MOST_LABELS = 2**16


class SemanticKittiLayout:
    """One sequence of which each scan is a frame; its concept is the semantic label of all its points."""

    def __init__(self, folder: FolderInMaking, catalogue: Catalogue) -> None:
        self._folder, self._catalogue = folder, catalogue
        self._n_points = {one.identifier: 0 for one in catalogue.classes}
        self._n_written = 0
        largest = max(self._n_points)
        if largest >= _MOST_LABELS:
            raise ScanError(
                f"semantic-kitti holds labels up to {_MOST_LABELS - 1}, got a concept of the label {largest}"
            )

    def add(self, entry: CatalogueEntry, found: FoundScan) -> Place:
        """Write the points of a scan, of unknown intensity, and their labels."""
        moved, origin = near_origin(found.scan)
        rows = np.zeros((len(moved), 4), "<f4")
        rows[:, :3] = moved.points
        label = self._catalogue.class_of(entry).identifier
        # An object has the instance 1; what has no class has none.
        labels = np.full(len(moved), label | (bool(label) << 16), "<u4")
        # Files have the numbers in the order in which scans are found, as no number is to be left out.
        number = f"{self._n_written:06d}"
        self._folder.write(f"{SEQUENCE}/velodyne/{number}.bin", rows.tobytes())
        self._folder.write(f"{SEQUENCE}/labels/{number}.label", labels.tobytes())
        self._n_points[label] += len(moved)
        self._n_written += 1
        return Place(f"{SEQUENCE}/velodyne/{number}.bin", origin)

    def finish(self, places: dict[int, Place]) -> None:
        """Write what the labels mean, as the kit's configuration has it."""
        classes = sorted(self._catalogue.classes, key=lambda one: one.identifier)
        numbers = [one.identifier for one in classes]
        n_points = sum(self._n_points.values())
        lines = ["labels:"]
        lines += [f"  {one.identifier}: {_quoted(one.title)}" for one in classes]
        lines.append("color_map: # blue, green, red")
        lines += [f"  {one.identifier}: {colour_of(one)[::-1].tolist()}" for one in classes]
        lines.append("content: # share of the points")
        lines += [f"  {number}: {self._n_points[number] / max(n_points, 1):.9f}" for number in numbers]
        lines.append("learning_map:")
        lines += [f"  {number}: {position}" for position, number in enumerate(numbers)]
        lines.append("learning_map_inv:")
        lines += [f"  {position}: {number}" for position, number in enumerate(numbers)]
        lines.append("learning_ignore:")
        lines += [f"  {position}: {str(position == 0).lower()}" for position in range(len(numbers))]
        lines += ["split:", "  train: [0]", "  valid: []", "  test: []"]
        self._folder.write("semantic-kitti.yaml", ("\n".join(lines) + "\n").encode("utf-8", "replace"))


def _quoted(text: str) -> str:
    """Text in quotation marks, as YAML takes it."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    letters = (one if one.isprintable() else f"\\U{ord(one):08x}" for one in escaped)
    return f'"{"".join(letters)}"'
