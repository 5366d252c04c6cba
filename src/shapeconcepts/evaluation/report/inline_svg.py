"""Figures as parts of a page."""

from __future__ import annotations

import html
import re

from matplotlib.figure import Figure

from shapeconcepts.evaluation.report.figure_files import figure_bytes

_IDENTIFIER = re.compile(r'(?<![\w-])(id="|href="#|url\(#)')
_STYLE_ELEMENT = re.compile(r"<style type=\"text/css\">.*?</style>", re.DOTALL)


def inline_svg(figure: Figure, name: str, description: str) -> str:
    """The figure as an SVG element of a page, sized by the page.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    name : str
        Different for every figure of the page: it goes before each of its identifiers, since a page must not
        have one twice.
    description : str
        For readers who do not see the figure.
    """
    text = figure_bytes(figure, "svg").decode("utf-8")
    text = text[text.index("<svg") :]
    # The one rule in it would hold for the whole page; the page has it for its figures.
    text = _STYLE_ELEMENT.sub("", text, count=1)
    text = _IDENTIFIER.sub(lambda found: f"{found[1]}{name}-", text)
    opening = f'<svg role="img" aria-label="{html.escape(description)}"'
    return text.replace("<svg", opening, 1)
