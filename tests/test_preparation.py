"""Preparation of whole scans: what is kept, what is dropped, what is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial import cKDTree

from shapeconcepts import Scan, ScanError
from shapeconcepts.preparation import prepare


def kinect_sheet(n: int = 3000, seed: int = 0) -> np.ndarray:
    """A gently bent sheet of 20 cm, 0.8 m in front of the origin, at the density of a Kinect."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-0.1, 0.1, (2, n))
    return np.column_stack([x, y, 0.8 + x**2 + 0.3 * y**2 + rng.normal(0, 3e-4, n)])


def assert_sound(prepared, scan: Scan) -> None:
    m = len(prepared.points)
    assert m >= 1
    assert prepared.points.shape == prepared.normals.shape == (m, 3)
    assert prepared.points.dtype == prepared.normals.dtype == np.float64
    assert prepared.point_to_voxel.shape == (len(scan),) and prepared.point_to_voxel.dtype == np.int32
    used = prepared.point_to_voxel[prepared.point_to_voxel >= 0]
    assert prepared.point_to_voxel.min() >= -1
    np.testing.assert_array_equal(np.unique(used), np.arange(m))
    assert np.isfinite(prepared.points).all()
    np.testing.assert_allclose(np.linalg.norm(prepared.normals, axis=1), 1.0, atol=1e-12)
    dropped = ~np.isfinite(scan.points).all(axis=1)
    assert (prepared.point_to_voxel[dropped] == -1).all()
    assert len(prepared.neighbours.indptr) == m + 1
    assert prepared.voxel_size > 0
    if scan.viewpoint is None:
        assert prepared.viewpoint is None
    else:
        np.testing.assert_array_equal(prepared.viewpoint, scan.viewpoint)
        towards = np.einsum("ij,ij->i", prepared.normals, scan.viewpoint - prepared.points)
        assert (towards >= 0).all()
    rounding = 1e-14 * np.abs(scan.points[~dropped]).max()
    for voxel in range(0, m, max(1, m // 20)):
        members = scan.points[prepared.point_to_voxel == voxel]
        np.testing.assert_allclose(prepared.points[voxel], members.mean(axis=0), atol=rounding)


def test_sheet_keeps_everything():
    scan = Scan(kinect_sheet(), viewpoint=np.zeros(3), name="sheet", label="thing")
    prepared = prepare(scan)
    assert_sound(prepared, scan)
    assert prepared.voxel_size >= 0.005
    assert (prepared.point_to_voxel >= 0).mean() > 0.99
    assert (prepared.name, prepared.label) == ("sheet", "thing")
    x, y = prepared.points[:, 0], prepared.points[:, 1]
    truth = np.column_stack([2 * x, 0.6 * y, -np.ones(len(x))])
    truth /= np.linalg.norm(truth, axis=1, keepdims=True)
    assert (np.einsum("ij,ij->i", truth, prepared.normals) > np.cos(np.radians(10))).mean() > 0.98


def test_neighbours_are_those_within_three_voxels():
    prepared = prepare(Scan(kinect_sheet(), viewpoint=np.zeros(3)))
    tree = cKDTree(prepared.points)
    expected = tree.query_ball_point(prepared.points, 3 * prepared.voxel_size, return_sorted=True)
    indptr, indices = prepared.neighbours
    for i, found in enumerate(expected):
        assert indices[indptr[i] : indptr[i + 1]].tolist() == [j for j in found if j != i]


def test_given_leaf_is_used():
    assert prepare(Scan(kinect_sheet()), voxel_size=0.013).voxel_size == 0.013


@pytest.mark.filterwarnings("error")
def test_tiny_leaf_gives_each_point_its_voxel():
    points = kinect_sheet()
    assert len(prepare(Scan(points), voxel_size=1e-300).points) == len(np.unique(points, axis=0))


def test_rows_that_are_not_finite_are_dropped():
    points = kinect_sheet()
    clean = prepare(Scan(points, viewpoint=np.zeros(3)))
    holes = np.arange(0, 3300, 11)
    spoilt = np.insert(points, holes - np.arange(300), np.nan, axis=0)
    spoilt[holes[::3], 0] = 0.0
    spoilt[holes[1::3], 2] = np.inf
    spoilt[holes[2::3], 1] = -np.inf
    scan = Scan(spoilt, viewpoint=np.zeros(3))
    prepared = prepare(scan)
    assert_sound(prepared, scan)
    is_hole = np.isin(np.arange(3300), holes)
    assert (prepared.point_to_voxel[is_hole] == -1).all()
    np.testing.assert_array_equal(prepared.point_to_voxel[~is_hole], clean.point_to_voxel)
    np.testing.assert_array_equal(prepared.points, clean.points)
    np.testing.assert_array_equal(prepared.normals, clean.normals)


def test_stray_points_are_dropped_and_their_rows_say_so():
    body = kinect_sheet()
    blob = np.array([0.4, 0.0, 0.8]) + np.random.default_rng(1).uniform(0, 0.005, (12, 3))
    scan = Scan(np.vstack([blob, body]), viewpoint=np.zeros(3))
    prepared = prepare(scan, voxel_size=0.005)
    assert_sound(prepared, scan)
    assert (prepared.point_to_voxel[:12] == -1).all()
    assert (prepared.point_to_voxel[12:] >= 0).mean() > 0.99


@pytest.mark.parametrize("distance", [3.0, 10.0, 1e8])
def test_one_far_point_does_not_coarsen_the_object(distance):
    points = kinect_sheet(20_000)
    alone = prepare(Scan(points, viewpoint=np.zeros(3)))
    scan = Scan(np.vstack([points, [0.0, 0.0, distance]]), viewpoint=np.zeros(3))
    prepared = prepare(scan)
    assert_sound(prepared, scan)
    assert prepared.point_to_voxel[-1] == -1
    assert prepared.voxel_size == alone.voxel_size == 0.005


@pytest.mark.parametrize("huge", [1e9, 1e12, 1e30, 1e150, 1e300])
@pytest.mark.parametrize("voxel_size", ["auto", 0.005])
def test_one_huge_coordinate_is_refused_or_survived(huge, voxel_size):
    points = kinect_sheet()
    points[17, 1] = huge
    scan = Scan(points, viewpoint=np.zeros(3), name="far.pcd")
    try:
        prepared = prepare(scan, voxel_size=voxel_size)
    except ScanError as error:
        assert "far.pcd" in str(error) and f"{huge:.3g}" in str(error)
    else:
        assert_sound(prepared, scan)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        [[0.1, 0.2, 0.7], [0.1, 0.25, 0.7]],
        np.outer(np.linspace(0, 0.3, 400), [1.0, 2.0, -0.5]),
        np.outer(np.linspace(0, 0.3, 7), [0.0, 0.0, 1.0]),
        kinect_sheet() * [1, 1, 0],
        np.full((500, 3), 0.3),
        np.repeat(kinect_sheet(300), 5, axis=0),
        kinect_sheet() * 1e-9,
        kinect_sheet() * 1e8,
    ],
    ids=["one", "two", "line", "axis", "plane", "equal", "repeated", "nano", "giga"],
)
@pytest.mark.parametrize("viewpoint", [None, (0.3, -0.2, -1.0)])
@pytest.mark.parametrize("voxel_size", ["auto", 0.005])
def test_degenerate_clouds(points, viewpoint, voxel_size):
    scan = Scan(np.asarray(points, dtype=float), viewpoint=viewpoint)
    assert_sound(prepare(scan, voxel_size=voxel_size), scan)


coordinates = st.one_of(
    st.sampled_from([0.0, -0.0, 1.0, 1e-9, 1e9, -1e9, np.nan, np.inf, -np.inf]), st.floats(-1, 1)
)


@settings(max_examples=50, deadline=None)
@given(
    hnp.arrays(np.float64, st.tuples(st.integers(1, 40), st.just(3)), elements=coordinates),
    st.sampled_from([None, (0.0, 0.0, 0.0), (3.0, 1e6, 0.0)]),
    st.sampled_from(["auto", 1e-3, 0.7, 1e3]),
)
def test_any_cloud(points, viewpoint, voxel_size):
    scan = Scan(points, viewpoint=viewpoint, name="any.xyz")
    if np.isfinite(points).all(axis=1).any():
        assert_sound(prepare(scan, voxel_size=voxel_size), scan)
    else:
        with pytest.raises(ScanError, match=r"any\.xyz.*finite"):
            prepare(scan, voxel_size=voxel_size)


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.full((9, 3), np.nan), [[0.0, np.inf, 0.0]]])
def test_nothing_to_prepare_names_the_scan(points):
    with pytest.raises(ScanError, match=r"empty\.pcd.*finite"):
        prepare(Scan(points, name="empty.pcd"))


@pytest.mark.parametrize("voxel_size", ["fine", "", 0, -0.005, np.nan, np.inf, None])
def test_bad_leaf_names_parameter_and_value(voxel_size):
    with pytest.raises(ValueError, match=f"voxel_size.*{voxel_size!r}"):
        prepare(Scan(kinect_sheet()), voxel_size=voxel_size)


@pytest.mark.parametrize("voxel_size", [1e-12, 1e-100, 1e-320])
def test_absurdly_small_leaf_keeps_every_point_or_is_refused(voxel_size):
    scan = Scan(kinect_sheet(50))
    try:
        prepared = prepare(scan, voxel_size=voxel_size)
    except ValueError as error:
        assert "voxel_size" in str(error)
    else:
        assert len(prepared.points) == 50


def test_input_is_not_modified():
    points = kinect_sheet()
    points[5] = np.nan
    viewpoint = np.zeros(3)
    copy = points.copy()
    points.flags.writeable = viewpoint.flags.writeable = False
    prepare(Scan(points, viewpoint=viewpoint))
    np.testing.assert_array_equal(points, copy)


def test_arrays_and_point_clouds_of_other_libraries_are_taken():
    class Cloud:
        points = np.random.default_rng(0).uniform(0, 0.1, (500, 3))

    assert len(prepare(Cloud()).points) == len(prepare(Cloud.points).points) > 100


@pytest.mark.parametrize("value", [None, "mug.pcd", [1, 2, 3], np.zeros((3, 4))])
def test_something_else_than_a_scan_is_refused(value):
    with pytest.raises(ScanError, match="expected a Scan"):
        prepare(value)
