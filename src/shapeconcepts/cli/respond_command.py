"""`shapeconcepts respond`: how much scans resemble each concept of a model."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from shapeconcepts.cli.concept_summary import concept_title
from shapeconcepts.cli.model_input import object_reader, one_thread, read_model
from shapeconcepts.cli.object_reader import ReadObject, read_objects
from shapeconcepts.cli.options import (
    DepthScale,
    Extract,
    Granularity,
    Intrinsics,
    Jobs,
    Mask,
    ModelFile,
    Scenes,
    Strict,
    Units,
    Up,
    check_jobs,
    read_options,
    scan_files,
)
from shapeconcepts.cli.response_formats import Response, ResponseWriter, check_parquet, response_writer
from shapeconcepts.cli.terminal import (
    check_writable,
    fail,
    progress,
    say,
    say_notices,
    say_skipped,
    warnings_said,
)

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel

# Responses are computed for so many scans together.
_AT_ONCE = 32


def respond(
    model: ModelFile,
    scans: Annotated[
        list[Path],
        typer.Argument(
            metavar="SCAN",
            show_default=False,
            help="Files and folders of point clouds, depth images or meshes, or labelled scenes.",
        ),
    ],
    form: Annotated[
        Literal["table", "csv", "jsonl", "parquet"],
        typer.Option(
            "--format",
            help="table: to read; csv, jsonl: a line for each scan as soon as it is known; parquet: needs "
            "--output and the package pyarrow.",
        ),
    ] = "table",
    output: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write there, at the end, instead of to the terminal."),
    ] = None,
    granularity: Granularity = None,
    unknown_rate: Annotated[
        float | None,
        typer.Option(
            metavar="RATE",
            min=0,
            max=1,
            show_default="what is farther from all than any training scan from the next",
            help="Call a scan unknown where its p-value is RATE at most: of scans of something known, so "
            "large a share is, such as 0.05.",
        ),
    ] = None,
    scenes: Scenes = None,
    extract: Extract = False,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
    jobs: Jobs = -1,
    strict: Strict = False,
) -> None:
    """Say how much scans resemble each concept of a model: the smaller a response, the more alike.

    For each scan: the concept of whose members the scan reminds most, by name or number, or "unknown" where
    it is like none; the p-value, which is the probability that a scan of something known would be as unlike
    all training scans, or more; and the response of each concept, which is the mean distance to its members
    (nothing where the scan has nothing that the model knows).

    Scans that cannot be used are skipped and listed at the end. The exit code is 0 if there is a response,
    1 if not, and 2 if the command line is wrong.
    """
    check_jobs(jobs)
    if output is not None:
        check_writable(output, "--output")
    if form == "parquet":
        check_parquet(output)
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    files = scan_files(scans, mask)
    learned = read_model(model)
    if granularity is not None:
        try:
            learned = learned.at_granularity(granularity)
        except ValueError as error:
            raise typer.BadParameter(str(error), param_hint="--granularity") from None
    reader = object_reader(learned, reading, scenes, extract=extract)
    writer = response_writer(form, learned, output)
    skipped: list[tuple[str, str]] = []
    notices: list[tuple[str, str]] = []
    count = 0
    read = read_objects(files, reader, jobs, strict=strict)
    found = _usable(progress(read, len(files), "Reading scans", show=not writer.streams), skipped, strict)
    with one_thread(), warnings_said():
        while chunk := list(islice(found, _AT_ONCE)):
            notices += [(one.name, notice) for one in chunk for notice in one.notices]
            responses = _responses_or_reasons(learned, chunk, skipped, unknown_rate)
            writer.write(responses)
            count += len(responses)
    if strict and skipped:
        fail(skipped[0][1])
    _finish(writer, output)
    say_skipped(skipped, count + len(skipped))
    say_notices(notices, count)
    if count == 0:
        raise typer.Exit(1)


def _usable(
    read: Iterator[list[ReadObject]], skipped: list[tuple[str, str]], strict: bool
) -> Iterator[ReadObject]:
    """Objects that were described; the others are noted."""
    for objects in read:
        for one in objects:
            if one.described is not None:
                yield one
            else:
                skipped.append((one.name, one.reason))
                if strict:
                    return


def _responses_or_reasons(
    model: ShapeConceptModel,
    objects: list[ReadObject],
    skipped: list[tuple[str, str]],
    unknown_rate: float | None,
) -> list[Response]:
    """Responses to several scans at once or, where that fails, one by one; those without one are noted."""
    from shapeconcepts.scan import ScanError, scan_errors

    try:
        with scan_errors(objects[0].name, "compared with the concepts"):
            return _responses(model, objects, unknown_rate)
    except ScanError as error:
        if len(objects) == 1:
            skipped.append((objects[0].name, str(error)))
            return []
    return [
        response for one in objects for response in _responses_or_reasons(model, [one], skipped, unknown_rate)
    ]


def _responses(
    model: ShapeConceptModel, objects: list[ReadObject], unknown_rate: float | None
) -> list[Response]:
    recognition = model.recognise((one.described for one in objects), unknown_rate)
    # A model from a file has an ensemble of ours.
    assert recognition.p_values is not None
    return [
        Response(
            scan=one.name,
            label=None if one.described is None else one.described.label,
            number=number,
            concept=concept_title(model, number),
            p_value=p_value,
            values=row,
        )
        for one, number, p_value, row in zip(
            objects,
            recognition.concepts.tolist(),
            recognition.p_values.tolist(),
            recognition.responses,
            strict=True,
        )
    ]


def _finish(writer: ResponseWriter, output: Path | None) -> None:
    content = writer.finish()
    if output is None:
        return
    from shapeconcepts.io.atomic_write import write_atomically

    try:
        write_atomically(output, content)
    except OSError as error:
        fail(f"cannot write {output}: {error.strerror or error}")
    say(f"Wrote {output}")
