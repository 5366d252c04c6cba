"""Pictures and reports."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from shapeconcepts.report.picture import contact_sheet, draw_points, draw_segments

if TYPE_CHECKING:
    from shapeconcepts.report.dictionary_picture import draw_dictionary
    from shapeconcepts.report.explanation_picture import draw_explanation
    from shapeconcepts.report.hierarchy_picture import draw_hierarchy

__all__ = [
    "contact_sheet",
    "draw_dictionary",
    "draw_explanation",
    "draw_hierarchy",
    "draw_points",
    "draw_segments",
]

# These need scikit-learn, for which a picture of segments should not wait.
_HOME_OF = {
    "draw_dictionary": ".dictionary_picture",
    "draw_explanation": ".explanation_picture",
    "draw_hierarchy": ".hierarchy_picture",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME_OF[name], __name__), name)
