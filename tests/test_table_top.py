"""Simulated table-top scenes: what is where, and what the truth says of it."""

from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from shapeconcepts.datasets import simulate_scene, simulate_scenes
from shapeconcepts.scan import Scan
from shapeconcepts.simulation import table_top
from shapeconcepts.simulation.arrangement import THINGS, arrange
from shapeconcepts.simulation.contact import touching_pairs
from shapeconcepts.simulation.flying_pixels import let_fly
from shapeconcepts.simulation.footprint import gap
from shapeconcepts.simulation.furniture import FLOOR, TABLE, WALL, draw_table
from shapeconcepts.simulation.shapes.box import rounded_box
from shapeconcepts.simulation.shapes.mesh import moved
from shapeconcepts.sources.osd import is_labelled_scene, scene_objects

N_SCENES = 24
THIN = ("card", "ruler", "knife", "fork")


@pytest.fixture(scope="module")
def scenes():
    return simulate_scenes(N_SCENES, random_state=5)


@pytest.fixture(scope="module")
def arrangements():
    """Tables and the things on them."""
    found = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        tables = table_top._tables(rng, -0.7)
        found.append((tables, arrange(rng, tables, 8, 0.5, 0.2, lambda thing: True)))
    return found


def test_scenes_are_frames_of_a_camera(scenes):
    for index, scene in enumerate(scenes):
        assert scene.name == f"scene_{index}"
        assert scene.points.shape == (480, 640, 3)
        assert_array_equal(scene.viewpoint, np.zeros(3))
        rows, columns = np.nonzero(np.isfinite(scene.points[..., 2]))
        x, y, z = scene.points[rows, columns].T
        assert_allclose(525.0 * x / z + 319.5, columns, atol=1e-6)
        assert_allclose(525.0 * y / z + 239.5, rows, atol=1e-6)


def test_seed_and_index_decide_whatever_the_number(scenes):
    for index, other in enumerate(simulate_scenes(2, random_state=5)):
        assert_array_equal(scenes[index].points, other.points)
        assert_array_equal(scenes[index].point_labels, other.point_labels)
        assert scenes[index].objects == other.objects
    alone = simulate_scene(7, random_state=5)
    assert_array_equal(scenes[7].points, alone.points)
    assert not np.array_equal(simulate_scene(7, random_state=6).points, alone.points)


def test_labels_are_those_of_the_objects(scenes):
    for scene in scenes:
        labels, counts = np.unique(scene.point_labels[scene.point_labels >= 20], return_counts=True)
        assert [seen.label for seen in scene.objects] == labels.tolist()
        assert [seen.n_points for seen in scene.objects] == counts.tolist()
        assert labels.tolist() == [20 + 10 * k for k in range(len(labels))]
        assert 3 <= len(labels) <= 10
        assert np.isfinite(scene.points[scene.point_labels > 0]).all()
        assert not (set(np.unique(scene.point_labels).tolist()) - {0, 1, 2, 3, 4} - set(labels.tolist()))


def test_objects_are_cut_out_as_from_real_scenes(scenes):
    scene = scenes[0]
    labels = scene.point_labels.ravel()
    assert is_labelled_scene(labels)
    scan = Scan(scene.points.reshape(-1, 3), viewpoint=scene.viewpoint, point_labels=labels, name=scene.name)
    assert [len(cut) for cut in scene_objects(scan)] == [seen.n_points for seen in scene.objects]


def test_up_is_against_gravity(scenes):
    for scene in scenes:
        assert_allclose(np.linalg.norm(scene.true_up), 1.0)
        # Downwards in the image, whatever the roll.
        assert scene.true_up[1] < -0.4
        heights = scene.points @ scene.true_up
        table = heights[scene.point_labels == TABLE]
        top = np.median(table[table > np.quantile(table, 0.9) - 0.05])
        assert table.max() - top < 0.06
        floor = heights[scene.point_labels == FLOOR]
        if len(floor) > 1000:
            assert 0.3 < top - np.median(floor) < 1.2
            for seen in scene.objects:
                assert heights[scene.point_labels == seen.label].min() > np.median(floor) + 0.1
    known = [scene for scene in scenes if scene.up is not None]
    assert 0.25 * N_SCENES < len(known) < 0.75 * N_SCENES
    for scene in known:
        assert_allclose(scene.up, scene.true_up)


def test_scenes_are_varied(scenes):
    objects = [seen for scene in scenes for seen in scene.objects]
    assert {seen.category for seen in objects} == set(THINGS)
    assert 0.1 < np.mean([seen.is_thin for seen in objects]) < 0.5
    assert any(seen.is_cut for seen in objects)
    assert any(seen.touching for seen in objects)
    labels = [set(np.unique(scene.point_labels).tolist()) for scene in scenes]
    assert 0.4 * N_SCENES < sum(WALL in found for found in labels) < N_SCENES
    assert 2 <= sum(2 in found for found in labels) < 0.6 * N_SCENES
    shares = [np.mean(scene.point_labels == TABLE) for scene in scenes]
    assert min(shares) < 0.15
    assert max(shares) > 0.6
    assert len({len(scene.objects) for scene in scenes}) > 4


def test_what_is_thin_is_thin(scenes):
    for scene in scenes:
        for seen in scene.objects:
            assert seen.category not in THIN or seen.is_thin
            assert seen.category not in ("box", "can", "teddy", "bottle", "book") or not seen.is_thin
    for category in THIN:
        for seed in range(20):
            size = np.ptp(THINGS[category](np.random.default_rng(seed)).vertices, axis=0)
            assert 0.004 < size.min() < 0.0101
            assert size.max() > 0.08


def test_what_is_cut_reaches_the_border(scenes):
    for scene in scenes:
        # The noise moves an outline by a few pixels.
        inner = np.zeros(scene.point_labels.shape, dtype=bool)
        inner[5:-5, 5:-5] = True
        at_border = scene.point_labels[~inner]
        for seen in scene.objects:
            if seen.n_points > 300:
                assert ((at_border == seen.label).sum() > 20) == seen.is_cut


def test_touching_is_mutual_and_near(scenes):
    for scene in scenes:
        by_label = {seen.label: seen for seen in scene.objects}
        for seen in scene.objects:
            assert seen.label not in seen.touching
            for other in seen.touching:
                assert seen.label in by_label[other].touching


def test_nothing_reaches_into_another_thing(arrangements):
    n_stacked = 0
    for _, things in arrangements:
        assert len(things) >= 3
        for first, second in combinations(things, 2):
            if gap(first.outline, second.outline) < 0.0:
                n_stacked += 1
                assert first.bottom >= second.top - 1e-9 or second.bottom >= first.top - 1e-9
    assert n_stacked >= 3


def test_everything_rests_on_something(arrangements):
    for tables, things in arrangements:
        for thing in things:
            below = [
                other.top for other in things if other is not thing and gap(thing.outline, other.outline) < 0
            ]
            heights = [table.height for table in tables]
            assert min(abs(thing.bottom - height) for height in heights + below) < 1e-9


def test_tables_are_apart_and_of_different_heights():
    n_pairs = 0
    for seed in range(20):
        tables = table_top._tables(np.random.default_rng(seed), -0.7)
        if len(tables) == 2:
            n_pairs += 1
            assert gap(tables[0].outline, tables[1].outline) > 0.0
            assert abs(tables[0].height - tables[1].height) > 0.05
        for table in tables:
            assert_allclose(table.mesh.vertices[:, 2].min(), -0.7)
            assert_allclose(table.mesh.vertices[:, 2].max(), table.height, atol=1e-12)
    assert n_pairs >= 3


def test_a_large_table_is_large():
    table = draw_table(np.random.default_rng(0), -0.7, is_large=True)
    assert np.ptp(table.outline, axis=0).min() > 1.5


@pytest.mark.parametrize(("distance", "touches"), [(0.002, True), (0.008, True), (0.013, False)])
def test_a_centimetre_decides_what_touches(distance, touches):
    box = rounded_box(np.array([0.05, 0.1, 0.02]), radius=0.002)
    beside = moved(box, (0.1 + distance, 0.03, 0.0))
    above = moved(box, (0.02, 0.0, 0.04 + distance))
    assert touching_pairs([box, beside]) == ([(0, 1)] if touches else [])
    assert touching_pairs([box, above]) == ([(0, 1)] if touches else [])


def test_pixels_fly_between_the_surfaces_of_an_edge():
    depth = np.full((200, 200), 1.0)
    depth[:, 100:] = 1.5
    measured = np.ones(depth.shape, dtype=bool)
    measured[150:, 100:] = False
    exact = depth.copy()
    flying = let_fly(depth, measured, np.random.default_rng(0))
    assert set(np.nonzero(flying)[1].tolist()) == {99, 100}
    assert not flying[150:].any()
    assert 0.1 < flying[:150, 99:101].mean() < 0.3
    assert ((depth[flying] > 1.0) & (depth[flying] < 1.5)).all()
    assert_array_equal(depth[~flying], exact[~flying])


def test_flying_pixels_have_no_label(scenes):
    for scene in scenes:
        flying = np.isfinite(scene.points[..., 2]) & (scene.point_labels == 0)
        assert 10 < flying.sum() < 5000


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"index": -1}, "index must be a whole number, 0 or more, got -1"),
        ({"index": 0.5}, "index must be a whole number, 0 or more, got 0.5"),
        ({"index": 0, "random_state": None}, "random_state must be a whole number, 0 or more, got None"),
    ],
)
def test_bad_parameters_are_named(given, told):
    with pytest.raises(ValueError, match=f"^{told}"):
        simulate_scene(**given)


def test_a_bad_number_of_scenes_is_named():
    with pytest.raises(ValueError, match=r"^n_scenes must be a whole number, 0 or more, got 1\.5"):
        simulate_scenes(1.5)
    assert simulate_scenes(0) == []
