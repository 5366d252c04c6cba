"""The stimuli of single prototypes once more, as the formula is written, with bounds on what rounding may do.

The kernels hold square roots of histograms in single precision. Histogram and root are each rounded by 2^-24
at most, so a product of two roots is off by less than 3 * 2^-24 of itself, and so is their sum, which is 1 at
most. A stimulus falls with the divergence and rises with both bandwidths: its bounds are its values at the
ends of theirs.
"""

import math
from dataclasses import dataclass

from motif_reference import SlowEnsemble, SlowObject, decompose

DIVERGENCE_ERROR = 3 * 2**-24
SMALLEST_STIMULUS = 1e-3
# Of the sums, which the kernel adds up in another order and from kernels rounded to 2^-40.
SUM_ERROR = 1e-9


@dataclass
class Constellation:
    """Segments, histogram, and the motif of each dictionary level: what identifies it there."""

    segments: frozenset
    histogram: list[float]
    motifs: tuple


@dataclass
class Bounds:
    low: float
    high: float

    def hold(self, value: float) -> bool:
        return self.low - SUM_ERROR <= value <= self.high + SUM_ERROR


def constellations_of(obj: SlowObject, slow: SlowEnsemble) -> list[Constellation]:
    motifs_of = slow.motifs_of(obj)
    return [
        Constellation(segments, obj.histogram(segments), tuple(motif_of[segments] for motif_of in motifs_of))
        for segments in decompose(obj.edges, len(obj.segments))
    ]


def hellinger(p: list[float], q: list[float]) -> float:
    """Squared Hellinger distance; exactly 1 where nothing is shared."""
    return max(1 - math.fsum(math.sqrt(a * b) for a, b in zip(p, q, strict=True)), 0.0)


class SlowField:
    """Prototypes (object, constellation) in any order, and their scales."""

    def __init__(
        self,
        objects: list[list[Constellation]],
        n_neighbours: int,
        width: float = 0.35,
        resolution: float = 0.05,
    ) -> None:
        self.n_neighbours, self.width, self.resolution = n_neighbours, width, resolution
        self.prototypes = [
            (index, constellation) for index, parts in enumerate(objects) for constellation in parts
        ]
        self.scales = [self.scale(constellation, index) for index, constellation in self.prototypes]

    def scale(self, constellation: Constellation, left_out: int) -> float:
        divergences = sorted(
            hellinger(constellation.histogram, prototype.histogram)
            for index, prototype in self.prototypes
            if index != left_out
        )
        if not divergences:
            return self.resolution
        return max(divergences[: self.n_neighbours][-1], self.resolution)

    def stimuli(self, constellation: Constellation, left_out: int = -1) -> dict[tuple, Bounds]:
        """Of each prototype (object, segments) that counts."""
        own_scale = self.scale(constellation, left_out)
        result = {}
        for (index, prototype), scale in zip(self.prototypes, self.scales, strict=True):
            if index == left_out:
                continue
            divergence = hellinger(constellation.histogram, prototype.histogram)
            same = [a == b for a, b in zip(constellation.motifs, prototype.motifs, strict=True)]
            share = (1 + sum(same)) / (1 + len(same))
            low, high = (
                share * kernel(divergence + error, scale - error, own_scale - error, self)
                for error in (DIVERGENCE_ERROR, -DIVERGENCE_ERROR)
            )
            if divergence == 1 or high < SMALLEST_STIMULUS:
                low = high = 0.0
            elif low < SMALLEST_STIMULUS:
                low = 0.0
            result[index, prototype.segments] = Bounds(low, high)
        return result

    def row(self, parts: list[Constellation], left_out: int = -1) -> dict[tuple, Bounds]:
        """Mean over the constellations of stimuli in parts of their sum."""
        row = {(index, prototype.segments): Bounds(0.0, 0.0) for index, prototype in self.prototypes}
        for constellation in parts:
            stimuli = self.stimuli(constellation, left_out)
            low_sum = math.fsum(bounds.low for bounds in stimuli.values())
            high_sum = math.fsum(bounds.high for bounds in stimuli.values())
            for prototype, bounds in stimuli.items():
                if bounds.high > 0:
                    # Smallest beside the largest of the others, and the other way round.
                    smallest = bounds.low / (bounds.low + max(high_sum - bounds.high, 0.0) or 1.0)
                    largest = bounds.high / (bounds.high + max(low_sum - bounds.low, 0.0))
                    row[prototype].low += smallest / len(parts)
                    row[prototype].high += largest / len(parts)
        return row


def kernel(divergence: float, scale: float, own_scale: float, field: SlowField) -> float:
    divergence = min(max(divergence, 0.0), 1.0)
    sigma, own_sigma = (field.width * max(each, field.resolution) for each in (scale, own_scale))
    return math.exp(-(divergence**2) / (2 * sigma * own_sigma))
