"""Preparation: from a scan to voxels with normals."""

from shapeconcepts.preparation.pipeline import prepare
from shapeconcepts.preparation.prepared_object import PreparedObject

__all__ = ["PreparedObject", "prepare"]
