"""How well groups and features agree with labels, beside what the usual methods reach on the same objects.

`evaluate` runs the paper's experiments and all baselines; the parts can be used alone.
"""

from shapeconcepts.evaluation.bag_of_words import TopicModel, point_histograms
from shapeconcepts.evaluation.baselines import baseline_rows, grouping_baselines, whole_object_rows
from shapeconcepts.evaluation.classification import svm_errors, svm_predictions
from shapeconcepts.evaluation.ensemble_of_shape_functions import ensemble_of_shape_functions
from shapeconcepts.evaluation.evaluate import evaluate
from shapeconcepts.evaluation.groupings import (
    Grouping,
    average_linkage,
    hdbscan,
    k_means,
    leiden,
    most_groups,
    our_filtration,
    our_filtration_by_silhouette,
    plscan,
    tomato,
)
from shapeconcepts.evaluation.metrics import (
    GroupingScores,
    grouping_scores,
    mean_error_over_labels,
    purity,
    rank_score,
)
from shapeconcepts.evaluation.object_detection import ObjectMatches, match_objects, touching_objects
from shapeconcepts.evaluation.paper import PAPER
from shapeconcepts.evaluation.point_nn import point_nn
from shapeconcepts.evaluation.results import Evaluation
from shapeconcepts.evaluation.splits import stratified_splits

__all__ = [
    "PAPER",
    "Evaluation",
    "Grouping",
    "GroupingScores",
    "ObjectMatches",
    "TopicModel",
    "average_linkage",
    "baseline_rows",
    "ensemble_of_shape_functions",
    "evaluate",
    "grouping_baselines",
    "grouping_scores",
    "hdbscan",
    "k_means",
    "leiden",
    "match_objects",
    "mean_error_over_labels",
    "most_groups",
    "our_filtration",
    "our_filtration_by_silhouette",
    "plscan",
    "point_histograms",
    "point_nn",
    "purity",
    "rank_score",
    "stratified_splits",
    "svm_errors",
    "svm_predictions",
    "tomato",
    "touching_objects",
    "whole_object_rows",
]
