"""The evaluation as figures for a publication and as one HTML file."""

from shapeconcepts.evaluation.libraries import check_libraries

try:
    from shapeconcepts.evaluation.report.drawing import draw_all
    from shapeconcepts.evaluation.report.figure_files import save_figures
    from shapeconcepts.evaluation.report.page import write_evaluation
except ModuleNotFoundError:
    check_libraries("matplotlib")
    raise

__all__ = ["draw_all", "save_figures", "write_evaluation"]
