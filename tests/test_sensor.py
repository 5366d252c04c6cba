"""The simulated sensor against ray casting, slow Python and the noise model."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial import cKDTree

from shapeconcepts.scan import ScanError
from shapeconcepts.simulation.rendering import render
from shapeconcepts.simulation.sensor import KINECT, scan_mesh
from shapeconcepts.simulation.sensor_kernels import NOTHING, continuity, lit_by_projector
from shapeconcepts.simulation.sensor_model import SensorModel

FRONT = (0.0, -1.0, 0.0)


def upright_plane(half_width, half_height, angle_degrees=0.0):
    """Rectangle about the origin whose normal is turned by an angle away from -y, where the sensor is."""
    angle = np.radians(angle_degrees)
    right = np.array([np.cos(angle), np.sin(angle), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    corners = [-right * half_width - up * half_height, right * half_width - up * half_height]
    corners += [right * half_width + up * half_height, -right * half_width + up * half_height]
    return np.array(corners), np.array([[0, 1, 2], [0, 2, 3]])


def sight_lines(scan, sensor=KINECT):
    """Line of sight (z = 1) through the centre of each point's pixel, and the pixel."""
    pixels = scan.points[:, :2] / scan.points[:, 2:] * sensor.focal_length
    center = np.array([sensor.center_x, sensor.center_y])
    pixels = np.rint(pixels + center)
    sight = (pixels - center) / sensor.focal_length
    return np.column_stack([sight, np.ones(len(sight))]), pixels


def test_sphere_is_at_its_analytic_depth():
    radius, distance = 0.1, 0.8
    mesh = trimesh.creation.icosphere(6, radius=radius)
    scan = scan_mesh(
        mesh.vertices, mesh.faces, distance=distance, view_direction=(1.0, 2.0, 1.0), noise=False
    )
    sight, pixels = sight_lines(scan)
    squared = (sight**2).sum(axis=1)
    inner = distance**2 - squared * (distance**2 - radius**2)
    facing = inner > (0.01 * distance) ** 2
    expected = (distance - np.sqrt(inner[facing])) / squared[facing]
    assert_allclose(scan.points[facing, 2], expected, atol=1e-4)

    columns, rows = np.meshgrid(np.arange(640), np.arange(480))
    tangent = ((columns - 319.5) ** 2 + (rows - 239.5) ** 2) / 525.0**2
    assert abs(len(pixels) - (tangent < radius**2 / (distance**2 - radius**2)).sum()) < 0.002 * len(pixels)
    assert len(np.unique(pixels, axis=0)) == len(pixels)


def test_points_lie_on_the_lines_of_sight_and_on_the_plane():
    vertices, faces = upright_plane(0.2, 0.1, angle_degrees=50.0)
    scan = scan_mesh(vertices, faces, distance=1.0, view_direction=FRONT, noise=False)
    sight, _ = sight_lines(scan)
    assert_allclose(scan.points, sight * scan.points[:, 2:], atol=1e-12)
    normal = np.array([np.sin(np.radians(50.0)), 0.0, -np.cos(np.radians(50.0))])
    assert_allclose((scan.points - (0.0, 0.0, 1.0)) @ normal, 0.0, atol=1e-12)
    assert_array_equal(scan.viewpoint, [0.0, 0.0, 0.0])


def cast_rays(corners, sensor):
    """Depth where the ray of each pixel meets each triangle, inf where it misses (Möller and Trumbore)."""
    columns, rows = np.meshgrid(np.arange(sensor.width), np.arange(sensor.height))
    sight = np.stack(
        [
            (columns - sensor.center_x) / sensor.focal_length,
            (rows - sensor.center_y) / sensor.focal_length,
            np.ones(columns.shape),
        ],
        axis=-1,
    )
    depths = []
    for a, b, c in corners:
        cross = np.cross(sight, c - a)
        determinant = cross @ (b - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            first = cross @ -a / determinant
            other = np.cross(-a, b - a)
            second = sight @ other / determinant
            depth = (c - a) @ other / determinant
        inside = (first >= 0) & (second >= 0) & (first + second <= 1) & (np.abs(determinant) > 1e-12)
        depths.append(np.where(inside, depth, np.inf))
    return np.array(depths)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_rendering_agrees_with_ray_casting(seed):
    rng = np.random.default_rng(seed)
    sensor = SensorModel(width=48, height=40, focal_length=40.0, center_x=23.3, center_y=19.8)
    corners = rng.uniform([-0.6, -0.6, 0.5], [0.6, 0.6, 1.5], (6, 3, 3))
    image = render(corners.reshape(-1, 3), np.arange(18).reshape(6, 3), sensor)
    triangles = np.full((40, 48), NOTHING)
    inverse_depth = np.zeros((40, 48))
    place = np.s_[
        image.row : image.row + image.triangles.shape[0],
        image.column : image.column + image.triangles.shape[1],
    ]
    triangles[place], inverse_depth[place] = image.triangles, image.inverse_depth

    depths = cast_rays(corners, sensor)
    nearest = depths.min(axis=0)
    expected = np.where(np.isfinite(nearest), depths.argmin(axis=0), NOTHING)
    # The two may differ in a pixel whose centre an edge runs through within rounding.
    agree = triangles == expected
    assert agree.mean() > 0.999
    assert_allclose(inverse_depth[agree], 1.0 / nearest[agree], atol=1e-9)


def test_shared_edges_leave_no_holes():
    mesh = trimesh.creation.icosphere(5, radius=0.2)
    hit = render(mesh.vertices + np.array([0.0, 0.0, 0.8]), mesh.faces, KINECT).triangles >= 0
    for line in (*hit, *hit.T):
        inside = np.nonzero(line)[0]
        assert len(inside) == 0 or len(inside) == np.ptp(inside) + 1


def test_part_labels_are_the_faces_that_the_rays_meet():
    half = np.array([0.1, 0.06, 0.04])
    mesh = trimesh.creation.box(extents=2.0 * half)
    labels = np.array([2 * np.argmax(np.abs(n)) + (n.sum() > 0) for n in mesh.face_normals])
    direction = np.array([0.5, -0.7, 0.6]) / np.linalg.norm([0.5, -0.7, 0.6])
    scan = scan_mesh(
        mesh.vertices, mesh.faces, face_labels=labels, distance=0.7, view_direction=direction, noise=False
    )
    forward = -direction
    right = np.array([0.7, 0.5, 0.0]) / np.hypot(0.7, 0.5)
    to_mesh = np.array([right, np.cross(forward, right), forward])
    origin = 0.7 * direction
    sight = sight_lines(scan)[0] @ to_mesh
    entry = (np.sign(-sight) * half - origin) / sight
    axis = entry.argmax(axis=1)
    side = np.sign(-sight[np.arange(len(sight)), axis]) > 0
    assert_array_equal(scan.point_labels, 2 * axis + side)
    assert_allclose(scan.points[:, 2], entry.max(axis=1), atol=1e-12)
    assert set(scan.point_labels) == {1, 2, 5}


def test_image_is_upright_and_looks_at_the_middle():
    vertices = np.array([[-0.1, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.3], [0.0, 0.1, 0.0]]) + 5.0
    faces = np.array([[0, 1, 2], [0, 1, 3]])
    scan = scan_mesh(vertices, faces, distance=1.0, view_direction=FRONT, noise=False)
    width = {
        row: np.ptp(scan.points[np.isclose(scan.points[:, 1], row), 0]) for row in scan.points[[0, -1], 1]
    }
    assert width[scan.points[0, 1]] < 0.1 * width[scan.points[-1, 1]]
    assert_allclose(scan.points[:, 1].min() + scan.points[:, 1].max(), 0.0, atol=0.004)
    above = scan_mesh(vertices, faces, distance=1.0, view_direction=(0.0, 0.0, 2.0), noise=False)
    assert len(above) > 100


@pytest.mark.parametrize(("depth", "angle"), [(0.7, 0.0), (1.0, 0.0), (1.6, 0.0), (1.0, 45.0), (1.2, 65.0)])
def test_depth_noise_follows_the_model(depth, angle):
    vertices, faces = upright_plane(0.12 / np.cos(np.radians(angle)) ** 0.5, 0.12, angle)
    residuals, sigmas = [], []
    for seed in range(6):
        scan = scan_mesh(vertices, faces, distance=depth, view_direction=FRONT, random_state=seed)
        sight, _ = sight_lines(scan)
        normal = np.array([np.sin(np.radians(angle)), 0.0, -np.cos(np.radians(angle))])
        exact = normal[2] * depth / (sight @ normal)
        residuals.append(scan.points[:, 2] - exact)
        theta = np.arccos(np.abs(sight @ normal) / np.linalg.norm(sight, axis=1))
        nguyen = 0.0012 + 0.0019 * (exact - 0.4) ** 2
        nguyen += 0.0001 / np.sqrt(exact) * theta**2 / (np.pi / 2 - theta) ** 2
        quantum = exact**2 * 0.125 / (580.0 * 0.075)
        sigmas.append(np.sqrt(nguyen**2 + quantum**2 / 12.0))
    score = np.concatenate(residuals) / np.concatenate(sigmas)
    assert abs(score.mean()) < 0.05
    assert 0.94 < score.std() < 1.06


def test_noise_grows_with_distance_and_angle():
    model = SensorModel()
    depth = np.linspace(0.5, 4.0, 20)
    assert (np.diff(model.axial_noise(depth, np.zeros(20))) > 0).all()
    assert (np.diff(model.axial_noise(np.ones(20), np.linspace(0.0, 1.4, 20))) > 0).all()
    assert np.isfinite(model.axial_noise(np.ones(1), np.array([np.pi / 2]))).all()


def test_depth_is_quantised_in_disparity():
    vertices, faces = upright_plane(0.15, 0.15, 30.0)
    scan = scan_mesh(vertices, faces, distance=1.2, view_direction=FRONT)
    steps = 580.0 * 0.075 / scan.points[:, 2] * 8.0
    assert_allclose(steps, np.rint(steps), atol=1e-6)
    assert len(np.unique(np.rint(steps))) > 20


def test_noise_is_shared_by_neighbours():
    vertices, faces = upright_plane(0.15, 0.15)
    scan = scan_mesh(vertices, faces, distance=1.0, view_direction=FRONT)
    _, pixels = sight_lines(scan)
    image = np.full((480, 640), np.nan)
    columns, rows = pixels.astype(int).T
    image[rows, columns] = scan.points[:, 2] - scan.points[:, 2].mean()
    covariance = np.nanmean(image[:, 1:] * image[:, :-1])
    assert 0.4 < covariance / np.nanvar(image) < 0.75


def test_grazing_surfaces_are_lost():
    def kept(angle):
        vertices, faces = upright_plane(0.3, 0.1, angle)
        exact = scan_mesh(vertices, faces, distance=1.0, view_direction=FRONT, noise=False)
        return len(scan_mesh(vertices, faces, distance=1.0, view_direction=FRONT)) / len(exact)

    assert kept(60.0) > 0.93
    assert kept(85.0) < 0.15


def test_outline_is_jagged_by_about_a_pixel():
    vertices, faces = upright_plane(0.1, 0.2)
    sensor = SensorModel(edge_loss=0.0, speckle_loss=0.0)
    scan = scan_mesh(vertices, faces, distance=0.8, view_direction=FRONT, sensor=sensor)
    _, pixels = sight_lines(scan, sensor)
    rightmost = [pixels[pixels[:, 1] == row, 0].max() for row in range(150, 330)]
    assert 0.4 < np.std(rightmost) < 1.3


def test_projector_casts_a_shadow_to_the_left():
    """Left of a strip in front, the pattern misses `f b (1/z1 - 1/z2)` pixels of what is behind it."""
    near, near_faces = upright_plane(0.05, 0.2)
    far, far_faces = upright_plane(0.25, 0.2)
    vertices = np.concatenate([near - [0.0, 0.15, 0.0], far - [0.0, -0.15, 0.0]])
    faces = np.concatenate([near_faces, far_faces + 4])
    sensor = SensorModel(edge_loss=0.0, speckle_loss=0.0, lateral_noise=0.0)
    scan = scan_mesh(
        vertices, faces, face_labels=[0, 0, 1, 1], distance=1.0, view_direction=FRONT, sensor=sensor
    )
    _, pixels = sight_lines(scan, sensor)
    row = pixels[:, 1] == 240
    strip = pixels[row & (scan.point_labels == 0), 0]
    behind = pixels[row & (scan.point_labels == 1), 0]
    shadow = 525.0 * 0.075 * (1.0 / 0.85 - 1.0 / 1.15)
    assert abs(strip.min() - behind[behind < strip.min()].max() - 1.0 - shadow) <= 1.0
    assert behind[behind > strip.max()].min() - strip.max() == 1.0


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_shadow_agrees_with_comparing_all_pairs(seed):
    rng = np.random.default_rng(seed)
    disparity = np.where(rng.random((4, 15)) < 0.2, 0.0, rng.uniform(20.0, 26.0, (4, 15)))
    expected = np.zeros(disparity.shape, dtype=bool)
    for row, line in enumerate(disparity):
        for column, shift in enumerate(line):
            rivals = [other - line[other] for other in range(column + 1, 15) if line[other] > 0]
            expected[row, column] = shift > 0 and all(column - shift <= rival for rival in rivals)
    assert_array_equal(lit_by_projector(disparity), expected)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_continuity_agrees_with_slow_python(seed):
    rng = np.random.default_rng(seed)
    inverse_depth = np.where(rng.random((6, 7)) < 0.2, 0.0, rng.uniform(1.0, 1.05, (6, 7)))
    expected = np.zeros(inverse_depth.shape)
    padded = np.pad(inverse_depth, 1)
    for row, column in np.argwhere(inverse_depth > 0):
        window = padded[row : row + 3, column : column + 3] / inverse_depth[row, column]
        expected[row, column] = (np.sum(np.abs(window - 1.0) <= 0.02) - 1) / 8
    assert_allclose(continuity(inverse_depth, 0.02), expected)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.6])
def test_occlusion_hides_the_given_share(share):
    mesh = trimesh.creation.icosphere(4, radius=0.1)
    view = dict(distance=0.8, view_direction=FRONT, noise=False)
    whole = len(scan_mesh(mesh.vertices, mesh.faces, **view))
    for seed in range(5):
        rest = scan_mesh(mesh.vertices, mesh.faces, occlusion=share, random_state=seed, **view)
        assert abs(1.0 - len(rest) / whole - share) < 0.01
        kept = {tuple(point) for point in rest.points}
        assert kept <= {tuple(point) for point in scan_mesh(mesh.vertices, mesh.faces, **view).points}


@pytest.mark.parametrize(
    "mesh",
    [
        trimesh.creation.box(extents=(0.1, 0.2, 0.3)),
        trimesh.creation.cylinder(radius=0.05, height=0.2),
        trimesh.creation.capsule(height=0.1, radius=0.05),
        trimesh.creation.torus(0.1, 0.03),
        trimesh.creation.cone(0.1, 0.2),
    ],
    ids=["box", "cylinder", "capsule", "torus", "cone"],
)
def test_primitives_are_seen_where_they_are(mesh):
    scan = scan_mesh(mesh.vertices, mesh.faces, distance=0.9, view_direction=FRONT, random_state=3)
    assert len(scan) > 1000
    middle = mesh.bounds.mean(axis=0)
    in_mesh_frame = scan.points[:, [0, 2, 1]] * (1.0, 1.0, -1.0) + middle - (0.0, 0.9, 0.0)
    surface, _ = trimesh.sample.sample_surface(mesh, 100_000, seed=0)
    distance, _ = cKDTree(surface).query(in_mesh_frame)
    assert np.median(distance) < 0.002
    assert np.quantile(distance, 0.99) < 0.01


def test_same_seed_gives_the_same_bits():
    mesh = trimesh.creation.icosphere(3, radius=0.1)

    def scan(random_state):
        return scan_mesh(mesh.vertices, mesh.faces, occlusion=0.2, random_state=random_state).points

    assert_array_equal(scan(7), scan(7))
    assert_array_equal(scan(7), scan(np.random.default_rng(7)))
    assert not np.array_equal(scan(7), scan(8))
    assert not np.array_equal(scan(None), scan(None))


def test_large_mesh_fits_into_the_image():
    mesh = trimesh.creation.icosphere(3, radius=0.8)
    scan = scan_mesh(mesh.vertices, mesh.faces)
    _, pixels = sight_lines(scan)
    assert pixels.min() > 0
    assert (pixels.max(axis=0) < (639, 479)).all()


BOX = trimesh.creation.box(extents=(0.1, 0.1, 0.1))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"vertices": [[0, 0], [1, 1]]}, r"vertices must have shape \(v, 3\), got \(2, 2\)"),
        ({"vertices": "mug"}, "must be arrays of numbers"),
        ({"faces": []}, "no faces"),
        ({"faces": [[0, 1, 2, 3]]}, r"faces must be integers of shape \(f, 3\)"),
        ({"faces": [[0.0, 1.0, 2.0]]}, r"faces must be integers of shape \(f, 3\)"),
        ({"faces": [[0, 1, 8]]}, "index the 8 vertices, got 0 to 8"),
        ({"faces": [[-1, 1, 2]]}, "index the 8 vertices, got -1 to 2"),
        ({"faces": [[0, 1, 1], [2, 2, 2]]}, "area 0"),
        ({"vertices": BOX.vertices * np.nan}, "not finite"),
        ({"vertices": BOX.vertices * np.inf}, "not finite"),
        ({"vertices": BOX.vertices * 1000}, "173.205 m across.*in metres"),
        ({"vertices": BOX.vertices * 0.001}, "m across.*in metres"),
        ({"face_labels": [1, 2]}, r"face_labels must be integers of shape \(12,\)"),
        ({"face_labels": [0.5] * 12}, r"face_labels must be integers"),
        ({"distance": 0.1}, "distance must be 0.4 to 8.0 m, got 0.1"),
        ({"distance": np.nan}, "distance must be"),
        ({"vertices": BOX.vertices * 7, "distance": 0.4}, "within 0.1 m of the sensor"),
        ({"view_direction": (0, 0, 0)}, "view_direction"),
        ({"view_direction": (0, 1)}, "view_direction"),
        ({"view_direction": (0, np.nan, 1)}, "view_direction"),
        ({"occlusion": -0.1}, "occlusion must be between 0 and 0.9, got -0.1"),
        ({"occlusion": np.nan}, "occlusion"),
        (
            {"vertices": [[-1, 0, 0], [1, 0, 0], [0, 0.5, 0]], "faces": [[0, 1, 2]], "view_direction": FRONT},
            "nothing of it is visible",
        ),
    ],
)
def test_bad_input_is_refused_by_name(changes, message):
    arguments = {"vertices": BOX.vertices, "faces": BOX.faces, "distance": 1.0, "name": "mug.obj"} | changes
    with pytest.raises(ScanError, match=f"(?s)^mug.obj: .*{message}"):
        scan_mesh(arguments.pop("vertices"), arguments.pop("faces"), **arguments)


def test_unused_vertices_do_not_matter():
    vertices = np.concatenate([BOX.vertices, [[np.nan] * 3, [1e9] * 3]])
    expected = scan_mesh(BOX.vertices, BOX.faces, distance=1.0)
    assert_array_equal(scan_mesh(vertices, BOX.faces, distance=1.0).points, expected.points)


def test_faces_that_overlap_without_end_are_refused():
    corners = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]])
    faces = np.repeat([[0, 1, 2]], 40_000, axis=0)
    options = {"view_direction": (0, 0, 1), "distance": 0.6, "name": "mug"}
    assert len(scan_mesh(corners, faces[:10], **options)) > 0
    with pytest.raises(ScanError, match=r"^mug: its 40000 faces cover "):
        scan_mesh(corners, faces, **options)


@pytest.mark.parametrize("random_state", ["a", -1, 0.5])
def test_bad_random_state_is_named(random_state):
    with pytest.raises(ScanError, match=f"^mug: random_state must be .*Generator.*, got {random_state!r}$"):
        scan_mesh(np.eye(3), [[0, 1, 2]], random_state=random_state, name="mug")
