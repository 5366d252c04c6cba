"""An object in grey with some of its segments in colour."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from PIL import Image

from shapeconcepts.report.canvas import Colour
from shapeconcepts.report.palette import NO_SEGMENT_COLOUR
from shapeconcepts.report.picture import draw_points
from shapeconcepts.segmentation.segmented_object import SegmentedObject


def draw_highlighted(
    segmented: SegmentedObject, colour_of: Mapping[int, Colour], *, size: int, title: str = ""
) -> Image.Image:
    """Draw an object as the sensor saw it.

    Parameters
    ----------
    segmented : SegmentedObject
    colour_of : mapping of int to (red, green, blue)
        Colours of segments; the others are light grey.
    size : int
        Width of the picture, pixels, at least 64.
    title : str
        Caption.
    """
    colours = np.tile(NO_SEGMENT_COLOUR, (max(segmented.n_segments, 1), 1))
    for segment, colour in colour_of.items():
        colours[segment] = colour
    return draw_points(
        segmented.points,
        segmented.normals,
        segmented.segment_labels,
        voxel_size=segmented.voxel_size,
        viewpoint=segmented.viewpoint,
        title=title,
        size=size,
        colours=colours,
    )
