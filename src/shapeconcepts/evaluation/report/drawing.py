"""All figures of an evaluation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from shapeconcepts.evaluation.report.annexation_curve import draw_annexation_curve
from shapeconcepts.evaluation.report.barcode import draw_barcode
from shapeconcepts.evaluation.report.baseline_comparison import draw_baseline_comparison
from shapeconcepts.evaluation.report.concept_map import draw_concept_map
from shapeconcepts.evaluation.report.label_colours import label_colours
from shapeconcepts.evaluation.report.levels import draw_levels
from shapeconcepts.evaluation.report.purity_against_error import draw_purity_against_error
from shapeconcepts.evaluation.report.ranked_concepts import draw_ranked_concepts
from shapeconcepts.evaluation.report.region_matrices import draw_labels_to_regions, draw_labels_within_regions
from shapeconcepts.evaluation.report.selection_surfaces import draw_error_surface, draw_purity_surface

if TYPE_CHECKING:
    from shapeconcepts.evaluation.results import Evaluation


def draw_all(evaluation: Evaluation) -> dict[str, Figure]:
    """Every figure that there are results for.

    Parameters
    ----------
    evaluation : Evaluation

    Returns
    -------
    dict of str to matplotlib.figure.Figure
        By name, which is fit for a file: ``barcode``, ``annexations`` and ``concepts`` of the first preset,
        and of every other with ``_PRESET`` behind; ``levels``; ``purity``, ``error`` and ``purity_error``;
        ``map``, ``labels_in_regions`` and ``regions_of_labels``; ``baselines``.
    """
    labels = set(evaluation.labels)
    for selection in evaluation.selections:
        labels.update(label for bar in selection.bars for label in bar.proportions)
    if evaluation.map is not None:
        labels.update(evaluation.map.labels.tolist(), evaluation.map.label_names)
    colours = label_colours(labels)

    figures = {}
    for i, selection in enumerate(evaluation.selections):
        suffix = f"_{selection.preset}" if i else ""
        figures[f"barcode{suffix}"] = draw_barcode(selection.filtration)
        figures[f"annexations{suffix}"] = draw_annexation_curve(selection.filtration)
        figures[f"concepts{suffix}"] = draw_ranked_concepts(selection.bars, colours)
    if evaluation.levels is not None:
        figures["levels"] = draw_levels(evaluation.levels)
    if evaluation.supervised is not None:
        figures["purity"] = draw_purity_surface(evaluation.supervised)
        figures["error"] = draw_error_surface(evaluation.supervised)
        figures["purity_error"] = draw_purity_against_error(evaluation.supervised)
    if evaluation.map is not None:
        figures["map"] = draw_concept_map(evaluation.map, colours)
        figures["labels_in_regions"] = draw_labels_within_regions(evaluation.map)
        figures["regions_of_labels"] = draw_labels_to_regions(evaluation.map)
    if evaluation.baselines:
        figures["baselines"] = draw_baseline_comparison(evaluation.baselines, evaluation.selections)
    return figures
