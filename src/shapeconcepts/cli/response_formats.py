"""Responses as a table, as CSV, as JSON lines and as Parquet."""

from __future__ import annotations

import csv
import json
import sys
from io import BytesIO, StringIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import typer

from shapeconcepts.cli.terminal import fail, is_terminal, print_table, table_text
from shapeconcepts.printable import encodable, printable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from shapeconcepts.model import ShapeConceptModel

# A table with more columns of numbers is not read by anybody.
_MOST_COLUMNS = 8
_NEAREST = 3


class Response(NamedTuple):
    """What is said of a scan: the concept as number and in words, p-value, and (k,) responses, maybe NaN."""

    scan: str
    label: str | None
    number: int
    concept: str
    p_value: float
    values: NDArray[np.float64]


class ResponseWriter:
    """Takes responses piece by piece; to stdout, or for a file.

    Parameters
    ----------
    model : ShapeConceptModel
    to_file : bool
        Whether `finish` shall hand out the content, instead of printing it.
    """

    streams = False

    def __init__(self, model: ShapeConceptModel, to_file: bool) -> None:
        titles = [str(title) for title in model.get_feature_names_out()]
        distinct = len(set(titles)) == len(titles)
        self.titles = titles if distinct else [f"concept{number}" for number in range(len(titles))]
        self.to_file = to_file
        self.responses: list[Response] = []
        self.streams = type(self).streams and not to_file

    def write(self, responses: list[Response]) -> None:
        """Take the next responses."""
        self.responses += responses

    def finish(self) -> bytes:
        """Content for a file; print what is not printed yet where there is none."""
        raise NotImplementedError


class TableWriter(ResponseWriter):
    """For people: all responses, or those of the nearest concepts where there are many."""

    def finish(self) -> bytes:
        has_labels = any(one.label is not None for one in self.responses)
        wide = len(self.titles) > _MOST_COLUMNS
        values = [f"nearest {_NEAREST} of {len(self.titles)} concepts"] if wide else self.titles
        titles = ["scan", *["label"] * has_labels, "concept", "p-value", *values]
        rows = [
            [
                one.scan,
                *[one.label or ""] * has_labels,
                one.concept,
                _number(one.p_value),
                *(self._nearest(one) if wide else map(_number, one.values)),
            ]
            for one in self.responses
        ]
        if self.to_file:
            return table_text(titles, rows).encode()
        if rows:
            print_table(titles, rows)
        return b""

    def _nearest(self, one: Response) -> list[str]:
        order = one.values.argsort()[:_NEAREST]
        return [
            "  ".join(f"{self.titles[k]} {_number(one.values[k])}" for k in order if _number(one.values[k]))
        ]


class LineWriter(ResponseWriter):
    """Formats that have a line for each scan."""

    streams = True

    def __init__(self, model: ShapeConceptModel, to_file: bool) -> None:
        super().__init__(model, to_file)
        self.stream = StringIO() if to_file else sys.stdout
        # To a program a name is the file's own; at a terminal it must do nothing.
        self.shown = encodable if to_file or not is_terminal(sys.stdout) else printable
        self.start()

    def start(self) -> None:
        """Write what stands above the lines."""

    def write(self, responses: list[Response]) -> None:
        for one in responses:
            self.write_line(one)
        self.stream.flush()

    def write_line(self, one: Response) -> None:
        """Write a response."""
        raise NotImplementedError

    def finish(self) -> bytes:
        return self.stream.getvalue().encode() if isinstance(self.stream, StringIO) else b""


class CsvWriter(LineWriter):
    """Scan, label, concept, p-value, and a column for each concept; empty where there is no response."""

    def start(self) -> None:
        self._write_row(["scan", "label", "concept", "p_value", *map(self.shown, self.titles)])

    def write_line(self, one: Response) -> None:
        names = map(self.shown, (one.scan, one.label or "", one.concept))
        numbers = [one.p_value, *_floats(one)]
        self._write_row([*names, *["" if v != v else repr(v) for v in numbers]])

    def _write_row(self, cells: list[str]) -> None:
        row = StringIO()
        # What is quoted are the characters of this end of a line; ours is the newline alone.
        csv.writer(row, lineterminator="\r\n").writerow(cells)
        self.stream.write(row.getvalue().removesuffix("\r\n") + "\n")


class JsonLinesWriter(LineWriter):
    """An object for each scan; `number` is -1 where the concept is unknown."""

    def write_line(self, one: Response) -> None:
        values = [None if value != value else value for value in _floats(one)]
        line = {"scan": one.scan, "label": one.label, "number": one.number, "concept": one.concept}
        p_value = None if one.p_value != one.p_value else one.p_value
        responses = dict(zip(self.titles, values, strict=True))
        self.stream.write(
            json.dumps({**line, "p_value": p_value, "responses": responses}, allow_nan=False) + "\n"
        )


class ParquetWriter(ResponseWriter):
    """The columns of CSV, with null where there is no response."""

    def finish(self) -> bytes:
        import numpy as np
        import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]
        import pyarrow.parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]

        values = np.array([one.values for one in self.responses]).reshape(
            len(self.responses), len(self.titles)
        )
        text = pyarrow.string()
        columns = {
            "scan": pyarrow.array([encodable(one.scan) for one in self.responses], text),
            "label": pyarrow.array([one.label and encodable(one.label) for one in self.responses], text),
            "concept": pyarrow.array([encodable(one.concept) for one in self.responses], text),
        }
        p_values = np.array([one.p_value for one in self.responses], float)
        columns["p_value"] = pyarrow.array(p_values, pyarrow.float64(), from_pandas=True)
        for title, column in zip(self.titles, values.T, strict=True):
            columns[encodable(title)] = pyarrow.array(column, pyarrow.float64(), from_pandas=True)
        content = BytesIO()
        pyarrow.parquet.write_table(pyarrow.table(columns), content)
        return content.getvalue()


_WRITERS: dict[str, type[ResponseWriter]] = {
    "table": TableWriter,
    "csv": CsvWriter,
    "jsonl": JsonLinesWriter,
    "parquet": ParquetWriter,
}


def response_writer(form: str, model: ShapeConceptModel, output: Path | None) -> ResponseWriter:
    """The writer of a format: "table", "csv", "jsonl" or "parquet"."""
    return _WRITERS[form](model, output is not None)


def check_parquet(output: Path | None) -> None:
    """Complain early where Parquet cannot be written."""
    if output is None:
        raise typer.BadParameter("parquet is not for a terminal: add --output FILE", param_hint="--format")
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        fail("parquet needs the package pyarrow, which is not installed: pip install pyarrow")


def _floats(one: Response) -> list[float]:
    values: list[float] = one.values.tolist()
    return values


def _number(value: float) -> str:
    return "" if value != value else f"{value:.3g}"
