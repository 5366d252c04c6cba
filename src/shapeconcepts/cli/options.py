"""Options and arguments that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from shapeconcepts.cli.terminal import fail

if TYPE_CHECKING:
    from sklearn.base import BaseEstimator

    from shapeconcepts.sources.collection import ScanFile
    from shapeconcepts.sources.reader import ReadOptions

Intrinsics = Annotated[
    str | None,
    typer.Option(
        metavar="FX,FY,CX,CY",
        help="Of depth images: focal lengths and principal point in pixels.",
        show_default="a Kinect's, for 640 x 480 pixels",
    ),
]
DepthScale = Annotated[
    float | None,
    typer.Option(
        metavar="METRES",
        help="Of depth images: metres per unit of depth.",
        show_default="0.001 for whole numbers, 1 for others",
    ),
]
Units = Annotated[
    str,
    typer.Option(
        metavar="UNIT",
        help="Of the coordinates in clouds and meshes: m, cm, mm, in, ft, or metres per unit, as a number; "
        "auto: millimetres where they can be nothing else, which is said, otherwise metres.",
    ),
]
Up = Annotated[
    Literal["x", "y", "z", "-x", "-y", "-z"] | None,
    typer.Option(
        help="Of meshes: the axis that points upwards.", show_default="z; of .glb y, as the format says"
    ),
]
LearnedScans = Annotated[
    list[Path] | None,
    typer.Option(
        "--scans",
        metavar="DATA",
        show_default=False,
        help="Where the scans are that the model was learned from, as given to `learn`. May be given several "
        "times. Without it there are tables, but no pictures and no data sets that hold the scans.",
    ),
]
Mask = Annotated[
    Path | None,
    typer.Option(
        exists=True,
        help="Of depth images: an image that is not 0 where the object is, or a folder with one for each "
        "depth image, of the same name and in a sub-folder of the same name.",
    ),
]


VoxelSize = Annotated[
    float | None,
    typer.Option(
        metavar="METRES",
        help="Edge length of the voxels that points are merged into; by default it suits each scan.",
        show_default="auto",
    ),
]
Views = Annotated[
    int | None,
    typer.Option(
        min=1,
        metavar="N",
        help="Scan each mesh with the simulated sensor from N sides spread over the sphere around it. By "
        "default it is scanned from one. Other files stay single scans.",
        show_default=False,
    ),
]
Scenes = Annotated[
    bool | None,
    typer.Option(
        "--scenes/--no-scenes",
        help="Whether point clouds are scenes of several objects, which the field `label` tells apart: 1 to "
        "9 the table, 20 to 29 the first object, 30 to 39 the second, and so on. Objects are labelled by "
        "the folder that the scene is in, or, as in the data set, by a name like learn33.",
        show_default="where the labels look like that",
    ),
]
Extract = Annotated[
    bool,
    typer.Option(
        "--extract",
        help="Files are scenes: what stands on a table, a board or the floor in them is found, and each "
        "object is a scan, as by the command `extract`.",
    ),
]
Jobs = Annotated[
    int,
    typer.Option(
        "--jobs",
        "--n-jobs",
        metavar="N",
        help="Scans worked on at a time; -1 for as many as there are cores. It changes no result.",
    ),
]
Strict = Annotated[
    bool,
    typer.Option("--strict", help="Stop at the first scan that cannot be used, instead of skipping it."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document instead of text.")]
ModelFile = Annotated[
    Path,
    typer.Argument(metavar="MODEL", show_default=False, help="Model file that `learn` has written."),
]


Granularity = Annotated[
    float | None,
    typer.Option(
        metavar="SHARE",
        help="Two groups of scans are two concepts if they have on average less than this in common, from 0 "
        "(coarse) to 1 (fine).",
        show_default=False,
    ),
]


def check_jobs(jobs: int) -> None:
    """Complain about a number of jobs that means nothing."""
    if jobs == 0:
        raise typer.BadParameter("must not be 0", param_hint="--jobs")


def set_from_options(stage: BaseEstimator, options: dict[str, tuple[str, object]]) -> None:
    """Set parameters that the user gave; complains about the first option that is out of its range.

    Parameters
    ----------
    stage : estimator
    options : dict of str to (str, value)
        Parameter and value of each option; None where it was not given.
    """
    from shapeconcepts.parameters import check_parameters

    for option, (parameter, value) in options.items():
        if value is None:
            continue
        try:
            check_parameters(stage.set_params(**{parameter: value}))
        except ValueError as error:
            raise typer.BadParameter(str(error), param_hint=option) from None


def read_options(
    intrinsics: str | None,
    depth_scale: float | None,
    mask: Path | None,
    units: str,
    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None,
) -> ReadOptions:
    """Options for reading scans, checked."""
    if intrinsics is None and depth_scale is None and units == "auto":
        # Nothing to check: what takes its time to import is not waited for.
        return {"intrinsics": None, "depth_scale": None, "mask": mask, "units": "auto", "up": up}
    from shapeconcepts.io.depth_image import check_camera
    from shapeconcepts.sources.frame import METRES_PER_UNIT, metres_per_unit

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
    try:
        is_named = units == "auto" or units in METRES_PER_UNIT
        scale = metres_per_unit(units if is_named else float(units))
    except ValueError:
        raise typer.BadParameter(
            f"must be auto, {', '.join(METRES_PER_UNIT)} or metres per unit, > 0, got {units!r}",
            param_hint="--units",
        ) from None
    unit = "auto" if scale is None else scale
    return {"intrinsics": camera, "depth_scale": depth_scale, "mask": mask, "units": unit, "up": up}


def scan_files(paths: list[Path], mask: Path | None) -> list[ScanFile]:
    """Files among and below the paths; ends the command where there is nothing to read."""
    from shapeconcepts.io.depth_image import DEPTH_SUFFIXES
    from shapeconcepts.scan import ScanError
    from shapeconcepts.sources.collection import find_scan_files

    try:
        files = find_scan_files(paths)
    except ScanError as error:
        fail(str(error))
    suffixes = (*DEPTH_SUFFIXES, ".npy")
    if mask is not None and not any(file.path.suffix.lower() in suffixes for file in files):
        raise typer.BadParameter(
            f"is for depth images ({' '.join(suffixes)}), got {mask}, but there is none among the scans",
            param_hint="--mask",
        )
    return files
