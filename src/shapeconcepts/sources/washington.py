"""Washington RGB-D Object Dataset: 300 household objects on a turntable (Lai et al., ICRA 2011).

https://rgbd-dataset.cs.washington.edu
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from shapeconcepts.io.depth_image import png_depth_size
from shapeconcepts.io.regular_file import read_regular_file
from shapeconcepts.parameters import check_integer
from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.sources.collection import ScanList, collect, existing_folder, scan_paths
from shapeconcepts.sources.reader import read_scan

# Categories of the data set that the paper uses, and their shape (paper, table of the data sets).
PAPER_CATEGORIES = {
    "food_bag": "sack",
    "food_can": "can",
    "soda_can": "can",
    "cereal_box": "box",
    "food_box": "box",
    "ball": "ball",
    "lime": "ball",
    "orange": "ball",
    "plate": "plate",
}

# Camera of the data set's own depthToCloud.m, pixels.
_FOCAL_LENGTH = 570.3
_CENTER = (320, 240)
_IMAGE_SIZE = (640, 480)

_DEPTH_CROP = "_depthcrop.png"
_FILE_NAME = re.compile(r"([A-Za-z]+(?:_[A-Za-z]+)*)_(\d{1,9})_(\d{1,9})_(\d{1,9})(?:\.pcd|_depthcrop\.png)")
_CORNER = re.compile(r"\s*(\d{1,4})\s*[,\s]\s*(\d{1,4})\s*")


class _Frame(NamedTuple):
    """What the name of a scan says; sorted as the data set counts."""

    category: str
    instance: int
    video: int
    number: int


def load_washington(
    folder: str | PathLike[str],
    scans_per_instance: int = 5,
    video: int = 1,
    categories: Sequence[str] | None = None,
) -> ScanList:
    """Read the first scans of each object in a video sequence.

    Files are recognised by their name anywhere below the folder. ``food_can_14_1_5.pcd`` is the fifth frame
    of the first video of the 14th food can; ``food_can_14_1_5_depthcrop.png`` is the same as a depth image,
    and needs ``…_maskcrop.png`` and ``…_loc.txt`` beside it. Where there are both, the point cloud counts.

    Parameters
    ----------
    folder : path
        Where the archives of ``rgbd-dataset_pcd_ascii`` or ``rgbd-dataset`` were unpacked, so that the folder
        or one below it holds ``food_can/food_can_14/food_can_14_1_5.pcd``.
    scans_per_instance : int
        How many scans of each object, by rising frame number; an object with fewer gives all it has.
    video : int
        Number of the video sequence; the data set has 1, 2 and 4, at 30°, 45° and 60°.
    categories : sequence of str, optional
        Categories of the data set to read, such as `PAPER_CATEGORIES`. By default all.

    Returns
    -------
    ScanList
        By category, instance and frame. `name` is like "food_can_14_1_5", `instance` "food_can_14", `label`
        the shape in `PAPER_CATEGORIES`, or the category itself where the paper does not use it. `viewpoint`
        is the camera, (0, 0, 0). A damaged scan is left out and not replaced by the next; that, an object
        without a scan in the video, and a missing category are listed in `skipped`.

    Raises
    ------
    ScanError
        If there is no scan that can be read.
    ValueError
        If a parameter is out of range.
    """
    check_integer("scans_per_instance", scans_per_instance, 1)
    check_integer("video", video, 1)
    if isinstance(categories, str) or (categories is not None and not len(categories)):
        raise ValueError(f"categories must be one name or more, such as ['ball'], got {categories!r}")
    folder = existing_folder(folder)
    unlisted: list[tuple[Path, str]] = []
    frames = _find_frames(folder, unlisted)
    if not frames:
        raise ScanError(
            f"{folder}: holds no scan of the Washington RGB-D Object Dataset, that is no file like "
            f"apple_1_1_1.pcd or apple_1_1_1{_DEPTH_CROP}"
        )
    failures = [ScanError(f"{path}: {reason}") for path, reason in unlisted]
    return collect([*failures, *_scans(folder, frames, scans_per_instance, video, categories)])


def is_washington(folder: Path) -> bool:
    """Whether a file below a folder is named and placed like ``apple_1/apple_1_1_1.pcd``."""
    for path in scan_paths(folder, []):
        match = _FILE_NAME.fullmatch(path.name)
        if match is not None and path.parent.name == f"{match[1]}_{match[2]}":
            return True
    return False


def _find_frames(folder: Path, unlisted: list[tuple[Path, str]]) -> dict[_Frame, Path]:
    matches = [(path, _FILE_NAME.fullmatch(path.name)) for path in scan_paths(folder, unlisted)]
    frames: dict[_Frame, Path] = {}
    # Point clouds first, and of two equal names always the same.
    for path, match in sorted(matches, key=lambda found: (found[0].suffix != ".pcd", found[0])):
        if match is not None:
            frame = _Frame(match[1], int(match[2]), int(match[3]), int(match[4]))
            frames.setdefault(frame, path)
    return frames


def _scans(
    folder: Path,
    frames: dict[_Frame, Path],
    scans_per_instance: int,
    video: int,
    categories: Sequence[str] | None,
) -> Iterator[Scan | ScanError]:
    found = {frame.category for frame in frames}
    wanted = found if categories is None else set(categories)
    for category in sorted(wanted - found):
        yield ScanError(f"{folder}: holds no scan of the category {category}")
    chosen = sorted(frame for frame in frames if frame.category in wanted)
    for (category, instance), of_instance in groupby(chosen, key=lambda frame: frame[:2]):
        in_video = [frame for frame in of_instance if frame.video == video]
        if not in_video:
            yield ScanError(f"{folder}: {category}_{instance} has no scan in video {video}")
        for frame in in_video[:scans_per_instance]:
            try:
                yield _read(frame, frames[frame])
            except ScanError as error:
                yield error


def _read(frame: _Frame, path: Path) -> Scan:
    scan = read_scan(path, viewpoint=(0.0, 0.0, 0.0)) if path.suffix == ".pcd" else _read_depth_crop(path)
    instance = f"{frame.category}_{frame.instance}"
    return replace(
        scan,
        name=f"{instance}_{frame.video}_{frame.number}",
        label=PAPER_CATEGORIES.get(frame.category, frame.category),
        instance=instance,
    )


def _read_depth_crop(path: Path) -> Scan:
    stem = path.name.removesuffix(_DEPTH_CROP)
    location, mask = path.with_name(f"{stem}_loc.txt"), path.with_name(f"{stem}_maskcrop.png")
    corner = _read_corner(location)
    if not os.path.exists(mask):
        raise ScanError(f"{path}: has no mask {mask.name} beside it")
    # depthToCloud.m counts pixels from 1, in the crop and in the image, so the first one is at the corner.
    center = (_CENTER[0] - corner[0], _CENTER[1] - corner[1])
    scan = read_scan(path, intrinsics=(_FOCAL_LENGTH, _FOCAL_LENGTH, *center), mask=mask)
    crop_size = png_depth_size(read_regular_file(path))
    for first, length, limit in zip(corner, crop_size, _IMAGE_SIZE, strict=True):
        if first + length - 1 > limit:
            raise ScanError(
                f"{location}: a crop of {crop_size[0]} x {crop_size[1]} pixels at {corner[0]},{corner[1]} "
                f"reaches beyond the image of {_IMAGE_SIZE[0]} x {_IMAGE_SIZE[1]}"
            )
    return scan


def _read_corner(path: Path) -> tuple[int, int]:
    """Column and row, from 1, of the pixel of the whole image that comes first in a crop."""
    try:
        text = read_regular_file(path)[:64].decode("utf-8", "replace")
    except ScanError as error:
        raise ScanError(f"{path}: {error}, so the place of the crop in the image is unknown") from None
    match = _CORNER.fullmatch(text)
    if match is None:
        raise ScanError(f"{path}: must hold column and row of the crop's corner, like 281,209, got {text!r}")
    return int(match[1]), int(match[2])
