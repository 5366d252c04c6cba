"""Keeps described objects in a folder, so that the same segments are not described twice."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.descriptors.described_object import DescribedObject, DescribedOcclusion
from shapeconcepts.descriptors.protocol import Description
from shapeconcepts.io.array_cache import ArrayCache, code_fingerprint, with_prefix
from shapeconcepts.segmentation.segment_cache import SOURCES, SegmentCache


@dataclass(frozen=True)
class DescriptionCache(ArrayCache):
    """Described objects with their imagined occlusions, an entry for each scan or scene; see `ArrayCache`."""

    @classmethod
    def beside(cls, segments: SegmentCache) -> DescriptionCache:
        """The cache in the folder beside that of the segments."""
        return cls(
            segments.folder.with_name("descriptions"), code_fingerprint((*SOURCES, "descriptors/*.py"))
        )

    def load(self, key: str) -> list[DescribedObject] | None:
        """The objects of an entry, without names and labels; None where there is none, or it is damaged."""
        kept = self.load_arrays(key)
        if kept is None:
            return None
        return [_unpack(arrays) for arrays in kept]

    def store(self, key: str, objects: list[DescribedObject]) -> None:
        """Keep objects, without their names and labels.

        Raises
        ------
        OSError
            If the folder cannot be written.
        """
        self.store_arrays(key, [_pack(one) for one in objects])


def _pack(one: DescribedObject) -> dict[str, NDArray[Any]]:
    arrays = {field.name: np.asarray(getattr(one.description, field.name)) for field in fields(Description)}
    arrays["segment_edges"] = one.segment_edges
    arrays["n_occlusions"] = np.array(len(one.occlusions))
    for number, (rest, segments) in enumerate(one.occlusions):
        arrays[f"occlusion{number}/segments"] = segments
        arrays |= {f"occlusion{number}/{name}": array for name, array in _pack(rest).items()}
    return arrays


def _unpack(arrays: dict[str, NDArray[Any]]) -> DescribedObject:
    parts = {field.name: arrays[field.name] for field in fields(Description)}
    blocks = tuple(parts.pop("blocks").astype(int).tolist())
    occlusions = []
    for number in range(int(arrays["n_occlusions"])):
        rest = with_prefix(f"occlusion{number}/", arrays)
        occlusions.append(DescribedOcclusion(_unpack(rest), rest["segments"]))
    return DescribedObject(
        Description(**parts, blocks=blocks), arrays["segment_edges"], occlusions=tuple(occlusions)
    )
