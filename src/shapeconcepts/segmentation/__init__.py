"""Segmentation: atomic patches, super patches, and the graph of segments."""

from shapeconcepts.segmentation.pipeline import segment
from shapeconcepts.segmentation.segmented_object import SegmentedObject

__all__ = ["SegmentedObject", "segment"]
