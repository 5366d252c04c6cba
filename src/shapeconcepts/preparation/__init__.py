"""Preparation: from a scan to voxels with normals."""

from shapeconcepts.preparation.preparation import prepare
from shapeconcepts.preparation.prepared_object import PreparedObject

__all__ = ["PreparedObject", "prepare"]
