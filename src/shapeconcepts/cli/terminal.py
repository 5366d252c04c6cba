"""What the commands share when they talk to the user: results go to stdout, everything else to stderr."""

from __future__ import annotations

import errno
import os
import sys
import tempfile
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, TextIO, TypeVar

import typer

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

T = TypeVar("T")


def say(message: str) -> None:
    """Tell the user something that is not the result."""
    typer.echo(message, err=True)


def say_skipped(skipped: Sequence[tuple[str, str]], n_scans: int) -> None:
    """List scans, by name and reason, that could not be used."""
    if skipped:
        say(f"Skipped {len(skipped)} of {n_scans} scans:")
        for name, reason in skipped:
            # Most reasons name the file already, by its whole path.
            say(f"  {reason if name in reason else f'{name}: {reason}'}")


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

    if not (show and _is_terminal(sys.stderr)):
        yield from items
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    with Progress(*columns, console=_stderr(), transient=True) as bars:
        bar = bars.add_task(description, total=total, rate="")
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

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    if not _is_terminal(sys.stderr):
        yield
        return
    with Progress(*columns, console=_stderr(), transient=True) as bars:
        bars.add_task(description, total=None)
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


def _is_terminal(stream: TextIO | None) -> bool:
    return stream is not None and stream.isatty()


def print_table(titles: Sequence[str], rows: Iterable[Sequence[str]], folding: str = "") -> None:
    """A table on stdout; where that is no terminal, as wide as its content.

    Where a terminal is too narrow, the column `folding` (by default the first) takes several lines.
    """
    from rich.console import Console

    console = Console(markup=False, highlight=False)
    if console.is_terminal:
        console.print(_table(titles, rows, folding or titles[0]))
    else:
        typer.echo(table_text(titles, rows), nl=False)


def table_text(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table as wide as its content."""
    from io import StringIO

    from rich.console import Console

    table = _table(titles, rows, titles[0])
    console = Console(file=StringIO(), markup=False, highlight=False, width=100_000)
    console.width = console.measure(table).maximum
    with console.capture() as captured:
        console.print(table)
    return captured.get()


def _table(titles: Sequence[str], rows: Iterable[Sequence[str]], folding: str) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for title in titles:
        # A number cut short reads like another number: only one column may be folded.
        folds = title == folding
        table.add_column(title, no_wrap=not folds, overflow="fold", min_width=None if folds else len(title))
    for row in rows:
        table.add_row(*row)
    return table
