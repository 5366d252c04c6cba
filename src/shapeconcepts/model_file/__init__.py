"""Model files: safetensors with a JSON description in the header. Reading one never runs code."""

from shapeconcepts.model_file.error import ModelError
from shapeconcepts.model_file.loading import read_state
from shapeconcepts.model_file.saving import write_state
from shapeconcepts.model_file.state import ModelState

__all__ = ["ModelError", "ModelState", "read_state", "write_state"]
