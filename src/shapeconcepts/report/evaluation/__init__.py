"""The evaluation as figures for a publication and as one HTML file."""

from shapeconcepts.report.evaluation.drawing import draw_all
from shapeconcepts.report.evaluation.figure_files import save_figures
from shapeconcepts.report.evaluation.page import write_evaluation

__all__ = ["draw_all", "save_figures", "write_evaluation"]
