"""The command line: `shapeconcepts --help` is its manual."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from shapeconcepts.cli.doctor_command import doctor
from shapeconcepts.cli.evaluate_command import evaluate
from shapeconcepts.cli.explain_command import explain
from shapeconcepts.cli.explore_command import explore
from shapeconcepts.cli.export_command import export
from shapeconcepts.cli.extract_command import extract
from shapeconcepts.cli.info_command import info
from shapeconcepts.cli.learn_command import learn
from shapeconcepts.cli.respond_command import respond
from shapeconcepts.cli.segment_command import segment
from shapeconcepts.cli.simulate_command import simulate
from shapeconcepts.cli.terminal import fail_for_output, let_output_hold_any_text, say, tell
from shapeconcepts.cli.watch_command import watch
from shapeconcepts.interruption import INTERRUPTED, message_when_interrupted, say_when_interrupted
from shapeconcepts.printable import printable
from shapeconcepts.version import __version__

# Typer comes with click within it, or beside it, and hands out only this of its errors.
_UsageError: Any = typer.BadParameter.__base__


class _Commands(TyperGroup):
    def main(self, *args: Any, **kwargs: Any) -> Any:
        let_output_hold_any_text()
        return super().main(*args, **kwargs)

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        with _printable_errors():
            return super().make_context(*args, **kwargs)

    def invoke(self, ctx: Any) -> Any:
        say_when_interrupted(INTERRUPTED)
        try:
            with _printable_errors():
                return super().invoke(ctx)
        # Where another program calls `app`, in which signals do not end the process.
        except KeyboardInterrupt:
            say(message_when_interrupted())
            raise typer.Exit(130) from None


@contextmanager
def _printable_errors() -> Iterator[None]:
    """Typer prints what it finds wrong with the command line itself, with what the user gave in it."""
    try:
        yield
    except _UsageError as error:
        error.message = printable(error.message)
        raise


app = typer.Typer(
    name="shapeconcepts",
    cls=_Commands,
    help=(
        "Learns what shapes a set of scanned objects have in common, without labels, from point clouds of a "
        "Kinect-like sensor."
    ),
    epilog=(
        "Start with `shapeconcepts simulate scans`, then "
        "`shapeconcepts learn scans --model m.safetensors --report report.html`, and open report.html. "
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
        "shapeconcepts learn scans/ --model m.safetensors --report report.html\n\n"
        "shapeconcepts learn scans/ --model paper.safetensors --preset paper --min-size 5\n\n"
        "shapeconcepts learn --model demo.safetensors --report demo.html"
    )
)(learn)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts extract scenes/ objects/\n\n"
        "shapeconcepts extract kitchen.mcap objects/ --topic /camera/depth/points --every 30"
    )
)(extract)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts respond m.safetensors new/\n\n"
        "shapeconcepts respond m.safetensors new/ --format csv > responses.csv\n\n"
        "shapeconcepts respond m.safetensors new/ --format parquet --output responses.parquet"
    )
)(respond)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts explain m.safetensors mug.pcd --image why.png --training-data scans/\n\n"
        "shapeconcepts explain m.safetensors learn33.pcd --object 3"
    )
)(explain)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts evaluate --report evaluation.html\n\n"
        "shapeconcepts evaluate scans/ --report evaluation.html --figures figures/\n\n"
        "shapeconcepts evaluate --also osd_learn/ --also restaurant/ --rename cocacola=can\n\n"
        "shapeconcepts evaluate scans/ --json > evaluation.json"
    )
)(evaluate)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts info m.safetensors\n\n"
        "shapeconcepts info m.safetensors --name 0=mugs --name 3=boxes"
    )
)(info)
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
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts watch recordings/ --model m.safetensors\n\n"
        "shapeconcepts watch recordings/ --model m.safetensors --once > answers.jsonl"
    )
)(watch)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts export m.safetensors dataset/ --scans scans/\n\n"
        "shapeconcepts export m.safetensors scans.csv --layout csv\n\n"
        "shapeconcepts export m.safetensors kitti/ --layout semantic-kitti --scans scans/\n\n"
        "shapeconcepts export m.safetensors --rerun scans.rrd --scans scans/"
    )
)(export)
app.command(
    epilog=(
        "Examples:\n\n"
        "shapeconcepts explore m.safetensors --scans scans/\n\n"
        "shapeconcepts explore m.safetensors --scans scans/ --no-browser --port 8000"
    )
)(explore)
app.command()(doctor)


def _print_version(wanted: bool) -> None:
    if wanted:
        tell(f"shapeconcepts {__version__}")
        raise typer.Exit


@app.callback()
def _shapeconcepts(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the `shapeconcepts` command."""
    try:
        try:
            app()
        finally:
            # Not later, when nobody can tell what went wrong. There is no stdout where it was closed.
            if sys.stdout is not None:
                sys.stdout.flush()
    except OSError as error:
        fail_for_output(error)
