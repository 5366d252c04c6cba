"""Pictures: what is drawn where, in which colour."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from shapeconcepts.report import contact_sheet, draw_points, draw_segments
from shapeconcepts.report.camera import view_axes
from shapeconcepts.report.lettering import font_of, shorten
from shapeconcepts.report.palette import NO_SEGMENT_COLOUR, SEGMENT_COLOURS, colours_of
from shapeconcepts.report.splatting import splat
from shapeconcepts.segmentation.segmented_object import SegmentedObject

VOXEL = 0.005
FRONT = np.array([0.0, 0.0, -1.0])  # normal of a surface that faces a camera at the origin looking along z

# Machado et al. 2009, full severity, on linear RGB.
PROTANOPIA = np.array(
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
)
DEUTERANOPIA = np.array(
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
)


def plane(n_columns: int, n_rows: int, depth: float = 1.0) -> np.ndarray:
    """Points on a grid that faces the camera, centred on its axis."""
    x, y = np.meshgrid(np.arange(n_columns) - (n_columns - 1) / 2, np.arange(n_rows) - (n_rows - 1) / 2)
    return np.stack([x.ravel() * VOXEL, y.ravel() * VOXEL, np.full(x.size, depth)], axis=1)


def segmented(points: np.ndarray, labels: np.ndarray, name: str = "object") -> SegmentedObject:
    return SegmentedObject(
        points=points,
        normals=np.tile(FRONT, (len(points), 1)),
        patch_labels=labels.astype(np.int32),
        segment_labels=labels.astype(np.int32),
        segment_edges=np.empty((0, 2), np.int32),
        n_segments=int(labels.max()) + 1,
        point_to_voxel=np.arange(len(points), dtype=np.int32),
        voxel_size=VOXEL,
        viewpoint=np.zeros(3),
        name=name,
    )


def nearest_colour(pixel: np.ndarray) -> int:
    """Label whose colour has the hue and saturation of a shaded pixel, -1 for the grey of no segment."""
    palette = np.vstack([SEGMENT_COLOURS, NO_SEGMENT_COLOUR]).astype(float)
    directions = palette / np.linalg.norm(palette, axis=1, keepdims=True)
    index = int(np.argmax(directions @ (pixel / np.linalg.norm(pixel))))
    return -1 if index == len(SEGMENT_COLOURS) else index


def test_segments_have_their_colours_at_their_places(tmp_path: Path) -> None:
    points = plane(40, 40)
    labels = np.select([points[:, 0] < -0.034, points[:, 0] < 0.034], [0, 1], -1)
    path = tmp_path / "plane.png"
    picture = draw_segments(segmented(points, labels), path, size=200)
    pixels = np.asarray(picture, dtype=float)
    assert picture.size[0] == 200
    assert picture.size[1] > 200  # the caption
    assert [nearest_colour(pixels[100, column]) for column in (25, 100, 175)] == [0, 1, -1]
    np.testing.assert_array_equal(pixels[3, 3], 255)
    assert pixels[205:, :].min() < 120  # something is written
    np.testing.assert_array_equal(np.asarray(Image.open(path)), np.asarray(picture))


def test_y_down_of_the_camera_frame_is_down_in_the_picture() -> None:
    points = plane(40, 40)
    labels = (points[:, 1] > 0).astype(int)
    pixels = np.asarray(draw_segments(segmented(points, labels), size=200), dtype=float)
    assert nearest_colour(pixels[50, 100]) == 0
    assert nearest_colour(pixels[150, 100]) == 1


@pytest.mark.parametrize("size", [64, 150, 400])
@pytest.mark.parametrize("n_columns", [8, 40, 200])
def test_a_surface_is_closed_at_any_scale(size: int, n_columns: int) -> None:
    points = plane(n_columns, n_columns)
    points += np.random.default_rng(0).normal(0, 0.15 * VOXEL, points.shape)
    pixels = np.asarray(draw_segments(segmented(points, np.zeros(len(points), int)), size=size))
    inner = pixels[size // 4 : 3 * size // 4, size // 4 : 3 * size // 4].reshape(-1, 3)
    assert inner.min(axis=1).max() < 150, "white pixels within the surface"


def test_the_nearer_surface_hides_the_farther_one() -> None:
    near, far = plane(16, 16, depth=0.9), plane(40, 40, depth=1.0)
    labels = np.repeat([0, 1], [len(near), len(far)])
    for order in (slice(None), slice(None, None, -1)):
        item = segmented(np.vstack([near, far])[order], labels[order])
        pixels = np.asarray(draw_segments(item, size=200), dtype=float)
        assert nearest_colour(pixels[100, 100]) == 0
        assert nearest_colour(pixels[100, 30]) == 1


def test_the_order_of_points_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    points = plane(30, 30) + rng.normal(0, 0.001, (900, 3))
    labels = (points[:, 0] > 0.01).astype(int)
    shuffled = rng.permutation(len(points))
    one = np.asarray(draw_segments(segmented(points, labels), size=120), dtype=int)
    other = np.asarray(draw_segments(segmented(points[shuffled], labels[shuffled]), size=120), dtype=int)
    assert np.abs(one - other).max() <= 1


def test_light_makes_the_shape_visible() -> None:
    towards_light = np.array([-0.36, -0.52, -0.775])
    points = plane(20, 20)
    labels = np.zeros(len(points), int)

    def brightness(normal: np.ndarray) -> float:
        picture = draw_points(
            points,
            np.tile(normal, (len(points), 1)),
            labels,
            voxel_size=VOXEL,
            viewpoint=np.zeros(3),
            size=64,
        )
        return float(np.asarray(picture)[32, 32].sum())

    assert brightness(towards_light) > brightness(FRONT) > brightness(towards_light * (-1, -1, 1))


@pytest.mark.parametrize("n_points", [1, 2])
def test_very_few_points_are_drawn(n_points: int) -> None:
    points = plane(n_points, 1)
    pixels = np.asarray(draw_segments(segmented(points, np.zeros(n_points, int)), size=100))
    assert (pixels[:100].min(axis=2) < 150).sum() > 50


def test_contact_sheet_holds_every_object_in_order() -> None:
    points = plane(12, 12)
    objects = [segmented(points, np.full(len(points), label)) for label in range(5)]
    sheet = np.asarray(draw_segments(iter(objects), columns=2, size=80), dtype=float)
    height = sheet.shape[0] // 3
    assert sheet.shape[1] == 160
    drawn = [
        nearest_colour(sheet[row * height + 40, column * 80 + 40]) for row in range(3) for column in range(2)
    ]
    assert drawn[:5] == [0, 1, 2, 3, 4]
    np.testing.assert_array_equal(sheet[2 * height :, 80:], 255)


def test_a_long_name_is_shortened_from_the_front() -> None:
    points = plane(10, 10)
    labels = np.zeros(len(points), int)
    long = draw_segments(segmented(points, labels, name="folder/" * 40 + "mug.pcd"), size=200)
    pixels = np.asarray(long)
    assert pixels[200:, :2].min() == 255
    assert pixels[200:, -2:].min() == 255


def test_long_text_keeps_its_end_and_fits() -> None:
    font = font_of(13)
    for text in ("short", "x" * 300 + "end", "line\nbreak" * 40, "", "漢字" * 100, "long" * 10_000):
        short = shorten(text, font, 120)
        assert font.getlength(short) <= 120
        assert "\n" not in short
        assert text.replace("\n", " ").endswith(short.lstrip("…"))
    assert shorten("short", font, 120) == "short"
    assert shorten("x" * 300 + "end", font, 120).endswith("end")


def test_unknown_viewpoint_looks_against_the_mean_normal() -> None:
    normals = np.tile([1.0, 0.0, 0.0], (100, 1))
    axes = view_axes(np.zeros((100, 3)), normals, None)
    np.testing.assert_allclose(axes, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-12)


@pytest.mark.parametrize("towards", [(0, 0, 1), (0, 0, -1), (0, 1, 0), (1, 2, 3), (0, 0, 0)])
def test_view_axes_are_a_right_handed_frame(towards: tuple[float, float, float]) -> None:
    for viewpoint in (None, np.zeros(3), np.array(towards, float)):
        points = -np.array(towards, float) + np.zeros((4, 3))
        axes = view_axes(points, np.tile(np.array(towards, float), (4, 1)), viewpoint)
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) == pytest.approx(1)


def test_splats_agree_with_a_slow_rasteriser() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform(8, 24, (25, 3))
    normals = rng.normal((0, 0, 3), 1, (25, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[:, 2] = np.maximum(normals[:, 2], 0.45)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    labels = rng.integers(-1, 2, 25)
    spacing, size = 3.0, (30, 32)

    coverage = np.zeros(size)
    votes = {label: np.zeros(size) for label in (-1, 0, 1)}
    for row in range(size[0]):
        for column in range(size[1]):
            discs = []
            for (x, y, depth), normal, label in zip(points, normals, labels, strict=True):
                dx, dy = column - x, row - y
                dz = -(normal[0] * dx + normal[1] * dy) / normal[2]
                discs.append((np.sqrt(dx**2 + dy**2 + dz**2) / spacing, depth + dz, label))
            discs = [disc for disc in discs if disc[0] < 1.7]
            front = max((depth for _, depth, _ in discs), default=-np.inf)
            in_front = {label: 0.0 for label in votes}
            behind = {label: 0.0 for label in votes}
            for radius, depth, label in discs:
                layer = behind if depth < front - 2 * spacing else in_front
                layer[label] += np.exp(-(radius**2) / (2 * 0.75**2)) / (2 * np.pi * 0.75**2)
            coverage[row, column] = sum(in_front.values()) + sum(behind.values())
            transparency = max(0, 1 - 2 * sum(in_front.values()))
            for label, vote in votes.items():
                vote[row, column] = in_front[label] + transparency * behind[label]

    splats = splat(points, normals, labels, spacing, size)
    np.testing.assert_allclose(splats.coverage, coverage, atol=1e-5)
    for label, vote in votes.items():
        np.testing.assert_allclose(splats.votes[label], vote, atol=1e-5)
    assert (coverage > 1).any()


def test_colours_differ_for_colour_blind_readers_too() -> None:
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    coded = SEGMENT_COLOURS / 255.0
    linear = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    for vision in (np.eye(3), PROTANOPIA, DEUTERANOPIA):
        xyz = np.clip(linear @ vision.T, 0, 1) @ to_xyz.T / (0.9505, 1.0, 1.089)
        f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
        lab = np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)
        distances = np.linalg.norm(lab[:, None] - lab, axis=2)[np.triu_indices(len(lab), 1)]
        assert distances.min() > 25
    assert len(SEGMENT_COLOURS) >= 12


def test_colours_repeat_and_negative_is_grey() -> None:
    colours = colours_of(np.array([-1, 0, 12, -7]))
    np.testing.assert_array_equal(colours[[0, 3]], [NO_SEGMENT_COLOUR] * 2)
    np.testing.assert_array_equal(colours[1], colours[2])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"voxel_size": 0.0}, "voxel_size must be positive, got 0.0"),
        ({"size": 10}, "size must be at least 64 pixels, got 10"),
        ({"points": np.empty((0, 3)), "title": "mug"}, "mug: no points to draw"),
    ],
)
def test_bad_parameters_are_named(change: dict, message: str) -> None:
    points = plane(3, 3)
    arguments = {
        "points": points,
        "normals": np.tile(FRONT, (9, 1)),
        "labels": np.zeros(9, int),
        "voxel_size": VOXEL,
    }
    with pytest.raises(ValueError, match=message):
        draw_points(**{**arguments, **change})


def test_a_sheet_needs_pictures_and_columns() -> None:
    with pytest.raises(ValueError, match="no objects to draw"):
        draw_segments([])
    with pytest.raises(ValueError, match="columns must be at least 1, got 0"):
        contact_sheet([Image.new("RGB", (4, 4))], columns=0)
