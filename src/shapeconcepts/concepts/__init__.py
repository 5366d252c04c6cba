"""Shape concepts: which groups of a filtration they are, and how much an object resembles each."""

from shapeconcepts.concepts.concept import Concept
from shapeconcepts.concepts.concept_tree import ConceptTree
from shapeconcepts.concepts.filtration import Filtration
from shapeconcepts.concepts.response import ConceptResponse

__all__ = ["Concept", "ConceptResponse", "ConceptTree", "Filtration"]
