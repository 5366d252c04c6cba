"""Names of files without suffix, numbered in the order of a catalogue."""

from __future__ import annotations

from pathlib import PurePosixPath

from shapeconcepts.export.catalogue import Catalogue
from shapeconcepts.export.safe_names import safe_name


def numbered_names(catalogue: Catalogue) -> dict[int, str]:
    """Name of each scan's files by its row in the model: concept by concept, the most typical ones first."""
    width = max(len(str(len(catalogue.entries) - 1)), 6)
    return {
        entry.row: f"{number:0{width}}_{_stem(entry.name)}" for number, entry in enumerate(catalogue.entries)
    }


def _stem(name: str) -> str:
    """The end of a scan's name: of its file without the suffix, or of what it is a part of, and which."""
    parts = PurePosixPath(name).parts[-2:]
    is_part = len(parts) == 2 and (parts[1].isdecimal() or parts[1].startswith("view "))
    return safe_name("_".join(parts) if is_part else PurePosixPath(name).stem)
