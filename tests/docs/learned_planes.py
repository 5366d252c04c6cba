"""Planes with given segments and descriptions, to learn dictionaries and hierarchies from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image

from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.segmentation.segmented_object import SegmentedObject

VOXEL = 0.005


@dataclass(frozen=True)
class Given:
    """A descriptor whose histograms are given for each object by name."""

    histograms: dict[str, np.ndarray]

    def describe(self, segmented: SegmentedObject) -> Description:
        return Description(self.histograms[segmented.name])


def plane(n_segments: int, edges: Sequence[tuple[int, int]], name: str) -> SegmentedObject:
    """A plane that faces the camera, cut into vertical stripes."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(12) - 5.5, np.arange(12) - 5.5))
    labels = (np.arange(144) % 12 * n_segments // 12).astype(np.int32)
    return SegmentedObject(
        points=np.stack([x * VOXEL, y * VOXEL, np.ones(144)], axis=1),
        normals=np.tile([0.0, 0.0, -1.0], (144, 1)),
        patch_labels=labels,
        segment_labels=labels,
        segment_edges=np.array(sorted(edges), np.int32).reshape(-1, 2),
        n_segments=n_segments,
        point_to_voxel=np.arange(144, dtype=np.int32),
        voxel_size=VOXEL,
        viewpoint=np.zeros(3),
        name=name,
    )


def count(picture: Image.Image, colour: tuple[int, int, int]) -> int:
    """Number of pixels of exactly this colour."""
    return int((np.asarray(picture) == colour).all(axis=2).sum())
