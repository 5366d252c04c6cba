"""Objects in scenes: what is found, what is left out, and what holds whatever the scene."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from shapeconcepts import ScanError, Scene, datasets, extract_objects, read_scan
from shapeconcepts.evaluation.object_detection import match_objects, touching_objects
from shapeconcepts.extraction.gravity import upward
from shapeconcepts.extraction.pixel_grid import scene_pixels
from shapeconcepts.extraction.planar_regions import planar_regions
from shapeconcepts.extraction.supporting_planes import supporting_planes

SEED = 77


@pytest.fixture(scope="module")
def scenes():
    return datasets.simulate_scenes(12, random_state=SEED)


def plain(scene, **changed):
    """A scene without the truth about it."""
    given = {"points": scene.points, "viewpoint": scene.viewpoint, "up": scene.up, "name": "kitchen"}
    return Scene(**{**given, **changed})


def shares_found(scenes):
    """Shares of the visible objects that stand apart that were found, and of what was found that is one."""
    found, right = [], []
    for scene in scenes:
        matches = match_objects(scene.point_labels, [one.indices for one in extract_objects(plain(scene))])
        apart = {one.label for one in scene.objects if one.n_points >= 300 and not one.touching}
        found += matches.is_found[np.isin(matches.labels, list(apart))].tolist()
        touching = [one.label for one in scene.objects if one.touching]
        right += matches.is_right[~np.isin(matches.main_labels, touching)].tolist()
    return np.mean(found), np.mean(right)


def box_on_a_plane(height=0.1, tilt=0.6, distance=1.0, noise=0.0005, with_box=True):
    """Exact image of a box on an endless plane, 320 x 240 pixels, and the pixels of the box."""
    rows, columns = np.indices((240, 320))
    rays = np.stack([(columns - 159.5) / 262.5, (rows - 119.5) / 262.5, np.ones((240, 320))], axis=2)
    up = np.array([0.0, -np.cos(tilt), -np.sin(tilt)])
    middle = np.array([0.0, 0.0, distance])
    right = np.array([1.0, 0.0, 0.0])
    away = np.cross(up, right)
    frame = np.stack([right, away, up])
    to_plane, directions = -middle @ frame.T, rays @ frame.T
    along = -to_plane[2] / np.where(directions[..., 2] < 0, directions[..., 2], np.nan)
    low, high = np.array([-0.06, -0.06, 0.0]), np.array([0.06, 0.06, height])
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = np.stack([(low - to_plane) / directions, (high - to_plane) / directions])
    enters, leaves = sides.min(axis=0).max(axis=-1), sides.max(axis=0).min(axis=-1)
    is_box = (enters < leaves) & (enters > 0) & with_box
    depth = np.where(is_box, enters, along)
    depth += noise * np.random.default_rng(0).standard_normal(depth.shape)
    return rays * depth[..., None], is_box, up


def test_most_simulated_objects_are_found_and_little_else(scenes):
    recall, precision = shares_found(scenes)
    assert recall >= 0.85
    assert precision >= 0.85


def test_the_objects_of_real_scenes_are_found(shared_data):
    found, right = [], []
    for name in ("learn2", "learn9", "learn33", "learn38"):
        scan = read_scan(shared_data / "osd_learn" / f"{name}.pcd")
        scene = Scene(scan.points.reshape(480, 640, 3), viewpoint=(0, 0, 0))
        labels = scan.point_labels.reshape(480, 640)
        matches = match_objects(labels, [one.indices for one in extract_objects(scene)])
        apart = ~np.isin(matches.labels, list(touching_objects(scene.points, labels)))
        found += matches.is_found[apart].tolist()
        right += matches.is_right.tolist()
    assert all(found)
    assert np.mean(right) >= 0.9


def test_a_box_is_found_to_the_pixel():
    points, is_box, _ = box_on_a_plane()
    [found] = extract_objects(Scene(points, viewpoint=(0, 0, 0), name="kitchen", time=12.5))
    overlap = np.isin(np.flatnonzero(is_box), found.indices).sum()
    assert overlap / len(np.union1d(np.flatnonzero(is_box), found.indices)) > 0.95
    assert found.scan.name == "kitchen/0"
    assert np.array_equal(found.scan.points, points.reshape(-1, 3)[found.indices])
    assert found.time == 12.5
    assert not found.is_cut
    rows, columns = np.divmod(found.indices, 320)
    assert found.box == (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)


@pytest.mark.parametrize("height", [0.006, 0.01, 0.03])
def test_what_is_thin_is_kept(height):
    points, is_box, _ = box_on_a_plane(height)
    [found] = extract_objects(Scene(points, viewpoint=(0, 0, 0)))
    assert np.isin(np.flatnonzero(is_box), found.indices).mean() > 0.8


def test_a_bare_table_holds_nothing():
    assert extract_objects(Scene(box_on_a_plane(with_box=False)[0], viewpoint=(0, 0, 0))) == []


def test_an_object_is_found_where_its_table_is_not_seen():
    points, is_box, _ = box_on_a_plane()
    points[:, 90:][~is_box[:, 90:]] = np.nan
    [found] = extract_objects(Scene(points, viewpoint=(0, 0, 0)))
    assert np.isin(np.flatnonzero(is_box), found.indices).mean() > 0.9
    # What is cut out of a wall that the same table stands before is behind what is around it.
    hidden, is_box, _ = box_on_a_plane()
    hidden[:, 90:][~is_box[:, 90:]] = hidden[:, 90:][~is_box[:, 90:]] * 0.3
    assert extract_objects(Scene(hidden, viewpoint=(0, 0, 0))) == []


def test_nothing_to_stand_on_is_an_answer():
    angles = np.random.default_rng(0).normal(size=(5000, 3))
    ball = 0.1 * angles / np.linalg.norm(angles, axis=1, keepdims=True) + (0, 0, 1)
    assert extract_objects(Scene(ball)) == []


def test_points_in_no_order_give_the_same_objects(scenes):
    rng = np.random.default_rng(0)
    for scene in scenes[:4]:
        points = scene.points.reshape(-1, 3)
        order = rng.permutation(np.flatnonzero(np.isfinite(points[:, 0])))
        found = extract_objects(plain(scene))
        shuffled = extract_objects(plain(scene, points=points[order]))
        same = [
            any(
                np.isin(order[other.indices], one.indices).sum()
                > 0.8 * max(len(other.indices), len(one.indices))
                for other in shuffled
            )
            for one in found
        ]
        assert np.mean(same) >= 0.7


def test_the_image_of_a_camera_may_come_as_a_list(scenes):
    flat = extract_objects(plain(scenes[0], points=scenes[0].points.reshape(-1, 3)))
    image = extract_objects(plain(scenes[0]))
    assert len(flat) == len(image)
    assert all(np.array_equal(a.indices, b.indices) for a, b in zip(flat, image, strict=True))


def test_other_frames_need_a_direction_upwards_or_the_z_axis():
    points, is_box, up = box_on_a_plane()
    right = np.array([1.0, 0.0, 0.0])
    frame = np.stack([right, np.cross(up, right), up])
    turned = points @ frame.T
    [found] = extract_objects(Scene(turned, viewpoint=(0, 0, 0)))
    assert np.isin(np.flatnonzero(is_box), found.indices).mean() > 0.9
    # Lying on its side, a camera sees a wall, unless it is told.
    sideways = points[..., [1, 0, 2]] * (-1, 1, 1)
    told = Scene(sideways, viewpoint=(0, 0, 0), up=up[[1, 0, 2]] * (-1, 1, 1))
    [found] = extract_objects(told)
    assert np.isin(np.flatnonzero(is_box), found.indices).mean() > 0.9


def test_gravity_is_guessed_within_a_degree(scenes):
    for scene in scenes:
        grid = scene_pixels(plain(scene)).grid
        regions = planar_regions(grid.points, grid.viewpoint, grid.pitch).regions
        up = upward(regions, grid.is_camera_frame, None)
        assert up @ scene.true_up > np.cos(np.radians(1.5))
        assert supporting_planes(regions, up)


def test_what_the_border_cuts_is_marked(scenes):
    for scene in scenes:
        truth = {one.label: one.is_cut for one in scene.objects}
        objects = extract_objects(plain(scene))
        matches = match_objects(scene.point_labels, [one.indices for one in objects])
        for label, number in zip(matches.labels, matches.found_by, strict=True):
            if number >= 0 and truth[int(label)]:
                assert objects[number].is_cut


def test_a_scene_far_from_the_origin_holds_the_same():
    points, _, _ = box_on_a_plane()
    offset = np.array([447_123.0, 5_411_234.0, 312.0])
    [near] = extract_objects(Scene(points, viewpoint=(0, 0, 0)))
    [far] = extract_objects(Scene(points + offset, viewpoint=offset))
    assert np.isin(near.indices, far.indices).mean() > 0.99
    assert np.isin(far.indices, near.indices).mean() > 0.99


def test_small_things_can_be_left_out():
    scene = Scene(box_on_a_plane()[0], viewpoint=(0, 0, 0))
    assert extract_objects(scene, fewest_points=100_000) == []
    with pytest.raises(ValueError, match="fewest_points must be an integer of at least 1, got 0"):
        extract_objects(scene, fewest_points=0)


@pytest.mark.parametrize("shape", [(0, 3), (7, 3), (2, 2, 3)])
def test_a_scene_without_a_measurement_says_so(shape):
    with pytest.raises(ScanError, match=f"kitchen: none of its {np.prod(shape[:-1])} points is finite"):
        extract_objects(Scene(np.full(shape, np.nan), name="kitchen"))


def test_coordinates_that_no_scene_has_are_told():
    with pytest.raises(ScanError, match=r"kitchen: coordinates up to 1e\+300, expected metres"):
        extract_objects(Scene([[0, 0, 1], [0, 0, 1e300]], name="kitchen"))


DEGENERATE = {
    "one point": [[0.0, 0.0, 1.0]],
    "the same point": [[0.1, 0.2, 1.0]] * 500,
    "a line": np.linspace((0, 0, 1), (1, 0, 1), 500),
    "a grid on a plane": np.stack(np.meshgrid(np.arange(50), np.arange(50), [100]), -1).reshape(-1, 3) / 100,
    "far away": np.random.default_rng(0).random((500, 3)) + 5e5,
    "huge": np.random.default_rng(0).random((500, 3)) * 1e5,
}


@pytest.mark.parametrize("points", DEGENERATE.values(), ids=DEGENERATE.keys())
def test_odd_clouds_hold_nothing(points):
    assert extract_objects(Scene(points)) == []


@settings(max_examples=40, deadline=None)
@given(
    arrays(
        np.float64,
        st.tuples(st.integers(1, 20), st.integers(1, 20), st.just(3)),
        elements=st.floats(-5, 5) | st.sampled_from([0.0, np.nan, np.inf, 1e300, -1e-300]),
    ),
    st.booleans(),
    st.sampled_from([None, (0, 0, 0), (1, 2, 3)]),
)
def test_whatever_the_points_nothing_breaks(points, is_organised, viewpoint):
    scene = Scene(points if is_organised else points.reshape(-1, 3), viewpoint=viewpoint)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            objects = extract_objects(scene)
        except ScanError:
            return
    indices = np.concatenate([np.empty(0, int), *(one.indices for one in objects)])
    assert len(np.unique(indices)) == len(indices)
