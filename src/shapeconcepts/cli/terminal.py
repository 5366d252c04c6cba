"""What the commands share when they talk to the user: results go to stdout, everything else to stderr.

Whatever they say goes through here, and is made printable: names come from files and models of others.
"""

from __future__ import annotations

import errno
import json
import os
import sys
import tempfile
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, TextIO, TypeVar

import typer

from shapeconcepts.printable import printable

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

T = TypeVar("T")


# What lines of tables are drawn with.
_LINE = "─"


def let_output_hold_any_text() -> None:
    """Escape what the encoding of the output lacks: a name must not end a command after all the work."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def say(message: str) -> None:
    """Tell the user something that is not the result."""
    typer.echo(printable(message), err=True)


def tell(line: str) -> None:
    """A line of the result."""
    typer.echo(printable(line))


def tell_json(document: object) -> None:
    """The result as JSON, in ASCII; a name in it is the file's own, whatever bytes it has."""
    typer.echo(json.dumps(document, indent=2, allow_nan=False))


def say_skipped(skipped: Sequence[tuple[str, str]], n_scans: int, what: str = "Skipped") -> None:
    """List scans, by name and reason, that something was not possible with."""
    if skipped:
        say(f"{what} {len(skipped)} of {n_scans} scans:")
        for name, reason in skipped:
            # Most reasons name the file already, by its whole path.
            say(f"  {reason if printable(name) in reason else f'{name}: {reason}'}")


def say_notices(notices: Sequence[tuple[str, str]], n_scans: int) -> None:
    """What should be looked at in scans, by name and notice; see `Scan.notices`."""
    from shapeconcepts.sources.notices import in_few_words

    for sentence in in_few_words(notices, n_scans):
        say(f"Note: {sentence}")


def fail(message: str) -> NoReturn:
    """End with exit code 1 and a message."""
    say(f"Error: {message}")
    raise typer.Exit(1)


def fail_for_output(error: OSError) -> NoReturn:
    """End with exit code 1 as the output cannot be written; quietly where its reader has seen enough."""
    # What is still in the buffer cannot be written at the exit either.
    _forget(sys.stdout)
    if error.errno != errno.EPIPE:
        place = "cannot write the output" if error.filename is None else error.filename
        try:
            say(f"Error: {place}: {error.strerror or error}")
        except OSError:
            _forget(sys.stderr)
    sys.exit(1)


def _forget(stream: TextIO | None) -> None:
    if stream is None:
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def progress(items: Iterable[T], total: int, description: str, *, show: bool = True) -> Iterator[T]:
    """The items, with a bar, the rate and the time left while stderr is a terminal."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    if not (show and is_terminal(sys.stderr)):
        yield from items
        return
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}", markup=False),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    with Progress(*columns, console=_stderr(), transient=True) as bars:
        bar = bars.add_task(printable(description), total=total, rate="")
        for item in items:
            yield item
            bars.advance(bar)
            done, seconds = bars.tasks[0].completed, bars.tasks[0].elapsed or 0.0
            # The first ones say nothing yet.
            bars.update(bar, rate=f"{done / seconds:.1f}/s" if seconds > 1 else "")


@contextmanager
def busy(description: str) -> Iterator[None]:
    """A sign of life, with the time that has passed, while stderr is a terminal."""
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    if not is_terminal(sys.stderr):
        yield
        return
    console = _stderr()
    columns = (
        SpinnerColumn("line" if console.options.ascii_only else "dots"),
        TextColumn("{task.description}", markup=False),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bars:
        bars.add_task(printable(description), total=None)
        yield


@contextmanager
def warnings_said() -> Iterator[None]:
    """Warnings of the library as a line each, each once."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")
        warnings.simplefilter("always", UserWarning)
        yield
    for message in dict.fromkeys(str(warning.message) for warning in caught):
        say(f"Note: {message}")


def check_writable(path: Path, option: str) -> None:
    """Complain before the work is done, not after."""
    from shapeconcepts.io.atomic_write import check_replaceable

    try:
        if path.is_dir():
            raise typer.BadParameter(f"{path} is a folder", param_hint=option)
        target = Path(os.path.realpath(path))
        if not target.parent.is_dir():
            raise typer.BadParameter(f"the folder {path.parent} does not exist", param_hint=option)
        if target.exists() and not target.is_file():
            raise typer.BadParameter(
                f"{path} is not a regular file: it could not be replaced", param_hint=option
            )
        check_replaceable(target)
        # Permissions alone do not tell: root has all of them, and a full or read-only disk has none.
        with tempfile.NamedTemporaryFile(dir=target.parent, prefix=".shapeconcepts-"):
            pass
    except OSError as error:
        fail(f"cannot write {path}: {error.strerror or error}")


def is_same_file(path: Path, other: Path) -> bool:
    """Whether two paths lead to one file, which may not be there yet."""
    if path.exists() and other.exists():
        return path.samefile(other)
    return os.path.realpath(path) == os.path.realpath(other)


def _stderr() -> Console:
    from rich.console import Console

    return Console(stderr=True)


def is_terminal(stream: TextIO | None) -> bool:
    """Whether a person looks at the stream; there is none where it was closed."""
    return stream is not None and stream.isatty()


def print_table(titles: Sequence[str], rows: Iterable[Sequence[str]], folding: str = "") -> None:
    """A table on stdout; where that is no terminal, as wide as its content.

    Where a terminal is too narrow, the column `folding` (by default the first) takes several lines.
    """
    from rich.console import Console

    console = Console()
    encoding = console.encoding
    if console.is_terminal:
        console.print(_table(titles, rows, folding or titles[0], encoding))
    else:
        typer.echo(table_text(titles, rows, encoding), nl=False)


def table_text(titles: Sequence[str], rows: Iterable[Sequence[str]], encoding: str = "utf-8") -> str:
    """A table as wide as its content, of what the encoding has."""
    from io import StringIO

    from rich.console import Console

    table = _table(titles, rows, titles[0], encoding)
    console = Console(file=StringIO(), width=100_000)
    console.width = console.measure(table).maximum
    with console.capture() as captured:
        console.print(table)
    return captured.get()


def _table(titles: Sequence[str], rows: Iterable[Sequence[str]], folding: str, encoding: str) -> Table:
    from rich.box import SIMPLE_HEAD, Box
    from rich.table import Table
    from rich.text import Text

    def cell(text: str) -> Text:
        # Before columns get their widths. As Text, since what looks like rich's markup is part of a name.
        return Text(_within(printable(text), encoding))

    has_line = _within(_LINE, encoding) == _LINE
    box = SIMPLE_HEAD if has_line else Box(str(SIMPLE_HEAD).replace(_LINE, "-"), ascii=True)
    table = Table(box=box, pad_edge=False)
    for title in titles:
        # A number cut short reads like another number: only one column may be folded.
        folds = title == folding
        heading = cell(title)
        table.add_column(
            heading, no_wrap=not folds, overflow="fold", min_width=None if folds else heading.cell_len
        )
    for row in rows:
        table.add_row(*map(cell, row))
    return table


def _within(text: str, encoding: str) -> str:
    """Text in which characters that the encoding lacks are escaped."""
    return text.encode(encoding, "backslashreplace").decode(encoding)
