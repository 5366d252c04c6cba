"""Writes the scans that a model was learned from, with their concepts, as a data set that trainers read."""

from shapeconcepts.export.export import LAYOUTS, Export, export_scans
from shapeconcepts.export.safe_names import safe_names

__all__ = ["LAYOUTS", "Export", "export_scans", "safe_names"]
