"""Model files: safetensors with a JSON description in the header. Reading one never runs code."""

from shapeconcepts.model_file.error import ModelError
from shapeconcepts.model_file.loading import load_model
from shapeconcepts.model_file.saving import save_model

__all__ = ["ModelError", "load_model", "save_model"]
