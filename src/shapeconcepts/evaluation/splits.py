"""Splits into training and test objects with the same share of every label."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.parameters import check_integer

Split = tuple[NDArray[np.int64], NDArray[np.int64]]


def stratified_splits(
    labels: ArrayLike,
    n_repeats: int,
    test_share: float = 0.25,
    random_state: int | np.random.Generator | None = None,
    instances: ArrayLike | None = None,
) -> list[Split]:
    """Random splits in which every label has the same share of test objects, as far as counts allow.

    Parameters
    ----------
    labels : (n,) array-like of str
        At least two objects each.
    n_repeats : int
        Number of independent splits.
    test_share : float
        Between 0 and 1.
    random_state : int, Generator or None
    instances : (n,) array-like, optional
        Which physical object was scanned, within its label. All scans of one stay on one side: the test share
        is then met as nearly as adding instances in random order allows. A label with a single instance goes
        to training, any other is on both sides.

    Returns
    -------
    list of (training, test)
        Sorted indices, int64.

    Raises
    ------
    ValueError
        If a label has fewer than two objects, no label has two instances, lengths differ, or a parameter is
        out of its range.
    """
    check_integer("n_repeats", n_repeats, 1)
    if not 0 < test_share < 1:
        raise ValueError(f"test_share must be between 0 and 1, got {test_share!r}")
    units = _units_by_label(labels, instances)
    if all(len(of_label) < 2 for of_label in units):
        raise ValueError("instances must be at least two of at least one label, got one for every label")
    rng = np.random.default_rng(random_state)
    splits = []
    for _ in range(n_repeats):
        is_test = np.zeros(len(np.asarray(labels)), bool)
        for of_label in units:
            for unit in _test_units(of_label, test_share, rng):
                is_test[unit] = True
        splits.append((np.flatnonzero(~is_test), np.flatnonzero(is_test)))
    return splits


def _units_by_label(labels: ArrayLike, instances: ArrayLike | None) -> list[list[NDArray[np.int64]]]:
    """For each label, the objects that must stay together."""
    names = np.asarray(labels)
    if names.ndim != 1 or len(names) == 0:
        raise ValueError(f"labels must be a sequence of at least one, got shape {names.shape}")
    of_whom = np.arange(len(names)) if instances is None else np.asarray(instances)
    if of_whom.shape != names.shape:
        raise ValueError(f"instances must be one for each of {len(names)} labels, got shape {of_whom.shape}")
    units = []
    for label in np.unique(names):
        members = np.flatnonzero(names == label)
        if len(members) < 2:
            raise ValueError(
                f"every label must have at least two objects to be split, {str(label)!r} has one"
            )
        of_member = np.unique(of_whom[members], return_inverse=True)[1]
        units.append([members[of_member == unit] for unit in range(of_member.max() + 1)])
    return units


def _test_units(
    units: list[NDArray[np.int64]], test_share: float, rng: np.random.Generator
) -> list[NDArray[np.int64]]:
    """Take units in random order, each if it brings the number of objects nearer to the wanted one."""
    if len(units) < 2:
        return []
    wanted = test_share * sum(map(len, units))
    shuffled = [units[k] for k in rng.permutation(len(units))]
    taken: list[NDArray[np.int64]] = []
    missing = wanted
    for unit in shuffled:
        if abs(missing - len(unit)) < abs(missing) and len(taken) < len(units) - 1:
            taken.append(unit)
            missing -= len(unit)
    return taken or [min(shuffled, key=len)]
