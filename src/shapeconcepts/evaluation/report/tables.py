"""Tables of the page, as HTML. Every text that comes from outside is escaped here."""

from __future__ import annotations

import html
from collections.abc import Sequence

Cell = str | tuple[str, str]


def table(
    columns: Sequence[str],
    rows: Sequence[Sequence[Cell]],
    *,
    ours: Sequence[int] = (),
    best: Sequence[tuple[int, int]] = (),
) -> str:
    """A table; the first cell of a row is its heading.

    Parameters
    ----------
    columns : sequence of str
        Headings.
    rows : sequence of sequence of (str or (str, str))
        Texts, not markup; the second of two is set small under the first.
    ours : sequence of int
        Rows to be set off.
    best : sequence of (int, int)
        Row and column of cells to be in bold.
    """
    head = "".join(f'<th scope="col">{html.escape(name)}</th>' for name in columns)
    lines = [f'<div class="scroll"><table class="figures"><thead><tr>{head}</tr></thead><tbody>']
    chosen, bold = set(ours), set(best)
    for i, row in enumerate(rows):
        cells = []
        for j, cell in enumerate(row):
            text, small = (cell, "") if isinstance(cell, str) else cell
            content = html.escape(text)
            if j == 0:
                cells.append(f'<th scope="row"><bdi>{content}</bdi></th>')
                continue
            if (i, j) in bold:
                content = f"<b>{content}</b>"
            if small:
                content += f"<small>{html.escape(small)}</small>"
            cells.append(f"<td>{content}</td>")
        lines.append(f"<tr{' class=ours' if i in chosen else ''}>{''.join(cells)}</tr>")
    lines.append("</tbody></table></div>")
    return "\n".join(lines)


def best_cells(values: Sequence[Sequence[float]], smallest: bool = False) -> list[tuple[int, int]]:
    """Row and column of the best value of each column; values that are equal in print are equally good.

    Parameters
    ----------
    values : sequence of sequence of float
        By row and column; NaN is never best. The first is column 1, since a table's column 0 is the heading.
    smallest : bool
        Whether small is good.
    """
    best = []
    for j, column in enumerate(zip(*values, strict=True), start=1):
        known = [round(value, 3) for value in column if value == value]
        if known:
            target = min(known) if smallest else max(known)
            best += [(i, j) for i, value in enumerate(column) if value == value and round(value, 3) == target]
    return best
