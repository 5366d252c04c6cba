"""What a descriptor is, and the additive description it makes of an object."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.segmentation.segmented_object import SegmentedObject

MAX_SEGMENTS = 64


@dataclass(frozen=True, eq=False)
class Description:
    """Histograms of an object's segments that add up to the histogram of any set of segments.

    A set of segments is a *constellation*: an unsigned integer whose bit i stands for segment i.

    Parameters
    ----------
    segment_histograms : (s, b) float64 or float32
        Mass that each segment brings along, not normalised. At most 64 segments.
    pairs : (p, 2) int32
        Pairs of segments that bring mass only together. Empty for most descriptors.
    pair_histograms : (p, b) float64 or float32
        Mass of each pair.
    blocks : tuple of int
        Bins of each of several histograms that stand side by side, from the first bin on. Each of them has an
        equal share in the histogram of a constellation. Empty: there is one.

    Raises
    ------
    ValueError
        If the shapes do not fit, or there are more than 64 segments.
    """

    segment_histograms: NDArray[np.float64]
    pairs: NDArray[np.int32] = field(default_factory=lambda: np.empty((0, 2), np.int32))
    pair_histograms: NDArray[np.float64] | None = None
    blocks: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.segment_histograms.ndim != 2:
            raise ValueError(
                f"segment_histograms must have shape (s, b), got {self.segment_histograms.shape}"
            )
        if self.n_segments > MAX_SEGMENTS:
            raise ValueError(f"a description holds at most {MAX_SEGMENTS} segments, got {self.n_segments}")
        if self.pair_histograms is None:
            object.__setattr__(self, "pair_histograms", np.empty((0, self.n_bins)))
        expected = (len(self.pairs), self.n_bins)
        if self._pair_histograms.shape != expected or self.pairs.shape != (len(self.pairs), 2):
            raise ValueError(
                f"pairs must have shape (p, 2) and pair_histograms (p, {self.n_bins}), "
                f"got {self.pairs.shape} and {self._pair_histograms.shape}"
            )
        if len(self.pairs) and not (self.pairs.min() >= 0 and self.pairs.max() < self.n_segments):
            raise ValueError(
                f"pairs must name segments 0 to {self.n_segments - 1}, got {self.pairs.tolist()}"
            )
        if self.blocks and (min(self.blocks) < 1 or sum(self.blocks) != self.n_bins):
            raise ValueError(f"blocks must be numbers of bins that sum to {self.n_bins}, got {self.blocks}")

    @property
    def n_segments(self) -> int:
        """Number of segments, s."""
        return len(self.segment_histograms)

    @property
    def n_bins(self) -> int:
        """Number of bins, b."""
        return self.segment_histograms.shape[1]

    @property
    def _pair_histograms(self) -> NDArray[np.float64]:
        assert self.pair_histograms is not None
        return self.pair_histograms

    def histograms(self, constellations: ArrayLike) -> NDArray[np.float64]:
        """Histograms of constellations: a sum over segments and pairs, without a pass over points.

        Parameters
        ----------
        constellations : array-like of unsigned int of shape (k,)
            Bit i stands for segment i.

        Returns
        -------
        (k, b) float64
            Rows that sum to 1, or are all zero where a constellation has no mass (no segments, or only
            isolated points). A row does not depend on the other rows, to the last bit.

        Raises
        ------
        ValueError
            If a constellation is negative or names a segment that is not there.
        """
        masks = self._as_masks(constellations)
        members = (masks[:, None] >> np.arange(self.n_segments, dtype=np.uint64)) & np.uint64(1)
        weights = members.astype(np.float64)
        total = np.zeros((len(masks), self.n_bins))
        # A matrix product would be shorter, but its rounding depends on how many rows there are.
        for segment, histogram in enumerate(self.segment_histograms):
            total += weights[:, segment, None] * histogram
        # Side by side with others, a descriptor of pairs fills some columns only.
        filled = np.flatnonzero(self._pair_histograms.any(axis=0))
        columns = slice(filled[0], filled[-1] + 1) if len(filled) else slice(0)
        for (a, b), histogram in zip(self.pairs, self._pair_histograms[:, columns], strict=True):
            total[:, columns] += (weights[:, a] * weights[:, b])[:, None] * histogram
        for block in np.split(total, np.cumsum(self.blocks)[:-1], axis=1) if self.blocks else ():
            _scale_to_one(block)
        _scale_to_one(total)
        return total

    def in_single_precision(self) -> Description:
        """The same, to 24 bits, in half the memory."""
        return replace(
            self,
            segment_histograms=self.segment_histograms.astype(np.float32),
            pair_histograms=self._pair_histograms.astype(np.float32),
        )

    def whole(self) -> NDArray[np.float64]:
        """Histogram of all segments together, (b,) float64; zero where there is no mass."""
        return self.histograms([(1 << self.n_segments) - 1])[0]

    def _as_masks(self, constellations: ArrayLike) -> NDArray[np.uint64]:
        values = np.asarray(constellations, dtype=object).ravel().tolist()
        for value in values:
            if not isinstance(value, (int, np.integer)) or not 0 <= value < 1 << self.n_segments:
                raise ValueError(
                    f"constellations must be bitmasks of segments 0 to {self.n_segments - 1}, got {value!r}"
                )
        return np.array(values, dtype=np.uint64)


def _scale_to_one(rows: NDArray[np.float64]) -> None:
    """Scale rows to sum 1 in place; rows without mass stay."""
    mass = rows.sum(axis=1, keepdims=True)
    np.divide(rows, mass, out=rows, where=mass > 0)


@runtime_checkable
class Descriptor(Protocol):
    """Describes the segments of an object by histograms that add up.

    Any object with this one method is a descriptor. The histograms it returns are masses, larger for larger
    segments, so that the sum over segments is the histogram of their union. What segments have to do with
    each other goes into the histograms of pairs.

    Examples
    --------
    How far the points of each segment lie from the object's centroid, in eight bins:

    >>> class CentroidDistance:
    ...     def describe(self, segmented):
    ...         offsets = segmented.points - segmented.points.mean(axis=0)
    ...         distances = np.linalg.norm(offsets, axis=1)
    ...         bins = np.minimum((8 * distances / distances.max()).astype(int), 7)
    ...         histograms = np.zeros((segmented.n_segments, 8))
    ...         kept = segmented.segment_labels >= 0
    ...         np.add.at(histograms, (segmented.segment_labels[kept], bins[kept]), 1)
    ...         return Description(histograms)
    """

    def describe(self, segmented: SegmentedObject) -> Description:
        """Histograms of the segments of an object."""
        ...
