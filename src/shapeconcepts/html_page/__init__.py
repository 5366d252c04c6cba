"""Puts a template, a style and scripts into one page that runs nothing but these.

Its `templates` are those that the report and the explorer share. It imports nothing that takes its time: the
explorer's page is there before the library is.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable
from importlib.resources import files
from string import Template
from typing import NamedTuple

from shapeconcepts.printable import markup_bytes

STYLES = ("base", "figures")
# Elements, numbers, colours and scans.
DRAWING = ("elements", "formats", "colours", "scan_view", "tree_bands")
# Figures of a filtration, made of `contents`.
FIGURES = ("filtration", "dot_map", "maps", "timeline", "granularity", "figures")


class PageParts(NamedTuple):
    """What a page is made of.

    Attributes
    ----------
    template : str
        HTML with the places ``$style`` and ``$script``, and maybe others.
    style : str
    script : str
    """

    template: str
    style: str
    script: str

    @property
    def policy(self) -> str:
        """Nothing that a file's name might smuggle in is ever run, and nothing is fetched from elsewhere."""
        ours = f"style-src {_hash(self.style)}; script-src {_hash(self.script)}"
        return f"default-src 'none'; img-src data:; {ours}"

    def page(self, **places: str) -> bytes:
        """The page, with what belongs in the template's other places, as markup."""
        filled = Template(self.template).substitute(style=self.style, script=self.script, **places)
        return markup_bytes(filled)


def template(package: str, name: str) -> str:
    """A file of a package's folder `templates`; the package is not imported."""
    own, _, inner = package.partition(".")
    return files(own).joinpath(*inner.split("."), "templates", name).read_text("utf-8")


def shared_style() -> str:
    """Style of what the pages share."""
    return "\n".join(template(__name__, f"{name}.css") for name in STYLES)


def shared_scripts(names: Iterable[str]) -> list[str]:
    """Some of the scripts that the pages share."""
    return [template(__name__, f"{name}.js") for name in names]


def closed_script(parts: Iterable[str]) -> str:
    """One script, in which each part may use what those before it define; nothing else sees any of it."""
    return '"use strict";\n(() => {\n' + "\n".join(parts) + "\n})();\n"


def embedded_json(value: object) -> str:
    """JSON in ASCII that cannot end the script element that it stands in."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _hash(content: str) -> str:
    digest = base64.b64encode(hashlib.sha256(content.encode("utf-8")).digest()).decode("ascii")
    return f"'sha256-{digest}'"
