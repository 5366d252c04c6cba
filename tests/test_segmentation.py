"""Segmentation of whole scans: analytic shapes, invariants, degenerate clouds, parameters."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial.transform import Rotation

from shapeconcepts import Scan, ScanError, segment
from shapeconcepts.preparation import prepare

POSE = Rotation.from_euler("xyz", [20, -35, 50], degrees=True).as_matrix()
SPACING = 0.002


def grid(width: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    a, b = np.meshgrid(np.arange(SPACING / 2, width, SPACING), np.arange(SPACING / 2, height, SPACING))
    return a.ravel(), b.ravel()


def measure(points: np.ndarray, viewpoint, seed: int = 0, noise: float = 5e-4, name: str = "shape") -> Scan:
    """The points in some pose, with noise along the rays."""
    rng = np.random.default_rng(seed)
    rays = points - viewpoint
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    noisy = points + rng.normal(0, noise, (len(points), 1)) * rays
    return Scan(noisy @ POSE.T + [0.1, -0.2, 0.9], POSE @ viewpoint + [0.1, -0.2, 0.9], name=name)


def box_corner(a: float = 0.14, b: float = 0.11, c: float = 0.09) -> Scan:
    x, y = grid(a, b)
    u, z = grid(a, c)
    v, w = grid(b, c)
    faces = [
        np.column_stack([x, y, np.zeros_like(x)]),
        np.column_stack([u, np.zeros_like(u), z]),
        np.column_stack([np.zeros_like(v), v, w]),
    ]
    return measure(np.vstack(faces), np.array([-0.5, -0.55, -0.6]))


def can(radius: float = 0.05, height: float = 0.14) -> Scan:
    turn, z = np.meshgrid(np.arange(-1.2, 1.2, SPACING / radius), np.arange(0, height, SPACING))
    side = np.column_stack([radius * np.cos(turn.ravel()), radius * np.sin(turn.ravel()), z.ravel()])
    x, y = grid(2 * radius, 2 * radius)
    inside = np.hypot(x - radius, y - radius) < radius
    cap = np.column_stack([x[inside] - radius, y[inside] - radius, np.full(inside.sum(), height)])
    return measure(np.vstack([side, cap]), np.array([0.7, 0.0, 0.7]))


def half_ball(radius: float = 0.06, centre=(0.0, 0.0, 0.0)) -> np.ndarray:
    n = int(4 * np.pi * (radius / SPACING) ** 2)
    z = 1 - (2 * np.arange(n) + 1) / n
    turn = np.arange(n) * np.pi * (3 - np.sqrt(5))
    points = np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])
    return radius * points[z > 0.15] + centre


def ball() -> Scan:
    return measure(half_ball(), np.array([0.0, 0.0, 0.8]))


def two_balls() -> Scan:
    return measure(np.vstack([half_ball(0.06), half_ball(0.045, (0.2, 0, 0))]), np.array([0.1, 0.0, 0.8]))


def crumpled(n_folds: int = 17, width: float = 0.04) -> Scan:
    """A folded sheet: strips of rising length that meet at right angles."""
    strips = []
    for k in range(n_folds):
        s, y = grid(width, 0.1 + 0.004 * k)
        lift = s if k % 2 == 0 else width - s
        strips.append(np.column_stack([(k * width + s) / np.sqrt(2), y, lift / np.sqrt(2)]))
    return measure(np.vstack(strips), np.array([0.2, 0.05, 2.0]))


def segment_of_points(scan: Scan, **options) -> np.ndarray:
    obj = segment(scan, **options)
    return np.append(obj.segment_labels, -1)[obj.point_to_voxel]


def assert_sound(obj, scan: Scan) -> None:
    m = len(obj.points)
    assert m >= 1 and obj.points.shape == obj.normals.shape == (m, 3)
    assert obj.points.dtype == obj.normals.dtype == np.float64
    assert obj.patch_labels.shape == obj.segment_labels.shape == (m,)
    assert obj.patch_labels.dtype == obj.segment_labels.dtype == obj.point_to_voxel.dtype == np.int32
    assert obj.point_to_voxel.shape == (len(scan),)
    assert obj.point_to_voxel.min() >= -1 and obj.point_to_voxel.max() == m - 1
    assert np.isfinite(obj.points).all()
    np.testing.assert_allclose(np.linalg.norm(obj.normals, axis=1), 1.0, atol=1e-12)
    if scan.viewpoint is None:
        assert obj.viewpoint is None
    else:
        assert (np.einsum("ij,ij->i", obj.normals, scan.viewpoint - obj.points) >= 0).all()

    assert isinstance(obj.n_segments, int) and 1 <= obj.n_segments <= 12
    members = obj.segment_labels[obj.segment_labels >= 0]
    assert obj.segment_labels.min() >= -1
    sizes = np.bincount(members, minlength=obj.n_segments)
    assert len(sizes) == obj.n_segments and (sizes > 0).all() and (np.diff(sizes) <= 0).all()

    edges = obj.segment_edges
    assert edges.dtype == np.int32 and edges.ndim == 2 and edges.shape[1] == 2
    pairs = [tuple(edge) for edge in edges.tolist()]
    assert pairs == sorted(set(pairs))
    assert all(0 <= a < b < obj.n_segments for a, b in pairs)

    assert obj.patch_labels.min() >= -1
    assert (obj.patch_labels[obj.segment_labels < 0] == -1).all()
    in_patch = obj.patch_labels >= 0
    homes = set(zip(obj.patch_labels[in_patch].tolist(), obj.segment_labels[in_patch].tolist(), strict=True))
    assert len(homes) == len({patch for patch, _ in homes})
    assert (obj.name, obj.label) == (scan.name, scan.label)


@pytest.mark.parametrize(
    ("make", "n_segments", "edges"),
    [
        (box_corner, 3, [[0, 1], [0, 2], [1, 2]]),
        (can, 2, [[0, 1]]),
        (ball, 1, []),
        (two_balls, 2, []),
    ],
)
def test_analytic_shapes(make, n_segments, edges):
    scan = make()
    obj = segment(scan)
    assert_sound(obj, scan)
    assert obj.n_segments == n_segments
    assert obj.segment_edges.tolist() == edges
    assert (obj.segment_labels >= 0).mean() > 0.98


@pytest.mark.parametrize("unit", [0.7, 1.5, 2.5])
def test_box_sizes(unit):
    scan = box_corner(unit * 0.14, unit * 0.11, unit * 0.09)
    assert segment(scan).n_segments == 3


def test_box_borders_lie_on_the_edges():
    points = box_corner()
    labels = segment_of_points(points)
    flat = (points.points - [0.1, -0.2, 0.9]) @ POSE
    truth = np.argmin(np.abs(flat[:, [2, 1, 0]]), axis=1)
    kept = labels >= 0
    votes = np.zeros((3, 3))
    np.add.at(votes, (truth[kept], labels[kept]), 1)
    assert sorted(votes.argmax(axis=1)) == [0, 1, 2]
    assert votes.max(axis=1).sum() > 0.96 * kept.sum()


def test_patches_are_smaller_than_segments_and_follow_seed_size():
    scan = ball()
    fine, coarse = segment(scan), segment(scan, seed_size=0.05)
    assert fine.patch_labels.max() + 1 > 2 * (coarse.patch_labels.max() + 1) > 2
    size = np.bincount(fine.patch_labels[fine.patch_labels >= 0])
    assert np.median(size[size > 0]) == pytest.approx((0.02 / fine.voxel_size) ** 2, rel=0.6)


@pytest.mark.parametrize("max_segments", [1, 2, 3, 7, 12])
def test_max_segments(max_segments):
    scan = crumpled()
    obj = segment(scan, max_segments=max_segments)
    assert_sound(obj, scan)
    assert obj.n_segments == max_segments
    assert (obj.segment_labels >= 0).mean() > 0.98


def test_folds_are_as_many_as_there_are():
    assert segment(crumpled(9)).n_segments == 9


def test_one_segment_of_two_balls_drops_the_smaller():
    scan = two_balls()
    labels = segment_of_points(scan, max_segments=1)
    first = np.arange(len(scan)) < len(half_ball(0.06))
    np.testing.assert_array_equal(labels[first], 0)
    np.testing.assert_array_equal(labels[~first], -1)
    obj = segment(scan, max_segments=1)
    assert obj.n_segments == 1 and (obj.patch_labels[obj.segment_labels < 0] == -1).all()


def test_small_part_apart_from_the_object_is_in_no_segment():
    body = half_ball(0.06)
    crumb = half_ball(0.012, (0.15, 0, 0))
    assert 0.01 < len(crumb) / len(body) < 0.05
    labels = segment_of_points(measure(np.vstack([body, crumb]), np.array([0.0, 0.0, 0.8])))
    np.testing.assert_array_equal(labels[: len(body)], 0)
    np.testing.assert_array_equal(labels[len(body) :], -1)


def test_prepared_object_gives_the_same():
    scan = box_corner()
    whole, staged = segment(scan), segment(prepare(scan))
    for field in dataclasses.fields(whole):
        np.testing.assert_array_equal(getattr(whole, field.name), getattr(staged, field.name))


def test_given_leaf_is_used():
    scan = box_corner()
    obj = segment(scan, voxel_size=0.008)
    assert obj.voxel_size == 0.008 and obj.n_segments == 3


def test_unknown_viewpoint():
    known = box_corner()
    scan = Scan(known.points)
    obj = segment(scan)
    assert_sound(obj, scan)
    assert obj.n_segments == 3


def test_large_units_do_not_matter():
    scan = box_corner()
    for unit in (10.0, 1e3, 1e6):
        scaled = Scan(unit * scan.points, unit * scan.viewpoint)
        obj = segment(scaled)
        assert_sound(obj, scaled)
        assert obj.n_segments == 3


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 1500),
    st.sampled_from(["normal", "uniform", "sphere", "plane", "line", "clusters", "sheets"]),
    st.floats(-4, 4),
    st.booleans(),
)
def test_random_clouds(seed, n, kind, exponent, has_viewpoint):
    rng = np.random.default_rng(seed)
    points = {
        "normal": lambda: rng.normal(size=(n, 3)),
        "uniform": lambda: rng.uniform(-1, 1, (n, 3)),
        "sphere": lambda: (p := rng.normal(size=(n, 3))) / np.linalg.norm(p, axis=1, keepdims=True),
        "plane": lambda: rng.uniform(-1, 1, (n, 3)) * [1, 1, 0],
        "line": lambda: np.outer(rng.uniform(-1, 1, n), rng.normal(size=3)),
        "clusters": lambda: 20 * rng.normal(size=(9, 3))[rng.integers(9, size=n)] + rng.normal(size=(n, 3)),
        "sheets": lambda: rng.uniform(-1, 1, (n, 3)) * (1 - 0.99 * np.eye(3)[rng.integers(3, size=n)]),
    }[kind]()
    scan = Scan(
        10.0**exponent * points,
        rng.normal(size=3) * 10 ** (exponent + 1) if has_viewpoint else None,
        name=kind,
    )
    assert_sound(segment(scan), scan)


coordinates = st.one_of(st.sampled_from([0.0, 1.0, 1e-9, 1e9, np.nan, np.inf]), st.floats(-1, 1))


@settings(max_examples=60, deadline=None)
@given(
    hnp.arrays(np.float64, st.tuples(st.integers(1, 30), st.just(3)), elements=coordinates),
    st.sampled_from(["auto", 0.3, 1e-6]),
)
def test_any_cloud(points, voxel_size):
    scan = Scan(points, name="any.pcd", label="thing")
    if np.isfinite(points).all(axis=1).any():
        assert_sound(segment(scan, voxel_size=voxel_size), scan)
    else:
        with pytest.raises(ScanError, match=r"any\.pcd"):
            segment(scan, voxel_size=voxel_size)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("viewpoint", [None, (0.1, 0.2, -2.0), (0.0, 0.0, 0.0)])
@pytest.mark.parametrize(
    "points",
    [
        [[0.3, 0.2, 0.1]],
        [[0.3, 0.2, 0.1], [0.3, 0.2, 0.4]],
        np.column_stack([*np.outer([0.6, 0.8], np.linspace(0, 0.4, 900)), np.full(900, 0.5)]),
        np.column_stack([*grid(0.1, 0.1), np.full(2500, 0.9)]),
        np.full((200, 3), 0.7),
        np.repeat(half_ball(0.04), 4, axis=0),
        np.vstack([half_ball(0.04), [[np.nan, 0, 0], [0, np.inf, 0]]]),
    ],
    ids=["one", "two", "line", "plane", "equal", "repeated", "holes"],
)
def test_degenerate_clouds_are_one_segment(points, viewpoint):
    scan = Scan(points, viewpoint)
    obj = segment(scan)
    assert_sound(obj, scan)
    assert obj.n_segments == 1 and obj.segment_edges.shape == (0, 2)


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.full((5, 3), np.nan), [[np.inf, 0, 0]]])
def test_nothing_to_segment_names_the_scan(points):
    with pytest.raises(ScanError, match=r"hollow\.pcd"):
        segment(Scan(points, name="hollow.pcd"))


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("voxel_size", ["large", 0.0, -1.0, np.nan, np.inf, None]),
        ("seed_size", [0, -0.02, np.nan, np.inf, -np.inf, None, "auto"]),
        ("max_segments", [0, -3, 2.5, True, False, np.nan, np.inf, None, "many"]),
    ],
)
def test_bad_parameters_are_named_with_their_value(name, values):
    scan = ball()
    for value in values:
        try:
            segment(scan, **{name: value})
        except (ValueError, TypeError) as error:
            assert isinstance(error, ValueError), f"{name}={value!r}: {error!r}"
            assert name in str(error) and repr(value) in str(error), f"{name}={value!r}: {error!r}"
        else:
            pytest.fail(f"{name}={value!r} was accepted")


def test_integers_of_any_type_are_taken():
    scan = ball()
    for max_segments in (1, np.int32(1), np.uint8(1)):
        assert segment(scan, max_segments=max_segments).n_segments == 1


def test_input_is_not_modified():
    scan = two_balls()
    points, viewpoint = scan.points.copy(), scan.viewpoint.copy()
    scan.points.flags.writeable = scan.viewpoint.flags.writeable = False
    prepared = prepare(scan)
    arrays = [prepared.points, prepared.normals, prepared.point_to_voxel, *prepared.neighbours]
    copies = [array.copy() for array in arrays]
    segment(scan)
    segment(prepared)
    np.testing.assert_array_equal(scan.points, points)
    np.testing.assert_array_equal(scan.viewpoint, viewpoint)
    for array, copy in zip(arrays, copies, strict=True):
        np.testing.assert_array_equal(array, copy)
