"""The command line: `shapeconcepts --help` is its manual."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from shapeconcepts import __version__
from shapeconcepts.cli.segment_command import segment
from shapeconcepts.cli.simulate_command import simulate
from shapeconcepts.cli.terminal import fail_for_output

app = typer.Typer(
    name="shapeconcepts",
    help="Finds the surfaces that scanned objects are made of, from point clouds of a Kinect-like sensor.",
    epilog=(
        "Start with `shapeconcepts simulate scans`, then "
        "`shapeconcepts segment scans --image segments.png`. "
        "Each command has its own `--help`."
    ),
    rich_markup_mode="markdown",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_show_locals=False,
)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts segment mug.pcd --image mug.png\n\n"
        "shapeconcepts segment scans/ --image sheet.png --n-jobs -1\n\n"
        "shapeconcepts segment scans/ --json > segments.json\n\n"
        "shapeconcepts segment depth/ --mask masks/ --intrinsics 570.3,570.3,320,240"
    )
)(segment)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts simulate scans\n\n"
        "shapeconcepts simulate scans --n-per-category 66 --categories box,can --random-state 7"
    )
)(simulate)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"shapeconcepts {__version__}")
        raise typer.Exit


@app.callback()
def _shapeconcepts(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Entry point of the `shapeconcepts` command."""
    try:
        try:
            app()
        finally:
            # Not later, when nobody can tell what went wrong. There is no stdout where it was closed.
            if sys.stdout is not None:
                sys.stdout.flush()
    except OSError as error:
        fail_for_output(error)
