"""Puts a report's contents, style and scripts into one HTML file."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from shapeconcepts.html_page import (
    DRAWING,
    FIGURES,
    PageParts,
    closed_script,
    embedded_json,
    shared_scripts,
    shared_style,
    template,
)
from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.report.html.contents import report_contents
from shapeconcepts.report.html.scan_preview import ScanPreview

_PACKAGE = "shapeconcepts.report.html"
_SCRIPTS = ("report_scans", "viewer", "glance", "galleries", "history", "page")


def write_report(
    path: str | PathLike[str],
    model: ShapeConceptModel,
    previews: Sequence[ScanPreview | None],
    *,
    unread: Sequence[tuple[str, str]] = (),
    title: str = "Shape concepts",
    reading: Mapping[str, str] | None = None,
) -> None:
    """Write a page that tells what a model learned, and how.

    The page is one file that needs no network, no graphics card and nothing but a browser. Of more than
    20,000 scans it shows a sample, of each concept in proportion, and says so; what it counts are all scans.

    Parameters
    ----------
    path : str or path
        The HTML file; its folder must exist. It appears complete or not at all.
    model : ShapeConceptModel
        A fitted model.
    previews : sequence of (ScanPreview or None)
        One for each training scan of the model; None where there is nothing to show.
    unread : sequence of (str, str)
        Files that could not be read, each with the reason.
    title : str
        Heading of the page.
    reading : mapping of str to str, optional
        Options that say how the scans were read, where they are not the defaults, and what each was.

    Raises
    ------
    ValueError
        If there are not as many previews as training scans.
    OSError
        If the file cannot be written.
    """
    model.consolidate()
    if len(previews) != len(model.scan_names_):
        raise ValueError(
            f"previews must hold one for each of the {len(model.scan_names_)} training scans, "
            f"got {len(previews)}"
        )
    contents = report_contents(model, previews, unread, title, reading or {})
    write_atomically(Path(path), _document(contents, title))


def _document(contents: dict[str, Any], title: str) -> bytes:
    own = [template(_PACKAGE, f"{name}.js") for name in _SCRIPTS]
    parts = PageParts(
        template(_PACKAGE, "page.html"),
        shared_style() + template(_PACKAGE, "page.css"),
        closed_script(
            [template(_PACKAGE, "embedded_contents.js"), *shared_scripts((*DRAWING, *FIGURES)), *own]
        ),
    )
    return parts.page(title=html.escape(title), policy=parts.policy, contents=embedded_json(contents))
