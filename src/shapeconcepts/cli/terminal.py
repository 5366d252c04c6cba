"""What the commands share when they talk to the user: results go to stdout, everything else to stderr."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import NoReturn, TextIO, TypeVar

import typer

T = TypeVar("T")


def say(message: str) -> None:
    """Tell the user something that is not the result."""
    typer.echo(message, err=True)


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


def progress(items: Iterable[T], total: int, description: str) -> Iterator[T]:
    """The items, with a progress bar while stderr is a terminal."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    yield from track(
        items, description, total, console=console, transient=True, disable=not sys.stderr.isatty()
    )


def print_table(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """A table on stdout; where that is no terminal, as wide as its content."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for title in titles:
        first = title == titles[0]
        # A number cut short reads like another number: only the name may be folded.
        table.add_column(title, no_wrap=not first, overflow="fold", min_width=None if first else len(title))
    for row in rows:
        table.add_row(*row)
    console = Console(markup=False, highlight=False)
    if not console.is_terminal:
        console.width = 10_000
        console.width = console.measure(table).maximum
    console.print(table)
