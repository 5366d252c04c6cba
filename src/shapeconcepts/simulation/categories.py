"""Simulated scans of the paper's seven categories."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.simulation.seeds import check_count, seed_of
from shapeconcepts.simulation.sensor import scan_mesh
from shapeconcepts.simulation.shapes import SHAPES

CATEGORIES = tuple(SHAPES)

_OCCLUDED_SHARE = 1.0 / 3.0
_LARGEST_OCCLUSION = 1.0 / 3.0
_FEWEST_POINTS = 400
_MOST_VIEWS = 30


def simulate(
    n_per_category: int = 66,
    *,
    categories: Sequence[str] | None = None,
    random_state: int | np.random.Generator | None = 0,
) -> list[Scan]:
    """Kinect-like scans of random objects, each from one random view.

    The objects measure about 4 to 40 cm and differ in proportions, deformation, details and pose. They are
    seen from 0.6 to 1.6 m and 10° to 60° above the horizon; a third is partly occluded.

    Parameters
    ----------
    n_per_category : int
        Scans of each category. The i-th scan of a category does not depend on this number.
    categories : sequence of str, optional
        Some of "sack", "can", "box", "teddy", "ball", "amphora" and "plate". By default all of them.
    random_state : int, numpy.random.Generator or None
        Seed. A generator is advanced by one draw; None draws anew each time.

    Returns
    -------
    list of Scan
        Category by category, named like "box_12" (from 0). `point_labels` holds the true surface part of each
        point; `PART_NAMES[scan.label]` names the parts.

    Raises
    ------
    ValueError
        If a parameter is not as described; the message names it and its value.
    """
    check_count("n_per_category", n_per_category)
    categories = CATEGORIES if categories is None else _checked(categories)
    seed = seed_of(random_state)
    return [
        simulate_scan(category, index, random_state=seed)
        for category in categories
        for index in range(n_per_category)
    ]


def simulate_scan(category: str, index: int, *, random_state: int = 0) -> Scan:
    """One of the scans of `simulate`, without the others.

    Parameters
    ----------
    category : str
        As in `simulate`.
    index : int
        Number of the scan within its category, from 0.
    random_state : int
        Seed given to `simulate`.

    Returns
    -------
    Scan

    Raises
    ------
    ValueError
        If a parameter is not as described; the message names it and its value.
    """
    [category] = _checked([category])
    check_count("index", index)
    check_count("random_state", random_state)
    seed = np.random.SeedSequence(random_state, spawn_key=(CATEGORIES.index(category), index))
    rng = np.random.default_rng(seed)
    mesh = SHAPES[category](rng)
    occlusion = rng.uniform(0.1, _LARGEST_OCCLUSION) if rng.random() < _OCCLUDED_SHARE else 0.0
    for _ in range(_MOST_VIEWS):
        try:
            scan = scan_mesh(
                *mesh[:2],
                face_labels=mesh.face_labels,
                occlusion=occlusion,
                random_state=rng,
                name=f"{category}_{index}",
                label=category,
            )
        except ScanError:
            # What stands in front can put all of it into the projector's shadow.
            continue
        if len(scan) >= _FEWEST_POINTS:
            return scan
    raise ScanError(f"{category}_{index}: fewer than {_FEWEST_POINTS} points in each of {_MOST_VIEWS} views")


def _checked(categories: Sequence[str]) -> tuple[str, ...]:
    # A string is a sequence of strings too.
    if isinstance(categories, str) or not isinstance(categories, Iterable):
        raise ValueError(
            f"categories must be a sequence of names, such as ['box', 'can'], got {categories!r}"
        )
    names = tuple(categories)
    for name in names:
        if not isinstance(name, str) or name not in CATEGORIES:
            raise ValueError(
                f"categories: unknown category {name!r}, expected some of {', '.join(CATEGORIES)}"
            )
    return names
