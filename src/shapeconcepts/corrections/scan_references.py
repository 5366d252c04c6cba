"""How an edit names scans so that it finds them again in another model of the same scans."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.corrections.edit import ScanReference


class ScanReferences:
    """References of the scans of a model.

    A scan is called by its name; of several with one name, by the name and its place among them.

    Parameters
    ----------
    names : sequence of str
        Of the scans of a model.

    Attributes
    ----------
    names : sequence of str
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names
        self._rows: dict[str, list[int]] = defaultdict(list)
        self._places: list[int] = []
        for row, name in enumerate(names):
            self._places.append(len(self._rows[name]))
            self._rows[name].append(row)

    def of(self, rows: Iterable[int]) -> tuple[ScanReference, ...]:
        """References of scans."""
        return tuple(self._of(int(row)) for row in rows)

    def rows(self, references: Iterable[ScanReference]) -> NDArray[np.int64]:
        """Rows of scans, in this order, -1 for those that are not there."""
        return np.array([self._row(one) for one in references], np.int64)

    def named(self, name: str) -> int:
        """Row of the only scan of a name.

        Raises
        ------
        ValueError
            If there is none, or there are several.
        """
        rows = self._rows.get(name, [])
        if len(rows) != 1:
            how_many = "no scan has" if not rows else f"{len(rows)} scans have"
            raise ValueError(f"{how_many} the name {name!r}: expected a row, or a name that one scan has")
        return rows[0]

    def _of(self, row: int) -> ScanReference:
        name = self.names[row]
        return name if len(self._rows[name]) == 1 else (name, self._places[row])

    def _row(self, reference: ScanReference) -> int:
        name, place = reference if isinstance(reference, tuple) else (reference, 0)
        rows = self._rows.get(name, [])
        return rows[place] if place < len(rows) else -1
