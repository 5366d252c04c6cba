"""Segmentation: atomic patches, super patches, and the graph of segments."""

from shapeconcepts.segmentation.segmented_object import SegmentedObject
from shapeconcepts.segmentation.segmenter import Segmenter, segment

__all__ = ["SegmentedObject", "Segmenter", "segment"]
