"""The usual ways to group histograms, each with a choice of its parameters that looks at no label."""

from shapeconcepts.evaluation.groupings.average_linkage import average_linkage
from shapeconcepts.evaluation.groupings.grouping import Grouping, most_groups
from shapeconcepts.evaluation.groupings.hdbscan import hdbscan
from shapeconcepts.evaluation.groupings.k_means import k_means
from shapeconcepts.evaluation.groupings.tomato import tomato

__all__ = ["Grouping", "average_linkage", "hdbscan", "k_means", "most_groups", "tomato"]
