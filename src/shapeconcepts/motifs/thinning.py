"""Prototypes that say something new: of ever more constellations, those that stand for all the others."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.motifs.hierarchy import N_OTHERS, MotifHierarchies
from shapeconcepts.parallel import libraries_in_one_thread, map_in_order

# Times the resolution. Beyond one, noise alone makes a few in a hundred constellations new, beyond two a few
# in a thousand, and there is still much of what a new kind shows.
_NEW = 2.0
# However many there are, a later kind finds room: a part of the sample.
_ALWAYS_NEW = 4
# Fixed, as the rounding of a matrix product depends on how many rows there are.
_AT_ONCE = 4096


class Thinning(NamedTuple):
    """Which prototypes are kept, and what these stand for.

    Attributes
    ----------
    kept : (k,) int64
        Rising.
    stands_for : (p,) int64
        Position in `kept` of the prototype that stands for each: the nearest, or itself.
    by_draw : (p,) int64
        All prototypes in the order of their `draws`.
    """

    kept: NDArray[np.int64]
    stands_for: NDArray[np.int64]
    by_draw: NDArray[np.int64]

    @classmethod
    def of(
        cls,
        histograms: NDArray[np.float32],
        n_known: int,
        n_most: int,
        resolution: float,
        n_jobs: int | None = None,
    ) -> Thinning:
        """Choose among prototypes.

        Known ones are kept. Without any, a sample that follows how frequent they are is: it converges with
        ever more prototypes, and rows of stimuli with it. What differs from all of these by more than twice
        the resolution is new, however rare it is: it is kept, too, and stands for what is near to it.

        Parameters
        ----------
        histograms : (p, b) float32
        n_known : int
            How many of the first are known.
        n_most : int
            Size of the sample, and most new ones beside a sample. Beside known ones, so many that there are
            twice as many in all, and in any case a quarter of it. Beyond these, the nearest stands for what
            is new.
        resolution : float
            Squared Hellinger distance.
        n_jobs : int or None
            As in joblib. The result does not depend on it.
        """
        by_draw = np.argsort(draws(histograms), kind="stable")
        known = np.arange(n_known) if n_known else np.sort(by_draw[:n_most])
        n_new = max(2 * n_most - len(known), n_most // _ALWAYS_NEW)
        with libraries_in_one_thread():
            behind, divergences = _nearest(histograms, histograms, known, n_jobs)
            is_new = divergences > _NEW * resolution
            is_new[known] = False
            far = by_draw[is_new[by_draw]]
            new = _apart(histograms, far, _NEW * resolution, n_new)
            if len(new):
                nearest, to_new = _nearest(histograms[far], histograms, new, n_jobs)
                behind[far] = np.where(to_new < divergences[far], nearest, behind[far])
        kept = np.sort(np.concatenate([known, new]))
        behind[kept] = kept
        return cls(kept, np.searchsorted(kept, behind), by_draw)

    def applied(self, hierarchies: MotifHierarchies) -> MotifHierarchies:
        """Hierarchies with these prototypes, that know what they stand for."""
        kept = self.kept
        return replace(
            hierarchies,
            prototypes=hierarchies.prototypes[kept],
            prototype_vertices=hierarchies.prototype_vertices[kept],
            prototype_objects=hierarchies.prototype_objects[kept],
            prototype_constellations=hierarchies.prototype_constellations[kept],
            prototype_counts=_sums(self.stands_for, hierarchies.prototype_counts, len(kept)),
            prototype_others=self._others(hierarchies),
        )

    def _others(self, hierarchies: MotifHierarchies) -> NDArray[np.int32]:
        """Some objects behind each prototype besides its own: those known before, then by their draws."""
        before, behind = hierarchies.prototype_others, self.stands_for[self.by_draw]
        positions = np.concatenate([np.repeat(self.stands_for, N_OTHERS), behind])
        objects = np.concatenate([before.ravel(), hierarchies.prototype_objects[self.by_draw]])
        is_other = (objects >= 0) & (objects != hierarchies.prototype_objects[self.kept][positions])
        positions, objects = positions[is_other], objects[is_other]
        # The first of each pair, in their order, and of each prototype the first few.
        _, first = np.unique(positions * np.int64(hierarchies.n_objects) + objects, return_index=True)
        first = np.sort(first)
        in_order = first[np.argsort(positions[first], kind="stable")]
        starts = np.searchsorted(positions[in_order], positions[in_order])
        rank = np.arange(len(in_order)) - starts
        others = np.full((len(self.kept), N_OTHERS), -1, np.int32)
        in_order, rank = in_order[rank < N_OTHERS], rank[rank < N_OTHERS]
        others[positions[in_order], rank] = objects[in_order]
        return others


def draws(histograms: NDArray[np.float32]) -> NDArray[np.int64]:
    """A number for each prototype that a hash of its content draws: it is random, and knows no order.

    Parameters
    ----------
    histograms : (p, b) float32

    Returns
    -------
    (p,) int64
    """
    # Of thousandths, as last bits differ between processors.
    return np.array([crc32(np.round(1000 * row).astype("<i2").tobytes()) for row in histograms], np.int64)


def _roots(histograms: NDArray[np.float32]) -> NDArray[np.float32]:
    """Square roots, with a bin of its own for what has no mass: it is like what has none, either."""
    has_none = ~histograms.any(axis=1, keepdims=True)
    return np.concatenate([np.sqrt(histograms), has_none.astype(np.float32)], axis=1)


def _nearest(
    histograms: NDArray[np.float32],
    prototypes: NDArray[np.float32],
    among: NDArray[np.int64],
    n_jobs: int | None,
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """The nearest of some prototypes for each histogram, and the squared Hellinger distance to it."""
    nearest_in = partial(_nearest_in_block, _roots(prototypes[among]).T)
    blocks = [histograms[start : start + _AT_ONCE] for start in range(0, len(histograms), _AT_ONCE)]
    found = list(map_in_order(nearest_in, blocks, n_jobs, share_memory=True))
    positions, divergences = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return among[positions], divergences


def _nearest_in_block(
    among: NDArray[np.float32], histograms: NDArray[np.float32]
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    affinities = _roots(histograms) @ among
    nearest = affinities.argmax(axis=1)
    return nearest, np.float32(1) - affinities[np.arange(len(nearest)), nearest]


def _apart(
    histograms: NDArray[np.float32], candidates: NDArray[np.int64], distance: float, n_most: int
) -> NDArray[np.int64]:
    """Of candidates, one after the other, those that are farther than a distance from all taken before."""
    taken = np.empty((min(n_most, len(candidates)), histograms.shape[1] + 1), np.float32)
    chosen: list[int] = []
    for candidate in candidates.tolist():
        if len(chosen) == len(taken):
            break
        root = _roots(histograms[candidate : candidate + 1])[0]
        if 1 - (taken[: len(chosen)] @ root).max(initial=0.0) > distance:
            taken[len(chosen)] = root
            chosen.append(candidate)
    return np.array(chosen, np.int64)


def _sums(groups: NDArray[np.int64], counts: NDArray[np.int64], n_groups: int) -> NDArray[np.int64]:
    sums = np.zeros(n_groups, np.int64)
    np.add.at(sums, groups, counts)
    return sums
