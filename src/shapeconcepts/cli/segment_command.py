"""`shapeconcepts segment`: the segments of scans as a table, as JSON and as a picture."""

from __future__ import annotations

import json
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from shapeconcepts.cli.object_reader import useful_jobs
from shapeconcepts.cli.options import (
    DepthScale,
    Intrinsics,
    Jobs,
    Json,
    Mask,
    Scenes,
    Strict,
    Units,
    Up,
    VoxelSize,
    check_jobs,
    read_options,
    scan_files,
    set_from_options,
)
from shapeconcepts.cli.pictures import check_picture_path, save_picture
from shapeconcepts.cli.terminal import fail, print_table, progress, say_notices, say_skipped, tell_json

if TYPE_CHECKING:
    from PIL.Image import Image

    from shapeconcepts.scan import Scan
    from shapeconcepts.segmentation import SegmentedObject, Segmenter
    from shapeconcepts.sources.collection import ScanFile
    from shapeconcepts.sources.reader import ReadOptions


class _Result(NamedTuple):
    """What a scan gives: a summary and, if wanted, a picture; the reason why one of them is missing."""

    name: str
    summary: dict[str, Any] | None = None
    picture: Image | None = None
    reason: str = ""
    notices: tuple[str, ...] = ()


def segment(
    scans: Annotated[
        list[Path],
        typer.Argument(
            metavar="SCAN",
            show_default=False,
            help="Point clouds, depth images or meshes, or folders; a sub-folder's name is the label.",
        ),
    ],
    image: Annotated[
        Path | None,
        typer.Option(
            metavar="OUT.png",
            dir_okay=False,
            help="Draw the segments, one colour each, into this file; several scans make a contact sheet.",
        ),
    ] = None,
    as_json: Json = False,
    voxel_size: VoxelSize = None,
    scenes: Scenes = None,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
    seed_size: Annotated[
        float | None,
        typer.Option(
            metavar="METRES",
            show_default="0.02",
            help="Distance of the seeds that atomic patches grow from.",
        ),
    ] = None,
    max_segments: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            show_default="12",
            help="Most segments of an object; above, the smallest are merged.",
        ),
    ] = None,
    jobs: Jobs = -1,
    strict: Strict = False,
) -> None:
    """Cut scans into the surface segments they are made of.

    A segment is a piece of surface that goes on smoothly, such as the face of a box or the side of a can.
    Scans that cannot be used are skipped and listed at the end, as are those that cannot be drawn. The exit
    code is 0 if at least one scan was segmented (with --strict: all of them) and the picture, if wanted, was
    written, 1 if not, and 2 if the command line is wrong.
    """
    from shapeconcepts.parallel import map_in_order
    from shapeconcepts.report import contact_sheet
    from shapeconcepts.segmentation import Segmenter

    if image is not None:
        check_picture_path(image, "--image")
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    check_jobs(jobs)
    files = scan_files(scans, mask)

    segmenter = Segmenter()
    set_from_options(
        segmenter,
        {
            "--voxel-size": ("voxel_size", voxel_size),
            "--seed-size": ("seed_size", seed_size),
            "--max-segments": ("max_segments", max_segments),
        },
    )
    picture_size = None if image is None else _picture_size(len(files))
    results: list[_Result] = []
    failed = False
    # Running jobs are not cancelled, which can hang joblib: no more are started, and those that run finish.
    wanted = takewhile(lambda file: not (strict and failed), files)
    work = partial(
        _segment_file, reading=reading, scenes=scenes, segmenter=segmenter, picture_size=picture_size
    )
    working = map_in_order(work, wanted, useful_jobs(jobs, len(files)))
    for found in progress(working, len(files), "Segmenting"):
        failed = failed or any(result.summary is None for result in found)
        results += found

    summaries = [result.summary for result in results if result.summary is not None]
    skipped = [result for result in results if result.summary is None]
    if strict and skipped:
        fail(skipped[0].reason)
    drawn = [result.picture for result in results if result.picture is not None]
    undrawn = [result for result in results if result.summary is not None and result.reason]
    saved = image is None or (bool(drawn) and save_picture(lambda: contact_sheet(drawn), image))
    if as_json:
        reasons = [{"name": result.name, "reason": result.reason} for result in skipped]
        tell_json({"scans": summaries, "skipped": reasons})
    elif summaries:
        titles = ("scan", "points", "voxels", "segments", "sizes", "neighbours")
        print_table(titles, [_row(summary) for summary in summaries])
    say_skipped([(result.name, result.reason) for result in skipped], len(results))
    say_notices([(result.name, notice) for result in results for notice in result.notices], len(summaries))
    say_skipped([(result.name, result.reason) for result in undrawn], len(summaries), "Could not draw")
    if not summaries or not saved:
        raise typer.Exit(1)


def _segment_file(
    file: ScanFile,
    reading: ReadOptions,
    scenes: bool | None,
    segmenter: Segmenter,
    picture_size: int | None,
) -> list[_Result]:
    """What the objects in a file give."""
    from shapeconcepts.scan import ScanError, scan_errors
    from shapeconcepts.sources.file_objects import objects_of_file

    try:
        with scan_errors(file.name, "read"):
            objects = objects_of_file(file, scenes, **reading)
    except ScanError as error:
        return [_Result(file.name, reason=str(error))]
    return [_segment_scan(scan, segmenter, picture_size) for scan in objects]


def _segment_scan(scan: Scan, segmenter: Segmenter, picture_size: int | None) -> _Result:
    from shapeconcepts.report import draw_segments
    from shapeconcepts.scan import ScanError, scan_errors

    result = _Result(scan.name)
    try:
        with scan_errors(scan.name, "segmented"):
            item = segmenter.segment(scan)
            summary = _summary(item)
            # A number that JSON does not know must not cost the document about all others.
            json.dumps(summary, allow_nan=False)
            result = result._replace(summary=summary, notices=item.notices)
        with scan_errors(scan.name, "drawn"):
            return result._replace(
                picture=None if picture_size is None else draw_segments(item, size=picture_size)
            )
    except ScanError as error:
        return result._replace(reason=str(error))


def _summary(item: SegmentedObject) -> dict[str, Any]:
    """What JSON says of a segmented object: plain numbers, metres."""
    import numpy as np

    edges = item.segment_edges.tolist()
    segments = []
    for index in range(item.n_segments):
        members = item.segment_labels == index
        mean_normal = item.normals[members].mean(axis=0)
        length = np.linalg.norm(mean_normal)
        segments.append(
            {
                "index": index,
                "n_voxels": int(members.sum()),
                "share": round(float(members.mean()), 6),
                "centroid": item.points[members].mean(axis=0).round(6).tolist(),
                "mean_normal": (mean_normal / length if length > 0 else mean_normal).round(6).tolist(),
                "neighbours": sorted({end for edge in edges if index in edge for end in edge} - {index}),
            }
        )
    return {
        "name": item.name,
        "label": item.label,
        "viewpoint": None if item.viewpoint is None else item.viewpoint.tolist(),
        "n_points": len(item.point_to_voxel),
        "n_voxels": len(item.points),
        "voxel_size": item.voxel_size,
        "n_segments": item.n_segments,
        "segments": segments,
        "edges": edges,
    }


def _row(summary: dict[str, Any]) -> tuple[str, ...]:
    return (
        summary["name"],
        str(summary["n_points"]),
        str(summary["n_voxels"]),
        str(summary["n_segments"]),
        " ".join(f"{segment['share']:.0%}" for segment in summary["segments"]),
        " ".join(f"{first}-{second}" for first, second in summary["edges"]),
    )


def _picture_size(n_pictures: int) -> int:
    """Pixels for each object: one fills a screen, a sheet of hundreds is still a picture."""
    if n_pictures == 1:
        return 960
    return 400 if n_pictures <= 100 else 240
