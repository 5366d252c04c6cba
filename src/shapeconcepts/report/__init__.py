"""Pictures and reports: which ways of drawing the product has, and why.

* Splatting (`splatting`, for `draw_points` and `draw_segments`): the points of scans as closed surfaces, in
  contact sheets and thumbnails; numpy only, as OpenGL would need a driver or a display.
* A sheet on Pillow (`canvas`, for `draw_explanation`): lines, bars, text and thumbnails in rows, placed by
  the pixel, where there are no axes to plot; Pillow brings its own font.
* A page of HTML and plain JavaScript (`html`): the report of `learn`, in which scans are turned and time is
  moved; one file for any browser, without a network, WebGL or a build.
* matplotlib (`shapeconcepts.evaluation.report` alone): axes, legends and vector formats of the evaluation's
  figures; imported only when these are drawn.

The pictures of dictionary and hierarchy serve the documentation alone: docs/pictures draws them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shapeconcepts.report.explanation_picture import draw_explanation
    from shapeconcepts.report.picture import contact_sheet, draw_points, draw_segments

__all__ = ["contact_sheet", "draw_explanation", "draw_points", "draw_segments"]

# They need scikit-learn: a picture of segments should not wait for all of it, colours for none of it.
_HOME_OF = {
    "contact_sheet": "picture",
    "draw_explanation": "explanation_picture",
    "draw_points": "picture",
    "draw_segments": "picture",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME_OF[name]}", __name__), name)
