"""Objects in scenes: table tops, boards and floors with things on them."""

from shapeconcepts.extraction.extracted_object import ExtractedObject
from shapeconcepts.extraction.extraction import extract_objects

__all__ = ["ExtractedObject", "extract_objects"]
