"""Shape concept inference: how much an object resembles each concept."""

from shapeconcepts.concepts.response import ConceptResponse

__all__ = ["ConceptResponse"]
