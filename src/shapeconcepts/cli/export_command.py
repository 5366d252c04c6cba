"""`shapeconcepts export`: the scans of a model, with their concepts, as a labelled data set."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from shapeconcepts.cli.model_input import one_thread, read_model
from shapeconcepts.cli.options import (
    DepthScale,
    Intrinsics,
    Json,
    LearnedScans,
    Mask,
    ModelFile,
    Units,
    Up,
    read_options,
    scan_files,
)
from shapeconcepts.cli.terminal import busy, fail, print_table, say, say_skipped, tell_json, warnings_said

if TYPE_CHECKING:
    from shapeconcepts.export import Export

_MISSING_SHOWN = 5


def export(
    model: ModelFile,
    out: Annotated[
        Path | None,
        typer.Argument(
            metavar="OUT",
            show_default=False,
            help="Folder to write, which is not there yet or empty; for csv and parquet a file. It may be "
            "left out with --rerun.",
        ),
    ] = None,
    layout: Annotated[
        Literal["folders", "csv", "parquet", "semantic-kitti", "labelcloud", "fiftyone"],
        typer.Option(
            help="folders: a folder for each concept with the files of its scans; csv, parquet: a table with "
            "a row for each scan; semantic-kitti, labelcloud, fiftyone: what these read."
        ),
    ] = "folders",
    scans: LearnedScans = None,
    rerun: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.rrd",
            help="Write a recording for the Rerun viewer as well: each scan with its segments, concept and "
            "responses. Needs the extra `rerun`.",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace what is at OUT, with all that is in it.")
    ] = False,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
    as_json: Json = False,
) -> None:
    """Write the scans that a model was learned from, with their concepts: a labelled data set.

    Scans are found again by their names. The most typical ones of each concept come first; index.csv says of
    each which concept it is in, how much it resembles it, and its p-value.

    Scans that are not found, or cannot be read, are left out and listed at the end. OUT appears complete or
    not at all. The exit code is 0 if there is a data set, 1 if not, and 2 if the command line is wrong.
    """
    if out is None and rerun is None:
        raise typer.BadParameter("say where to write the data set", param_hint="OUT")
    if not scans and (rerun is not None or layout not in ("csv", "parquet")):
        what = "--rerun" if out is None else layout
        raise typer.BadParameter(f"{what} needs the scans: say where they are", param_hint="--scans")
    if out is not None and force and _is_within(model, out):
        raise typer.BadParameter(f"must not hold the model, got {out}", param_hint="OUT")
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    if scans:
        # Says what is wrong with them before the model is read.
        scan_files(scans, mask)
    learned = read_model(model)

    from shapeconcepts.export import export_scans
    from shapeconcepts.scan import ScanError

    place = str(out or rerun)
    try:
        with one_thread(), busy("Exporting scans"), warnings_said():
            exported = export_scans(
                learned, out, layout, scans=scans or (), force=force, rerun=rerun, **reading
            )
    except (ScanError, ModuleNotFoundError) as error:
        fail(str(error))
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="OUT") from None
    except FileExistsError as error:
        fail(f"{error.strerror or error}: --force replaces it")
    except OSError as error:
        fail(f"cannot write {place}: {_reason(error, place)}")
    paths = {"out": None if out is None else str(out), "rerun": None if rerun is None else str(rerun)}
    if as_json:
        tell_json({"model": str(model), **paths, "layout": layout, **_document(exported)})
    else:
        _print(exported)
    _say_missing(exported)
    say_skipped(exported.skipped, exported.n_written + len(exported.skipped))
    for path in filter(None, (out, rerun)):
        say(f"Wrote {path}")


def _is_within(path: Path, folder: Path) -> bool:
    whole = Path(os.path.realpath(folder))
    place = Path(os.path.realpath(path))
    return place == whole or whole in place.parents


def _reason(error: OSError, place: str) -> str:
    reason = error.strerror or str(error)
    return reason.removeprefix(f"{os.path.realpath(place)}: ")


def _document(exported: Export) -> dict[str, Any]:
    return {
        "n_written": exported.n_written,
        "concepts": [
            {
                "number": one.number,
                "key": one.key,
                "name": one.name,
                "class": one.title,
                "n_written": count,
                "size": one.size,
            }
            for one, count in exported.counts
        ],
        "missing": list(exported.missing),
        "skipped": [{"name": name, "reason": reason} for name, reason in exported.skipped],
    }


def _print(exported: Export) -> None:
    rows = [[one.title, str(count), str(one.size)] for one, count in exported.counts if one.size]
    print_table(["concept", "written", "in the model"], rows, folding="concept")


def _say_missing(exported: Export) -> None:
    if not exported.missing:
        return
    n_missing, n_all = len(exported.missing), sum(one.size for one, _ in exported.counts)
    say(f"Not found, by their names, {n_missing:,} of {n_all:,} scans:")
    for name in exported.missing[:_MISSING_SHOWN]:
        say(f"  {name}")
    if n_missing > _MISSING_SHOWN:
        say(f"  and {n_missing - _MISSING_SHOWN:,} more")
