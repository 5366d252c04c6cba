"""The topological space of stimuli and its filtration."""

from shapeconcepts.topology.concept import Concept
from shapeconcepts.topology.divergence import jensen_shannon_divergences
from shapeconcepts.topology.filtration import Filtration
from shapeconcepts.topology.space import TopologicalSpace

__all__ = ["Concept", "Filtration", "TopologicalSpace", "jensen_shannon_divergences"]
