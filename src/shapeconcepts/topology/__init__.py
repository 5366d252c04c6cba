"""Topology of the rows of any non-negative matrix: divergence, spanning tree, neighbourhoods, heat."""

from shapeconcepts.topology.divergence import jensen_shannon_divergences
from shapeconcepts.topology.space import TopologicalSpace

__all__ = ["TopologicalSpace", "jensen_shannon_divergences"]
