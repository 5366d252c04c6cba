"""What one sees in each figure, and how it was made."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import Evaluation

_STOPS = (
    "The dashed blue line is ε_max, the step with the most annexations, at which the paper stops; the "
    "orange line "
    "is where this preset takes its concepts."
)
_BARCODE = (
    "Barcode of homology group 0. Each bar is a class of objects; it ends where a larger class annexes it. "
    "The arrow "
    "is the class that is left. " + _STOPS
)
_ANNEXATIONS = (
    "Annexations in each step of the filtration, and below how many concepts of the minimum size there are "
    "at each "
    "time. " + _STOPS
)
_CONCEPTS = (
    "The concepts, each a bar of the labels of its objects, from the lowest to the highest rank score: "
    "size divided "
    "by impurity (the paper's equation 5). A bar of one colour is a pure concept. Below, how many objects "
    "are in each. "
    "The labels were looked at only to draw this."
)
_FIRST_SPLIT = " From the training objects of the first split."


def captions(evaluation: Evaluation) -> dict[str, tuple[str, str]]:
    """Title and caption of every figure, by the names that `draw_all` gives them."""
    made = {}
    for i, selection in enumerate(evaluation.selections):
        suffix, preset = (f"_{selection.preset}" if i else ""), f"preset {selection.preset}"
        made[f"barcode{suffix}"] = (f"Barcode, {preset}", _BARCODE + _FIRST_SPLIT)
        made[f"annexations{suffix}"] = (f"Annexations, {preset}", _ANNEXATIONS + _FIRST_SPLIT)
        made[f"concepts{suffix}"] = (f"Ranked concepts, {preset}", _CONCEPTS + _FIRST_SPLIT)
    made["levels"] = (
        "Dictionary levels",
        "What a finer dictionary of segments gives: level n has up to 2ⁿ visual words. The mark is the "
        "median over "
        f"the splits ({evaluation.repetitions}), its bar goes from the smallest to the largest.",
    )
    made["purity"] = (
        "Purity by number and minimum size of concepts",
        "Mean purity of the concepts where the filtration is stopped at that many concepts of at least "
        "that size; mean over the folds of cross-validation of all splits. Bright is pure. Hatched: the "
        "filtration never has so many. The frame marks the choice that cross-validation makes.",
    )
    made["error"] = (
        "Error by number and minimum size of concepts",
        "Mean error over the labels of an SVM on the responses to these concepts, on the objects left out of "
        "each fold. Bright is a small error. Hatched and frame as in the figure of purity.",
    )
    made["purity_error"] = (
        "Purity against error",
        "Every dot is one number and minimum size of concepts from the two figures before. A rank "
        "correlation near "
        "−1 says that purer concepts classify better, as the paper found.",
    )
    if evaluation.map is not None:
        made["map"] = (
            "The space of concept responses",
            "Each object's responses to all concepts, laid out in two dimensions by t-SNE, which sees no "
            "labels. The "
            f"colour behind is the most frequent label among the {evaluation.map.k} objects nearest to "
            "that place, and "
            "the more opaque, the larger its share. The form of a mark is the data set.",
        )
        made["labels_in_regions"] = (
            "What lies in each region",
            "A region is all cells of the map of one colour. Each row says, in percent, which labels the "
            "objects in a "
            "region have. Empty is none.",
        )
        made["regions_of_labels"] = (
            "Where each label lies",
            "Each row says, in percent, in which regions of the map the objects of a label lie. Empty is "
            "none.",
        )
    made["baselines"] = (
        "Ours and the baselines",
        "Mutual information of groups and labels beyond chance, B-cubed F1, and share of the objects that "
        "are in a group whose majority label is theirs: for ours (orange diamonds), and for the 24 with most "
        "information of all other ways to group. The mark is the median over the splits, the line goes from "
        "the smallest to the "
        "largest. Nobody was given the labels.",
    )
    return made
