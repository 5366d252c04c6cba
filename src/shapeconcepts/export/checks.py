"""What can be said against an export before anything is written."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path

from shapeconcepts.export.training_scans import TrainingScans
from shapeconcepts.io.atomic_write import check_replaceable
from shapeconcepts.io.whole_folder import check_free


def check_packages(layout: str, rerun: bool) -> None:
    """Raise ModuleNotFoundError where a package that is needed is not installed."""
    for needed, module, package, extra in (
        (layout == "parquet", "pyarrow", "pyarrow", "parquet"),
        (rerun, "rerun", "rerun-sdk", "rerun"),
    ):
        if needed and find_spec(module) is None:
            title = "the layout parquet" if extra == "parquet" else "a recording for Rerun"
            raise ModuleNotFoundError(
                f"{title} needs the package {package}, which is not installed: "
                f'pip install "shapeconcepts[{extra}]"'
            )


def check_places(
    place: Path | None, recording: Path | None, layout: str, is_folder: bool, force: bool
) -> None:
    """Raise where nothing can be written, or something is there already."""
    if place is not None and is_folder:
        check_free(place, replace=force)
    elif place is not None:
        if place.is_dir():
            raise IsADirectoryError(f"{place}: is a folder, the layout {layout} is a file")
        if not place.parent.is_dir():
            raise NotADirectoryError(f"the folder {place.parent} does not exist")
        if not force and place.exists():
            raise FileExistsError(f"{place}: is there already")
        check_replaceable(place)
    if recording is None:
        return
    if recording.is_dir() or not recording.parent.is_dir():
        raise IsADirectoryError(f"{recording}: must be a file in a folder that exists")
    check_replaceable(recording)
    if place is not None and (recording == place or place in recording.parents):
        raise ValueError(f"rerun must lie outside of out, got {recording} and {place}")


def check_sources(place: Path | None, found: TrainingScans, force: bool) -> None:
    """Raise where what is to be replaced is needed."""
    if place is None or not force or not place.exists():
        return
    here = Path.cwd()
    if here == place or place in here.parents:
        raise ValueError(f"out must not be the folder that one is in, got {place}")
    for path in found.paths:
        source = Path(os.path.realpath(path))
        if source == place or place in source.parents:
            raise ValueError(f"out must not hold the scans, got {place} and {source}")
