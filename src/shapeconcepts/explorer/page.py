"""The explorer's page, which is the same for every model: what it shows, it asks for."""

from __future__ import annotations

from shapeconcepts.html_page import (
    DRAWING,
    FIGURES,
    PageParts,
    closed_script,
    shared_scripts,
    shared_style,
    template,
)

_STYLES = ("page", "gallery", "concepts", "scan", "dialogs", "dark")
_SCRIPTS = (
    "server",
    "focus",
    "store",
    "previews",
    "places",
    "questions",
    "gallery",
    "dialogs",
    "picker",
    "edits",
    "actions",
    "heading",
    "concept_list",
    "granularity_slider",
    "scan_panel",
    "journal",
    "figures_view",
    "bar",
    "page",
)


def explorer_page() -> tuple[bytes, str]:
    """The page, and the policy that belongs in its header."""
    own = [template(__package__, f"{name}.js") for name in _SCRIPTS]
    # The report draws its figures once; here they are drawn anew after each edit.
    figures = [
        "function drawnFigures(contents, showTip) {",
        *shared_scripts(FIGURES),
        "return { state, change, onChange, scansAt, figures: figures() };\n}",
    ]
    parts = PageParts(
        template(__package__, "page.html"),
        shared_style() + "\n".join(template(__package__, f"{name}.css") for name in _STYLES),
        closed_script([*shared_scripts(DRAWING), *figures, *own]),
    )
    outside = "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    return parts.page(), f"{parts.policy}; {outside}"
