"""The topological space of stimuli."""

from shapeconcepts.topology.divergence import jensen_shannon_divergences

__all__ = ["jensen_shannon_divergences"]
