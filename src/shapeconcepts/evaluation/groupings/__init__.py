"""The usual ways to group histograms, and ours: the choice of their parameters looks at no label."""

from shapeconcepts.evaluation.groupings.average_linkage import average_linkage
from shapeconcepts.evaluation.groupings.grouping import Grouping, most_groups
from shapeconcepts.evaluation.groupings.hdbscan import hdbscan
from shapeconcepts.evaluation.groupings.k_means import k_means
from shapeconcepts.evaluation.groupings.leiden import leiden
from shapeconcepts.evaluation.groupings.our_filtration import our_filtration, our_filtration_by_silhouette
from shapeconcepts.evaluation.groupings.plscan import plscan
from shapeconcepts.evaluation.groupings.tomato import tomato

__all__ = [
    "Grouping",
    "average_linkage",
    "hdbscan",
    "k_means",
    "leiden",
    "most_groups",
    "our_filtration",
    "our_filtration_by_silhouette",
    "plscan",
    "tomato",
]
