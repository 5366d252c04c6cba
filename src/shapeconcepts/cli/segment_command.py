"""`shapeconcepts segment`: the segments of scans as a table, as JSON and as a picture."""

from __future__ import annotations

import json
from io import BytesIO
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from shapeconcepts.cli.terminal import fail, print_table, progress, say

if TYPE_CHECKING:
    from PIL.Image import Image

    from shapeconcepts.io.collection import ReadOptions, ScanFile
    from shapeconcepts.segmentation.segmented_object import SegmentedObject


class _Result(NamedTuple):
    """What a scan gives: a summary with or without a picture, or the reason why it gives neither."""

    name: str
    summary: dict[str, Any] | None = None
    picture: Image | None = None
    reason: str = ""


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
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document instead of the table.")
    ] = False,
    voxel_size: Annotated[
        float | None,
        typer.Option(
            min=1e-4,
            max=1.0,
            metavar="METRES",
            help="Edge length of the voxels that points are merged into; by default it suits each scan.",
            show_default="auto",
        ),
    ] = None,
    intrinsics: Annotated[
        str | None,
        typer.Option(
            metavar="FX,FY,CX,CY",
            help="Of depth images: focal lengths and principal point in pixels.",
            show_default="a Kinect's, for 640 x 480 pixels",
        ),
    ] = None,
    depth_scale: Annotated[
        float, typer.Option(metavar="METRES", help="Of depth images: metres per unit of depth.")
    ] = 0.001,
    mask: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            help="Of depth images: an image that is not 0 where the object is, or a folder with one for each "
            "depth image, of the same name.",
        ),
    ] = None,
    seed_size: Annotated[
        float,
        typer.Option(
            min=1e-4, max=1.0, metavar="METRES", help="Distance of the seeds that atomic patches grow from."
        ),
    ] = 0.02,
    max_segments: Annotated[
        int,
        typer.Option(min=1, metavar="N", help="Most segments of an object; above, the smallest are merged."),
    ] = 12,
    n_jobs: Annotated[
        int,
        typer.Option(metavar="N", help="Scans worked on at a time; -1 uses all cores. It changes no result."),
    ] = 1,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Stop at the first scan that cannot be used, instead of skipping it."),
    ] = False,
) -> None:
    """Cut scans into the surface segments they are made of.

    A segment is a piece of surface that goes on smoothly, such as the face of a box or the side of a can.
    Scans that cannot be used are skipped and listed at the end. The exit code is 0 if at least one scan was
    segmented (with --strict: all of them), 1 if not, and 2 if the command line is wrong.
    """
    from joblib import Parallel, delayed

    from shapeconcepts.io.collection import find_scan_files
    from shapeconcepts.scan import ScanError

    if image is not None:
        _check_image_path(image)
    reading = _read_options(intrinsics, depth_scale, mask)
    if n_jobs == 0:
        raise typer.BadParameter("must not be 0", param_hint="--n-jobs")
    try:
        files = find_scan_files(scans)
    except ScanError as error:
        fail(str(error))
    if mask is not None and not any(file.path.suffix.lower() == ".png" for file in files):
        raise typer.BadParameter(
            f"is for depth images (.png), got {mask}, but there is none among the scans", param_hint="--mask"
        )

    options = {
        "voxel_size": "auto" if voxel_size is None else voxel_size,
        "seed_size": seed_size,
        "max_segments": max_segments,
    }
    picture_size = None if image is None else _picture_size(len(files))
    results: list[_Result] = []
    failed = False
    # Running jobs are not cancelled, which can hang joblib: no more are started, and those that run finish.
    wanted = takewhile(lambda file: not (strict and failed), files)
    jobs = Parallel(n_jobs=n_jobs, return_as="generator")(
        delayed(_segment_file)(file, reading, options, picture_size) for file in wanted
    )
    for result in progress(jobs, len(files), "Segmenting"):
        failed = failed or result.summary is None
        results.append(result)

    summaries = [result.summary for result in results if result.summary is not None]
    skipped = [result for result in results if result.summary is None]
    if strict and skipped:
        fail(skipped[0].reason)
    drawn = [result.picture for result in results if result.picture is not None]
    saved = image is None or not drawn or _save_sheet(drawn, image)
    if as_json:
        reasons = [{"name": result.name, "reason": result.reason} for result in skipped]
        typer.echo(json.dumps({"scans": summaries, "skipped": reasons}, indent=2, allow_nan=False))
    elif summaries:
        titles = ("scan", "points", "voxels", "segments", "sizes", "neighbours")
        print_table(titles, [_row(summary) for summary in summaries])
    if skipped:
        say(f"Skipped {len(skipped)} of {len(files)} scans:")
        for result in skipped:
            say(f"  {result.reason}")
    if not summaries or not saved:
        raise typer.Exit(1)


def _read_options(intrinsics: str | None, depth_scale: float, mask: Path | None) -> ReadOptions:
    from shapeconcepts.io.depth_image import check_camera

    camera = None
    if intrinsics is not None:
        try:
            fx, fy, cx, cy = map(float, intrinsics.split(","))
            camera = (fx, fy, cx, cy)
            check_camera(camera, 1.0)
        except ValueError:
            raise typer.BadParameter(
                f"must be 4 finite numbers FX,FY,CX,CY in pixels, FX and FY > 0, got {intrinsics!r}",
                param_hint="--intrinsics",
            ) from None
    try:
        check_camera(None, depth_scale)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--depth-scale") from None
    return {"intrinsics": camera, "depth_scale": depth_scale, "mask": mask}


def _segment_file(
    file: ScanFile, reading: ReadOptions, options: dict[str, Any], picture_size: int | None
) -> _Result:
    from shapeconcepts.io.collection import iter_scans
    from shapeconcepts.report import draw_segments
    from shapeconcepts.scan import ScanError
    from shapeconcepts.segmentation import segment as segment_scan

    [scan] = iter_scans([file], **reading)
    if isinstance(scan, ScanError):
        return _Result(file.name, reason=str(scan))
    try:
        item = segment_scan(scan, **options)
    except ScanError as error:
        return _Result(file.name, reason=str(error))
    picture = None if picture_size is None else draw_segments(item, size=picture_size)
    return _Result(file.name, summary=_summary(item), picture=picture)


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


def _check_image_path(image: Path) -> None:
    """Complain before the work is done, not after."""
    from PIL import Image

    formats = Image.registered_extensions()
    if formats.get(image.suffix.lower()) not in Image.SAVE:
        raise typer.BadParameter(
            f"{image} must end in .png, .jpg or another picture format", param_hint="--image"
        )
    if not image.parent.is_dir():
        raise typer.BadParameter(f"the folder {image.parent} does not exist", param_hint="--image")


def _save_sheet(pictures: list[Image], path: Path) -> bool:
    """Whether the picture could be written; the user is told either way."""
    from PIL import Image

    from shapeconcepts.io.atomic_write import write_atomically
    from shapeconcepts.report import contact_sheet

    content = BytesIO()
    try:
        contact_sheet(pictures).save(content, Image.registered_extensions()[path.suffix.lower()])
        write_atomically(path, content.getvalue())
    except (OSError, ValueError) as error:  # some formats hold no picture of this size or kind
        say(f"Error: cannot write {path}: {getattr(error, 'strerror', None) or error}")
        return False
    say(f"Wrote {path}")
    return True
