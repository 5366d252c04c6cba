"""The simulated data set: shapes, truth, seeds."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from shapeconcepts.datasets import CATEGORIES, PART_NAMES, simulate, simulate_scan
from shapeconcepts.simulation.shapes import SHAPES
from shapeconcepts.simulation.shapes.mesh import bezier, ellipsoid, limb, revolve


@pytest.fixture(scope="module")
def scans():
    return simulate(12, random_state=1)


def assert_same(first, second):
    assert [scan.name for scan in first] == [scan.name for scan in second]
    for one, other in zip(first, second, strict=True):
        assert_array_equal(one.points, other.points)
        assert_array_equal(one.point_labels, other.point_labels)


def test_scans_are_named_and_labelled(scans):
    assert len(scans) == 7 * 12
    assert [scan.name for scan in scans[:2]] == ["sack_0", "sack_1"]
    assert [scan.label for scan in scans[::12]] == ["sack", "can", "box", "teddy", "ball", "amphora", "plate"]
    for scan in scans:
        assert_array_equal(scan.viewpoint, [0.0, 0.0, 0.0])
        assert len(scan) >= 400
        assert np.isfinite(scan.points).all()
        assert scan.point_labels.min() >= 0
        assert scan.point_labels.max() < len(PART_NAMES[scan.label])


def test_scans_are_varied(scans):
    distances = [np.median(scan.points[:, 2]) for scan in scans]
    assert min(distances) < 0.75
    assert max(distances) > 1.35
    for category in CATEGORIES:
        sizes = [np.linalg.norm(np.ptp(scan.points, axis=0)) for scan in scans if scan.label == category]
        assert max(sizes) > 1.5 * min(sizes)


def test_scans_fit_into_the_image(scans):
    for scan in scans:
        pixels = scan.points[:, :2] / scan.points[:, 2:] * 525.0 + (319.5, 239.5)
        assert_allclose(pixels, np.rint(pixels), atol=1e-6)
        assert pixels.min() > -0.5
        assert (pixels.max(axis=0) < (639.5, 479.5)).all()


def test_seed_decides(scans):
    assert_same(simulate(2, categories=["can"], random_state=1), scans[12:14])
    assert_same([simulate_scan("plate", 11, random_state=1)], scans[-1:])
    assert_same(
        simulate(1, random_state=np.random.default_rng(5)), simulate(1, random_state=np.random.default_rng(5))
    )
    other = simulate(1, categories=["can"], random_state=2)[0]
    assert not np.array_equal(other.points, scans[12].points)
    anew = [simulate(1, categories=["ball"], random_state=None)[0].points for _ in range(2)]
    assert not np.array_equal(*anew)


def test_generator_moves_on():
    rng = np.random.default_rng(0)
    first, second = (simulate(1, categories=["ball"], random_state=rng)[0].points for _ in range(2))
    assert not np.array_equal(first, second)


def test_nothing_asked_for_gives_nothing():
    assert simulate(0) == []
    assert simulate(3, categories=[]) == []


def test_bad_arguments_are_refused():
    with pytest.raises(ValueError, match="n_per_category must be a whole number, 0 or more, got -1"):
        simulate(-1)
    with pytest.raises(ValueError, match="unknown category 'mug', expected some of sack, can"):
        simulate(1, categories=["mug"])
    with pytest.raises(ValueError, match="unknown category 'mug'"):
        simulate_scan("mug", 0)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"n_per_category": 1.5}, "n_per_category must be a whole number, 0 or more, got 1.5"),
        ({"n_per_category": "3"}, "n_per_category must be a whole number, 0 or more, got '3'"),
        ({"n_per_category": None}, "n_per_category must be a whole number, 0 or more, got None"),
        ({"categories": "box"}, "categories must be a sequence of names, .* got 'box'"),
        ({"categories": 3}, "categories must be a sequence of names, .* got 3"),
        ({"categories": [["box"]]}, r"unknown category \['box'\], expected some of sack"),
        ({"random_state": "a"}, "random_state must be a whole number, 0 or more, .*Generator.* got 'a'"),
        ({"random_state": -1}, "random_state must be a whole number, 0 or more, .*Generator.* got -1"),
        ({"random_state": 0.5}, "random_state must be a whole number, 0 or more, .*Generator.* got 0.5"),
    ],
)
def test_bad_parameters_are_named(parameters, message):
    with pytest.raises(ValueError, match=f"^(categories: )?{message}"):
        simulate(**{"n_per_category": 1, "categories": ["ball"], **parameters})


@pytest.mark.parametrize("parameters", [{"index": -1}, {"index": 0.5}, {"random_state": None}])
def test_bad_parameters_of_one_scan_are_named(parameters):
    with pytest.raises(ValueError, match=r"^(index|random_state) must be a whole number, 0 or more, got "):
        simulate_scan("ball", **{"index": 0, **parameters})


def test_categories_may_be_any_iterable():
    assert [scan.label for scan in simulate(1, categories=(name for name in ["ball"]))] == ["ball"]


@pytest.mark.parametrize("category", CATEGORIES)
def test_meshes_are_sound(category):
    parts = set()
    for seed in range(40):
        mesh = SHAPES[category](np.random.default_rng(seed))
        assert np.isfinite(mesh.vertices).all()
        assert mesh.faces.min() >= 0
        assert mesh.faces.max() < len(mesh.vertices)
        assert mesh.face_labels.shape == (len(mesh.faces),)
        extents = np.ptp(mesh.vertices, axis=0)
        assert 0.035 < extents.max() < 0.6
        if category in ("box", "can", "ball"):
            assert extents.min() > 0.035
        parts |= set(mesh.face_labels.tolist())
    assert parts == set(range(len(PART_NAMES[category])))


def test_labelled_box_faces_are_flat(scans):
    """A shallow dent, a bulge and the noise stay within millimetres; two faces in one would not."""
    faces = [
        scan.points[scan.point_labels == part]
        for scan in scans
        if scan.label == "box"
        for part in range(6)
        if (scan.point_labels == part).sum() > 300
    ]
    assert len(faces) > 15
    for points in faces:
        centred = points - points.mean(axis=0)
        assert np.sqrt(np.linalg.eigvalsh(centred.T @ centred / len(points))[0]) < 0.008


def test_balls_are_round(scans):
    for scan in scans:
        if scan.label == "ball":
            design = np.column_stack([2.0 * scan.points, np.ones(len(scan))])
            solution = np.linalg.lstsq(design, (scan.points**2).sum(axis=1), rcond=None)[0]
            radius = np.sqrt(solution[3] + solution[:3] @ solution[:3])
            residual = np.linalg.norm(scan.points - solution[:3], axis=1) - radius
            assert 0.015 < radius < 0.18
            assert residual.std() < 0.008


def enclosed_volume(mesh):
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def test_solids_have_their_volume():
    assert_allclose(enclosed_volume(ellipsoid((0.1, 0.2, 0.3), n=96)), 4 / 3 * np.pi * 0.006, rtol=2e-3)
    cylinder = revolve([0.0, 0.1, 0.1, 0.0], [0.0, 0.0, 0.5, 0.5], n_around=400)
    assert_allclose(enclosed_volume(cylinder), np.pi * 0.005, rtol=1e-3)
    capsule = limb((0, 0, 0), (0, 0, 0.5), (0, 0, 1.0), 0.1, 0.1, label=0)
    assert_allclose(abs(enclosed_volume(capsule)), np.pi * (0.01 * 0.8 + 4 / 3 * 0.001), rtol=0.05)


def test_bezier_agrees_with_bernstein_polynomials():
    control = np.random.default_rng(0).normal(size=(4, 3))
    t = np.linspace(0.0, 1.0, 9)[:, None]
    weights = np.hstack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
    assert_allclose(bezier(control, t[:, 0]), weights @ control, atol=1e-14)


def test_a_view_of_nothing_is_drawn_again():
    # In its second view, what stands in front shades the whole ball.
    scan = simulate_scan("ball", 33, random_state=201)
    assert len(scan) >= 400
