"""Puts a report's contents, style and scripts into one HTML file."""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from os import PathLike
from pathlib import Path
from string import Template
from typing import Any

from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.model import ShapeConceptModel
from shapeconcepts.printable import markup_bytes
from shapeconcepts.report.html.contents import report_contents
from shapeconcepts.report.html.scan_preview import ScanPreview

# One script: each file may use what those before it define.
_SCRIPTS = (
    "state",
    "scan_view",
    "viewer",
    "dot_map",
    "maps",
    "timeline",
    "granularity",
    "glance",
    "galleries",
    "history",
    "page",
)


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
    templates = files("shapeconcepts.report.html") / "templates"
    style = (templates / "page.css").read_text("utf-8")
    parts = [(templates / f"{name}.js").read_text("utf-8") for name in _SCRIPTS]
    script = '"use strict";\n(() => {\n' + "\n".join(parts) + "\n})();\n"
    page = Template((templates / "page.html").read_text("utf-8")).substitute(
        title=html.escape(title),
        style=style,
        script=script,
        # Nothing that a file's name might smuggle in is ever run, and nothing is ever fetched.
        policy=f"default-src 'none'; img-src data:; style-src {_hash(style)}; script-src {_hash(script)}",
        contents=embedded_json(contents),
    )
    return markup_bytes(page)


def embedded_json(value: object) -> str:
    """JSON in ASCII that cannot end the script element that it stands in."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _hash(content: str) -> str:
    digest = base64.b64encode(hashlib.sha256(content.encode("utf-8")).digest()).decode("ascii")
    return f"'sha256-{digest}'"
