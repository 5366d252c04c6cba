"""Simulated table-top scenes, with the truth about each object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.scan import ScanError
from shapeconcepts.scene import Scene
from shapeconcepts.simulation.arrangement import Thing, arrange
from shapeconcepts.simulation.camera import Camera, draw_camera
from shapeconcepts.simulation.contact import touching_pairs
from shapeconcepts.simulation.flying_pixels import let_fly
from shapeconcepts.simulation.furniture import (
    FLOOR,
    SECOND_TABLE,
    TABLE,
    WALL,
    Table,
    beside,
    draw_table,
    floor_at,
    on_table,
    wall_behind,
)
from shapeconcepts.simulation.measurement import measure
from shapeconcepts.simulation.rendering import DepthImage, render
from shapeconcepts.simulation.seeds import check_count, seed_of
from shapeconcepts.simulation.sensor import KINECT
from shapeconcepts.simulation.shapes.mesh import Mesh, join

THIN = 0.01

# Apart from the spawn keys of scans, which start with the category's number.
_SCENES = 1000
_FIRST_OBJECT, _DECADE = 20, 10
_FEWEST_OBJECTS, _MOST_OBJECTS = 3, 10
_FEWEST_POINTS = 300
_MOST_DRAWS = 40
# The camera looks at a place on the table, at most so far from its middle.
_OFF_MIDDLE = 0.6
_NEAREST_VERTEX = 0.1
_NEAREST_OBJECT = 0.5
# The sensor reads nothing that is nearer or farther.
_RANGE = (0.45, 6.0)


@dataclass(frozen=True)
class SceneObject:
    """The truth about one object of a simulated scene.

    Attributes
    ----------
    label : int
        Of its points in `Scene.point_labels`: 20, 30, 40, …
    category : str
        What it is, such as "box" or "fork".
    n_points : int
        How many of its points are visible.
    is_thin : bool
        At most 1 cm high.
    is_cut : bool
        Visible at the image's border, beyond which it may go on.
    touching : frozenset of int
        Labels of the objects within 1 cm of it, beside, below or on it.
    """

    label: int
    category: str
    n_points: int
    is_thin: bool
    is_cut: bool
    touching: frozenset[int]


@dataclass(frozen=True, eq=False)
class SimulatedScene(Scene):
    """A simulated scene, which knows what it shows.

    Parameters
    ----------
    true_up : (3,) float64
        Direction against gravity in the camera frame. `up` is the same or None.
    objects : tuple of SceneObject
        Those of which something is visible, by label.
    """

    true_up: NDArray[np.float64] | None = None
    objects: tuple[SceneObject, ...] = ()


def simulate_scenes(
    n_scenes: int, *, random_state: int | np.random.Generator | None = 0
) -> list[SimulatedScene]:
    """Kinect-like frames of tables with objects, see `simulate_scene`.

    Parameters
    ----------
    n_scenes : int
        The i-th scene does not depend on this number.
    random_state : int, numpy.random.Generator or None
        Seed. A generator is advanced by one draw; None draws anew each time.

    Returns
    -------
    list of SimulatedScene

    Raises
    ------
    ValueError
        If a parameter is not as described; the message names it and its value.
    """
    check_count("n_scenes", n_scenes)
    seed = seed_of(random_state)
    return [simulate_scene(index, random_state=seed) for index in range(n_scenes)]


def simulate_scene(index: int, *, random_state: int = 0) -> SimulatedScene:
    """One of the scenes of `simulate_scenes`, without the others.

    Three to ten objects lie or stand on a round or rectangular table, or on two of different heights, some of
    them beside or on top of another. A camera looks at them from 0.75 to 1.5 m, 15° to 60° downwards, rolled
    by up to 10°. There are a floor and mostly a wall behind. At depth edges, some pixels read a depth in
    between.

    Parameters
    ----------
    index : int
        Number of the scene, from 0.
    random_state : int
        Seed given to `simulate_scenes`.

    Returns
    -------
    SimulatedScene
        Named like "scene_3". `points` are (480, 640, 3) in the camera frame (x right, y down, z forward),
        NaN where nothing was measured; `viewpoint` is the origin; `up` is known in half of the scenes.
        `point_labels` are numbered as in the Object Segmentation Database: 0 nothing measured or between
        two surfaces, 1 table, 2 second table, 3 wall, 4 floor, and 20, 30, 40, … the objects.

    Raises
    ------
    ValueError
        If a parameter is not as described; the message names it and its value.
    """
    check_count("index", index)
    check_count("random_state", random_state)
    rng = np.random.default_rng(np.random.SeedSequence(random_state, spawn_key=(_SCENES, index)))
    for _ in range(_MOST_DRAWS):
        scene = _drawn_scene(rng, f"scene_{index}")
        if sum(seen.n_points >= _FEWEST_POINTS for seen in scene.objects) >= _FEWEST_OBJECTS:
            return scene
    raise ScanError(
        f"scene_{index}: fewer than {_FEWEST_OBJECTS} objects are visible in each of {_MOST_DRAWS} draws"
    )


def _drawn_scene(rng: np.random.Generator, name: str) -> SimulatedScene:
    camera = draw_camera(rng)
    floor = -rng.uniform(0.45, 0.95)
    tables = _tables(rng, floor)

    def is_place(thing: Thing) -> bool:
        middle = (thing.mesh.vertices.min(axis=0) + thing.mesh.vertices.max(axis=0)) / 2.0
        return (
            camera.sees(middle, KINECT)
            and camera.to_camera(thing.mesh.vertices)[:, 2].min() > _NEAREST_OBJECT
        )

    n_things = int(rng.integers(_FEWEST_OBJECTS, _MOST_OBJECTS + 1))
    contact = rng.choice([0.0, 0.4], p=[0.6, 0.4])
    spread = rng.uniform(0.12, 0.25) if rng.random() < 0.5 else None
    things = arrange(rng, tables, n_things, contact, spread, is_place)
    labels = [_FIRST_OBJECT + _DECADE * k for k in range(len(things))]
    parts = [_labelled(thing.mesh, label) for thing, label in zip(things, labels, strict=True)]
    parts += [
        _labelled(table.mesh, label) for table, label in zip(tables, (TABLE, SECOND_TABLE), strict=False)
    ]
    if rng.random() < 0.75:
        solid = np.concatenate([part.vertices for part in parts])
        parts.append(_labelled(wall_behind(rng, solid, floor), WALL))
    parts.append(_labelled(floor_at(floor), FLOOR))
    points, seen, cut = _photograph(join(parts), camera, rng)

    touching: dict[int, set[int]] = {label: set() for label in labels}
    for first, second in touching_pairs([thing.mesh for thing in things]):
        touching[labels[first]].add(labels[second])
        touching[labels[second]].add(labels[first])
    # Only what is visible has a number, and there are no gaps between the numbers.
    visible = [label for label in labels if (seen == label).any()]
    number = dict(zip(visible, labels, strict=False))
    renumbered = seen.copy()
    for old, new in number.items():
        renumbered[seen == old] = new
    objects = tuple(
        SceneObject(
            label=number[label],
            category=thing.category,
            n_points=int((seen == label).sum()),
            is_thin=thing.height <= THIN,
            is_cut=label in cut,
            touching=frozenset(number[other] for other in touching[label] if other in number),
        )
        for thing, label in zip(things, labels, strict=True)
        if label in number
    )
    return SimulatedScene(
        points,
        viewpoint=np.zeros(3),
        up=camera.up if rng.random() < 0.5 else None,
        name=name,
        point_labels=renumbered,
        true_up=camera.up,
        objects=objects,
    )


def _tables(rng: np.random.Generator, floor: float) -> list[Table]:
    # From the middle of a large table, no edge of it may be visible, nor another one.
    kind = rng.choice(["one", "large", "two"], p=[0.4, 0.25, 0.35])
    table = draw_table(rng, floor, kind == "large")
    half_size = np.ptp(table.outline, axis=0) / 2.0
    tables = [on_table(table, rng.uniform(-_OFF_MIDDLE, _OFF_MIDDLE, 2) * half_size)]
    if kind == "two":
        difference = rng.choice([-1.0, 1.0]) * rng.uniform(0.06, 0.25)
        tables.append(beside(rng, draw_table(rng, floor - difference, False), tables[0], difference))
    return tables


def _labelled(mesh: Mesh, label: int) -> Mesh:
    return mesh._replace(face_labels=np.full(len(mesh.faces), label, dtype=np.int64))


def _photograph(
    mesh: Mesh, camera: Camera, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.int64], set[int]]:
    """Points (h, w, 3) and labels (h, w) that the sensor reads, and the labels at the image's border."""
    vertices = camera.to_camera(mesh.vertices)
    in_front = (vertices[mesh.faces, 2] > _NEAREST_VERTEX).all(axis=1)
    faces, face_labels = mesh.faces[in_front], mesh.face_labels[in_front]
    # A vertex behind the camera has no place in the image.
    vertices[vertices[:, 2] <= _NEAREST_VERTEX] = (0.0, 0.0, 1.0)
    image = _whole_image(render(vertices, faces, KINECT))
    exact = np.where(image.triangles >= 0, face_labels[image.triangles], 0)
    border = np.concatenate([exact[0], exact[-1], exact[:, 0], exact[:, -1]])
    triangles, depth = measure(image, vertices, faces, KINECT, rng)
    measured = (triangles >= 0) & (depth > _RANGE[0]) & (depth < _RANGE[1])
    flying = let_fly(depth, measured, rng)
    depth[measured] = KINECT.quantise(depth[measured])
    depth[~measured] = np.nan
    rows, columns = np.indices(depth.shape)
    points = np.stack(
        [
            (columns - KINECT.center_x) / KINECT.focal_length * depth,
            (rows - KINECT.center_y) / KINECT.focal_length * depth,
            depth,
        ],
        axis=-1,
    )
    labels = np.where(measured & ~flying, face_labels[triangles], 0)
    return points, labels, set(border.tolist())


def _whole_image(image: DepthImage) -> DepthImage:
    """The image with the pixels around the part that holds something."""
    triangles = np.full((KINECT.height, KINECT.width), -1, dtype=np.int32)
    inverse_depth = np.zeros((KINECT.height, KINECT.width))
    rows = slice(image.row, image.row + image.triangles.shape[0])
    columns = slice(image.column, image.column + image.triangles.shape[1])
    triangles[rows, columns] = image.triangles
    inverse_depth[rows, columns] = image.inverse_depth
    return DepthImage(triangles, inverse_depth, 0, 0)
