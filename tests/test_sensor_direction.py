"""The sensor's position, recovered from the points alone."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from shapeconcepts import read_scans
from shapeconcepts.datasets import load_osd
from shapeconcepts.preparation.pixel_lattice import order_free_sample, viewpoint_from_pixel_lattice
from shapeconcepts.preparation.pixel_lattice_kernels import propose_lattices, refine_camera
from shapeconcepts.preparation.sensor_direction import estimate_viewpoint, orient_normals

FOCAL_LENGTH = 525.0


def see(surface, *, noise=0.002, quantised=False, seed=0):
    """Points of a depth image, camera at the origin; `surface` maps ray slopes to depth, NaN for a miss."""
    x, y = np.meshgrid(np.arange(-90, 90) + 40, np.arange(-90, 90) - 25)
    x, y = x / FOCAL_LENGTH, y / FOCAL_LENGTH
    depth = surface(x, y)
    depth = depth + noise * depth**2 * np.random.default_rng(seed).standard_normal(depth.shape)
    if quantised:
        depth = 0.075 * FOCAL_LENGTH / (np.round(8 * 0.075 * FOCAL_LENGTH / depth) / 8)
    seen = np.isfinite(depth)
    return np.column_stack([(x * depth)[seen], (y * depth)[seen], depth[seen]])


def ball(x, y, centre=(0.07, -0.04, 1.0), radius=0.1, far_side=False):
    rays = np.stack([x, y, np.ones_like(x)], axis=-1)
    a, b = (rays**2).sum(-1), rays @ np.array(centre)
    root = b * b - a * (np.dot(centre, centre) - radius**2)
    with np.errstate(invalid="ignore"):
        depth = (b + np.sqrt(root) * (1 if far_side else -1)) / a
    return np.where((x - 0.07) ** 2 + (y + 0.04) ** 2 < 0.09**2, depth, np.nan)


def bowl(x, y):
    """The inside of a shallow bowl: the far side of a large ball."""
    return ball(x, y, centre=(0.07, -0.04, 0.7), radius=0.3, far_side=True)


def plane(x, y, normal, distance=1.0):
    inside = np.maximum(abs(x - 0.07), abs(y + 0.04)) < 0.08
    return np.where(inside, distance * normal[2] / (normal[0] * x + normal[1] * y + normal[2]), np.nan)


def frontal_face(x, y):
    return plane(x, y, (0.0, 0.0, 1.0))


def tilted_face(x, y):
    return plane(x, y, (0.5, 0.3, 0.8))


def box(x, y):
    """Three faces that meet in a corner that points to the camera."""
    faces = [plane(x, y, n) for n in ((0.6, 0.2, 0.77), (-0.7, 0.2, 0.68), (0.1, -0.8, 0.6))]
    return np.maximum.reduce(faces)


SURFACES = {"ball": ball, "bowl": bowl, "box": box, "frontal face": frontal_face, "tilted face": tilted_face}


def somewhere_else(points, seed, share=1.0):
    """The points in another frame and order, and the camera's position in that frame."""
    generator = np.random.default_rng(seed)
    kept = generator.permutation(len(points))[: int(share * len(points))]
    turn, shift = Rotation.random(random_state=seed).as_matrix(), generator.normal(size=3)
    return (points[kept] @ turn.T + shift).astype(np.float32).astype(float), shift


@pytest.mark.parametrize("quantised", [False, True])
@pytest.mark.parametrize("share", [1.0, 0.5])
@pytest.mark.parametrize("name", SURFACES)
def test_lattice_gives_the_viewpoint_in_any_frame(name, share, quantised):
    cloud = see(SURFACES[name], quantised=quantised)
    for seed in range(3):
        points, camera = somewhere_else(cloud, seed, share)
        viewpoint, is_certain = viewpoint_from_pixel_lattice(points)
        assert is_certain
        assert np.linalg.norm(viewpoint - camera) < 0.01


@pytest.mark.parametrize("name", ["ball", "bowl", "box"])
def test_lattice_needs_no_noise_where_the_surface_is_not_flat(name):
    points, camera = somewhere_else(see(SURFACES[name], noise=0.0), 1)
    viewpoint, _ = viewpoint_from_pixel_lattice(points)
    assert np.linalg.norm(viewpoint - camera) < 0.01


def test_lattice_scales_with_the_unit():
    points, camera = somewhere_else(see(box), 4)
    viewpoint, _ = viewpoint_from_pixel_lattice(1000.0 * points)
    assert np.linalg.norm(viewpoint - 1000.0 * camera) < 10.0


def test_lattice_survives_points_that_are_off_it():
    cloud = see(ball)
    generator = np.random.default_rng(0)
    off = generator.random(len(cloud)) < 0.3
    cloud[off] += 0.002 * generator.standard_normal((off.sum(), 3))
    points, camera = somewhere_else(cloud, 5)
    viewpoint, _ = viewpoint_from_pixel_lattice(points)
    assert np.linalg.norm(viewpoint - camera) < 0.01


@pytest.mark.parametrize("seed", range(5))
def test_no_lattice_where_there_is_none(seed):
    generator = np.random.default_rng(seed)
    points = generator.standard_normal((3000, 3))
    points /= 10 * np.linalg.norm(points, axis=1, keepdims=True)
    assert viewpoint_from_pixel_lattice(points)[0] is None
    assert viewpoint_from_pixel_lattice(generator.random((2000, 3)))[0] is None


def test_an_exact_plane_does_not_tell_its_side():
    """The mirror image of the camera in the plane sees the very same lattice."""
    cloud = see(tilted_face, noise=0.0)
    viewpoint, _ = viewpoint_from_pixel_lattice(cloud)
    assert viewpoint is None


@given(st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_order_of_the_points_does_not_matter(seed):
    points, _ = somewhere_else(see(box), 7)
    shuffled = points[np.random.default_rng(seed).permutation(len(points))]
    first, second = viewpoint_from_pixel_lattice(points)[0], viewpoint_from_pixel_lattice(shuffled)[0]
    np.testing.assert_allclose(first, second, atol=1e-8)
    assert {*map(tuple, points[order_free_sample(points, 50)])} == {
        *map(tuple, shuffled[order_free_sample(shuffled, 50)])
    }


def orthographic_differences(generator, n):
    """Whole pixel steps of a camera at infinity, as seen in space, and the rows that undo it."""
    turn, pitch = Rotation.random(random_state=generator).as_matrix(), 0.002
    steps = generator.integers(-2, 3, (n, 2))
    depth = 0.003 * generator.standard_normal((n, 1))
    return np.column_stack([pitch * steps, depth]) @ turn, turn[:2] / pitch


@pytest.mark.parametrize("seed", range(5))
def test_proposals_contain_the_true_lattice(seed):
    generator = np.random.default_rng(seed)
    differences, rows = orthographic_differences(generator, 200)
    pixels = differences @ rows.T
    right, down = (np.flatnonzero((np.round(pixels) == step).all(axis=1))[0] for step in ((1, 0), (0, 1)))
    scores, lattices = propose_lattices(differences[None, [right, down]], differences)
    np.testing.assert_allclose(abs(differences @ lattices[0].T), abs(pixels)[:, ::-1], atol=1e-6)
    assert scores[0] == pytest.approx(1.0 - 2.0 * (np.abs(pixels) < 0.5).all(axis=1).mean())


@pytest.mark.parametrize("seed", range(5))
def test_scores_count_whole_steps(seed):
    generator = np.random.default_rng(seed)
    differences, _ = orthographic_differences(generator, 60)
    blurred = differences + 0.0002 * generator.standard_normal(differences.shape)
    scores, lattices = propose_lattices(np.ascontiguousarray(differences.reshape(10, 6, 3)), blurred)
    assert (scores > 0).any()
    for score, rows in zip(scores[scores > 0], lattices[scores > 0], strict=True):
        expected = 0
        for u, v in blurred @ rows.T:
            if math.hypot(0, u - round(u)) < 0.15 and abs(v - round(v)) < 0.15:
                expected += -1 if round(u) == round(v) == 0 else 1
        assert score == pytest.approx(expected / 60)


@pytest.mark.parametrize("seed", range(5))
def test_one_refinement_step_is_weighted_least_squares(seed):
    generator = np.random.default_rng(seed)
    starts, ends = generator.random((40, 3)), generator.random((40, 3))
    camera = generator.random((3, 3)) * np.array([[5.0], [5.0], [0.3]])

    def steps(flat):
        a, b, c = flat.reshape(3, 3)
        ws, we = 1 + starts @ c, 1 + ends @ c
        return np.concatenate([ends @ a / we - starts @ a / ws, ends @ b / we - starts @ b / ws])

    flat, tolerance = camera.ravel(), 0.4
    residual = steps(flat) - np.round(steps(flat))
    squared = residual[:40] ** 2 + residual[40:] ** 2
    is_whole = (np.round(steps(flat)[:40]) != 0) | (np.round(steps(flat)[40:]) != 0)
    used = (squared < tolerance**2) & is_whole
    weight = np.tile(np.where(used, 1 - squared / tolerance**2, 0.0), 2)
    jacobian = np.column_stack([(steps(flat + h) - steps(flat - h)) / 2e-6 for h in 1e-6 * np.eye(9)])
    change = np.linalg.lstsq(weight[:, None] * jacobian, weight * residual, rcond=None)[0]

    refined = camera.copy()
    n_matches, error = refine_camera(starts, ends, refined, np.array([tolerance]))
    assert n_matches == used.sum() > 9
    assert error == pytest.approx(math.sqrt(squared[used].mean()))
    np.testing.assert_allclose(refined.ravel(), flat - change, rtol=1e-4, atol=1e-4)


def principal_normals(points, radius=0.015):
    tree = cKDTree(points)
    normals = np.empty_like(points)
    for row, near in enumerate(tree.query_ball_point(points, radius)):
        normals[row] = np.linalg.svd(points[near] - points[near].mean(axis=0), full_matrices=True)[2][2]
    return normals


@pytest.mark.parametrize("name", ["ball", "box"])
def test_resampled_clouds_are_judged_by_their_surface(name):
    generator = np.random.default_rng(2)
    cloud = see(SURFACES[name], noise=0.001)[::5]
    cloud = cloud + 0.001 * generator.standard_normal(cloud.shape)
    points, camera = somewhere_else(cloud, 3)
    normals = principal_normals(points)
    flipped = normals * generator.choice([-1.0, 1.0], (len(points), 1))
    viewpoint, is_measured = estimate_viewpoint(points, points, flipped)
    assert not is_measured
    oriented = orient_normals(points, flipped, viewpoint)
    assert (np.einsum("ij,ij->i", oriented, camera - points) > 0).mean() >= 0.99


def test_undecided_geometry_takes_the_sensor_to_look_along_z():
    x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(400, 3.0)])
    normals = np.tile([0.0, 0.0, 1.0], (400, 1))
    viewpoint, is_measured = estimate_viewpoint(points, points, normals)
    assert not is_measured
    assert viewpoint[2] < 0


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        np.ones((50, 3)),
        np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]]),
        np.outer(np.arange(100.0), [0.01, 0.02, -0.01]),
        np.column_stack([np.mgrid[0:12, 0:12].reshape(2, -1).T * 0.01, np.zeros(144)]),
        np.repeat(np.random.default_rng(0).random((20, 3)), 20, axis=0),
        1e8 + np.random.default_rng(1).random((300, 3)),
    ],
    ids=["one point", "one place", "two points", "line", "grid on a plane", "duplicates", "far away"],
)
@pytest.mark.filterwarnings("error")
def test_degenerate_clouds_get_some_viewpoint(points):
    normals = np.tile([0.6, 0.0, 0.8], (len(points), 1))
    viewpoint, is_measured = estimate_viewpoint(points, points, normals)
    assert viewpoint.shape == (3,)
    assert np.isfinite(viewpoint).all()
    assert not is_measured


def test_normals_turn_to_the_viewpoint():
    generator = np.random.default_rng(0)
    points, normals, viewpoint = generator.random((50, 3)), generator.standard_normal((50, 3)), np.ones(3)
    oriented = orient_normals(points, normals, viewpoint)
    for point, normal, result in zip(points, normals, oriented, strict=True):
        assert result @ (viewpoint - point) >= 0
        assert (result == normal).all() or (result == -normal).all()


def test_simulated_scans(shared_data):
    scans = read_scans(shared_data / "seven_shapes")[::15]
    for seed, scan in enumerate(scans):
        points, camera = somewhere_else(scan.points, seed)
        viewpoint, is_certain = viewpoint_from_pixel_lattice(points)
        assert is_certain, scan.name
        assert np.linalg.norm(viewpoint - camera) < 0.01, scan.name


def test_real_scans(shared_data):
    for seed, scan in enumerate(load_osd(shared_data / "osd_learn")[::10]):
        points, camera = somewhere_else(scan.points[np.isfinite(scan.points).all(axis=1)], seed)
        viewpoint, is_certain = viewpoint_from_pixel_lattice(points)
        assert is_certain, scan.name
        assert np.linalg.norm(viewpoint - camera) < 0.01, scan.name
