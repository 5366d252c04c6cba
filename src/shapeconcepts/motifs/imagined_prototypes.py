"""Prototypes as they would be if a part of their object were hidden."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.described_object import DescribedObject
from shapeconcepts.motifs.decomposition import decompose
from shapeconcepts.motifs.hierarchy import MotifHierarchies


class ImaginedPrototypes(NamedTuple):
    """What imagined occlusions leave of prototypes, as far as it tells something new.

    They belong to the object and to the motifs of the prototypes that they are left of, and are neither
    prototypes nor columns of the stimuli themselves: they say what else may remind of an object.

    Attributes
    ----------
    histograms : (i, b) float16
        Rows that sum to 1. Half the precision is enough for what was never seen, and halves its file.
    prototypes : (i,) int32
        The prototype that each is left of.
    """

    histograms: NDArray[np.float16]
    prototypes: NDArray[np.int32]

    @classmethod
    def empty(cls, n_bins: int) -> ImaginedPrototypes:
        """None at all."""
        return cls(np.empty((0, n_bins), np.float16), np.empty(0, np.int32))

    def with_objects(
        self,
        objects: Sequence[DescribedObject],
        hierarchies: MotifHierarchies,
        kept: NDArray[np.int64],
        n_occlusions: int,
        resolution: float,
    ) -> ImaginedPrototypes:
        """These, and those of the objects that the hierarchies saw last.

        Parameters
        ----------
        objects : sequence of DescribedObject
        hierarchies : MotifHierarchies
            After they saw the objects.
        kept : (k,) int64
            Which of their prototypes are kept, rising; what is left of others is not, either.
        n_occlusions : int
            How many occlusions of each object count at most.
        resolution : float
            What differs less from every prototype of its own object tells nothing new, in squared Hellinger
            distance.
        """
        is_kept = np.zeros(len(hierarchies.prototypes), bool)
        is_kept[kept] = True
        before = is_kept[self.prototypes]
        histograms, prototypes = [self.histograms[before]], [self.prototypes[before]]
        numbers = range(hierarchies.n_objects - len(objects), hierarchies.n_objects)
        starts = np.searchsorted(hierarchies.prototype_objects, [*numbers, hierarchies.n_objects])
        for described, start, end in zip(objects, starts[:-1], starts[1:], strict=True):
            own = slice(start, end)
            if not is_kept[own].any():
                continue
            position_of = {
                constellation: start + position
                for position, constellation in enumerate(hierarchies.prototype_constellations[own].tolist())
            }
            roots = np.sqrt(hierarchies.prototypes[own], dtype=np.float64)
            for rest, segments in described.occlusions[:n_occlusions]:
                constellations, _ = decompose(rest.segment_edges, rest.n_segments)
                found = rest.description.histograms(constellations).astype(np.float16)
                # Row by row, as the rounding of a matrix product depends on how many rows there are.
                nearest = np.array(
                    [(1.0 - (roots * np.sqrt(row, dtype=np.float64)).sum(axis=1)).min() for row in found]
                )
                of = np.array([position_of.get(one, -1) for one in _in_whole(constellations, segments)])
                is_new = (nearest >= resolution) & (of >= 0) & is_kept[of] & (found.any(axis=1))
                histograms.append(found[is_new])
                prototypes.append(of[is_new].astype(np.int32))
        positions = np.searchsorted(kept, np.concatenate(prototypes)).astype(np.int32)
        return ImaginedPrototypes(np.concatenate(histograms), positions)

    def beside(
        self, hierarchies: MotifHierarchies, columns: NDArray[np.int64]
    ) -> tuple[MotifHierarchies, NDArray[np.int64]]:
        """Hierarchies in which these are prototypes, too, and the columns with what is left of theirs."""
        joined = replace(
            hierarchies,
            prototypes=np.concatenate([hierarchies.prototypes, self.histograms.astype(np.float32)]),
            prototype_vertices=self._followed(hierarchies.prototype_vertices),
            prototype_objects=self._followed(hierarchies.prototype_objects),
            prototype_constellations=self._followed(hierarchies.prototype_constellations),
        )
        imagined = np.flatnonzero(np.isin(self.prototypes, columns)) + len(hierarchies.prototypes)
        return joined, np.concatenate([columns, imagined])

    def _followed(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of prototypes, and behind them those of the prototypes that these are left of."""
        return np.concatenate([values, values[self.prototypes]])


def _in_whole(constellations: NDArray[np.int64], segments: NDArray[np.int32]) -> list[int]:
    """Constellations of what is left, in segments of the whole object."""
    is_member = (constellations[:, None] >> np.arange(len(segments))) & 1
    return (is_member << segments.astype(np.int64)).sum(axis=1).tolist()
