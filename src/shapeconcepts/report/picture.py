"""Pictures of segmented objects."""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil, sqrt
from os import PathLike

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter

from shapeconcepts.report.camera import view_axes
from shapeconcepts.report.lettering import NOTE_COLOUR, TITLE_COLOUR, font_of, shorten
from shapeconcepts.report.palette import SEGMENT_COLOURS, colours_of
from shapeconcepts.report.splatting import Splats, splat
from shapeconcepts.segmentation.segmented_object import SegmentedObject

_SUPERSAMPLING = 2
_MARGIN = 0.05
_CAPTION_HEIGHT = 0.13
_AMBIENT = 0.6
_PIXELS_PER_VOXEL = 5
_OUTLINE_COVERAGE = 0.25


def draw_segments(
    objects: SegmentedObject | Iterable[SegmentedObject],
    path: str | PathLike[str] | None = None,
    *,
    columns: int | None = None,
    size: int = 480,
) -> Image.Image:
    """Draw objects with a colour for each segment, as the sensor saw them.

    Parameters
    ----------
    objects : SegmentedObject or iterable of SegmentedObject
        Several make a contact sheet, row by row.
    path : path, optional
        Where to save the picture; the ending chooses the format (`.png`, `.jpg`, `.webp`).
    columns : int, optional
        Pictures in a row. By default the sheet is a little wider than high.
    size : int
        Width of the picture of one object, pixels.

    Returns
    -------
    PIL.Image.Image
        RGB picture on white.

    Raises
    ------
    ValueError
        If there is nothing to draw, or `columns` or `size` is too small.
    """
    if isinstance(objects, SegmentedObject):
        objects = [objects]
    picture = contact_sheet(
        [
            draw_points(
                item.points,
                item.normals,
                item.segment_labels,
                voxel_size=item.voxel_size,
                viewpoint=item.viewpoint,
                title=item.name,
                note="1 segment" if item.n_segments == 1 else f"{item.n_segments} segments",
                size=size,
            )
            for item in objects
        ],
        columns=columns,
    )
    if path is not None:
        picture.save(path)
    return picture


def draw_points(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    labels: NDArray[np.integer],
    *,
    voxel_size: float,
    viewpoint: NDArray[np.float64] | None = None,
    title: str = "",
    note: str = "",
    size: int = 480,
    colours: NDArray[np.uint8] = SEGMENT_COLOURS,
) -> Image.Image:
    """Draw labelled points with normals as a closed, shaded surface.

    Parameters
    ----------
    points, normals : (m, 3) float64
        Points in metres and their unit normals.
    labels : (m,) int
        One colour for each label from 0; negative is light grey.
    voxel_size : float
        Distance of neighbouring points, metres.
    viewpoint : (3,) float64, optional
        Where to look from (orthographic). By default against the mean normal.
    title, note : str
        Caption, dark and grey. It is shortened to the width of the picture.
    size : int
        Width of the picture, pixels; the caption makes it a little higher.
    colours : (k, 3) uint8
        Colours of the labels from 0.

    Raises
    ------
    ValueError
        If there are no points, `voxel_size` is not positive, or `size` is under 64 pixels.
    """
    if len(points) == 0:
        raise ValueError(f"{title or 'object'}: no points to draw")
    if not voxel_size > 0:
        raise ValueError(f"voxel_size must be positive, got {voxel_size!r}")
    if size < 64:
        raise ValueError(f"size must be at least 64 pixels, got {size!r}")
    axes = view_axes(points, normals, viewpoint)
    surface = _draw_surface(points @ axes.T, normals @ axes.T, labels, voxel_size, size, colours)

    caption_height = round(_CAPTION_HEIGHT * size) if title or note else 0
    picture = Image.new("RGB", (size, size + caption_height), "white")
    picture.paste(surface, (0, 0))
    _write_caption(picture, title, note, size)
    return picture


def contact_sheet(pictures: Iterable[Image.Image], *, columns: int | None = None) -> Image.Image:
    """Pictures side by side, row by row.

    Raises
    ------
    ValueError
        If there is no picture, or `columns` is not positive.
    """
    pictures = list(pictures)
    if not pictures:
        raise ValueError("no objects to draw")
    if columns is None:
        columns = ceil(sqrt(1.3 * len(pictures)))
    if columns < 1:
        raise ValueError(f"columns must be at least 1, got {columns!r}")
    columns = min(columns, len(pictures))
    width = max(picture.width for picture in pictures)
    height = max(picture.height for picture in pictures)
    sheet = Image.new("RGB", (columns * width, ceil(len(pictures) / columns) * height), "white")
    for index, picture in enumerate(pictures):
        row, column = divmod(index, columns)
        sheet.paste(picture, (column * width, row * height))
    return sheet


def _draw_surface(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    labels: NDArray[np.integer],
    voxel_size: float,
    size: int,
    palette: NDArray[np.uint8],
) -> Image.Image:
    """Square picture of points whose axes are right, up and towards the camera."""
    low, high = points.min(axis=0), points.max(axis=0)
    extent = max((high - low)[:2].max() + 2 * voxel_size, 6 * voxel_size) / (1 - 2 * _MARGIN)
    # The fields are as smooth as the discs: a coarse grid holds them, and borders come out sharp where the
    # fields are enlarged first and decided on (which label, covered or not) afterwards.
    fine = _SUPERSAMPLING * size
    grid = min(fine, ceil(_PIXELS_PER_VOXEL * extent / voxel_size))
    placed = (points - (low + high) / 2) * (grid / extent) * (1, -1, 1)
    placed[:, :2] += (grid - 1) / 2
    splats = splat(placed, normals * (1, -1, 1), labels, voxel_size * grid / extent, (grid, grid))

    colours = _shade(
        _enlarge_labels(splats, fine), np.stack([_enlarge(axis, fine) for axis in splats.normals]), palette
    )
    colours[_enlarge(splats.coverage, fine) < _OUTLINE_COVERAGE] = 255
    return Image.fromarray(colours).resize((size, size), Image.Resampling.BOX)


def _enlarge(field: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    return np.asarray(Image.fromarray(field).resize((size, size), Image.Resampling.BICUBIC))


def _enlarge_labels(splats: Splats, size: int) -> NDArray[np.int32]:
    labels = np.full((size, size), -1, dtype=np.int32)
    best = np.zeros((size, size), dtype=np.float32)
    for label, field in splats.votes.items():
        vote = _enlarge(field, size)
        wins = vote > best
        labels[wins] = label
        best[wins] = vote[wins]
    return labels


def _shade(
    labels: NDArray[np.int32], normals: NDArray[np.float32], palette: NDArray[np.uint8]
) -> NDArray[np.uint8]:
    """Colours under a light from the upper left, with white lines between segments."""
    x, y, z = normals / np.maximum(np.linalg.norm(normals, axis=0), np.float32(1e-6))
    lit = np.clip(-0.36 * x - 0.52 * y + 0.775 * z, 0, 1)[..., None]
    gloss = np.clip(-0.19 * x - 0.28 * y + 0.941 * z, 0, 1)[..., None] ** 40
    colours = colours_of(labels, palette).astype(np.float32) * (_AMBIENT + (1.06 - _AMBIENT) * lit)
    colours += (255 - colours) * (0.22 * gloss)
    colours[_borders(labels)] = 255
    return colours.clip(0, 255).round().astype(np.uint8)


def _borders(labels: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pixels near another label, as a line of a width that suits the size of the image."""
    border = np.zeros(labels.shape, dtype=bool)
    border[:-1] |= labels[:-1] != labels[1:]
    border[:, :-1] |= labels[:, :-1] != labels[:, 1:]
    width = 2 * ceil(len(labels) / 1000) + 1
    return np.asarray(Image.fromarray(border).convert("L").filter(ImageFilter.MaxFilter(width))) > 0


def _write_caption(picture: Image.Image, title: str, note: str, size: int) -> None:
    """Title and note, centred on one line below the picture."""
    font = font_of(max(10, round(0.042 * size)))
    draw = ImageDraw.Draw(picture)
    gap = "   " if title and note else ""
    title = shorten(title, font, 0.96 * size - draw.textlength(gap + note, font=font))
    title_width = draw.textlength(title + gap, font=font)
    left = (size - title_width - draw.textlength(note, font=font)) / 2
    middle = (size + picture.height) / 2
    draw.text((left, middle), title, fill=TITLE_COLOUR, font=font, anchor="lm")
    draw.text((left + title_width, middle), note, fill=NOTE_COLOUR, font=font, anchor="lm")
