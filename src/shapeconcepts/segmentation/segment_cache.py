"""Keeps segmented objects in a folder, so that the same scan is not segmented twice."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.io.array_cache import ArrayCache, code_fingerprint
from shapeconcepts.io.user_cache_folder import user_cache_folder
from shapeconcepts.segmentation.segmented_object import SegmentedObject

# What a segmented object depends on, apart from the scan and the parameters.
SOURCES = (
    "scan.py",
    "kernels.py",
    "geometry/*.py",
    "io/*.py",
    "simulation/**/*.py",
    "sources/*.py",
    "preparation/*.py",
    "segmentation/*.py",
)


@dataclass(frozen=True)
class SegmentCache(ArrayCache):
    """Segmented objects, an entry for each scan or labelled scene; see `ArrayCache`."""

    @classmethod
    def of_user(cls) -> SegmentCache:
        """The cache in the user's own cache folder.

        Raises
        ------
        OSError
            If the user has no home folder.
        """
        return cls(user_cache_folder() / "segments", code_fingerprint(SOURCES))

    def load(self, key: str) -> list[SegmentedObject] | None:
        """The objects of an entry; None where there is none, or it is damaged."""
        kept = self.load_arrays(key)
        if kept is None:
            return None
        return [_unpack(arrays) for arrays in kept]

    def store(self, key: str, objects: list[SegmentedObject]) -> None:
        """Keep objects.

        Raises
        ------
        OSError
            If the folder cannot be written.
        """
        self.store_arrays(key, [_pack(one) for one in objects])


def _pack(one: SegmentedObject) -> dict[str, NDArray[Any]]:
    values = {field.name: getattr(one, field.name) for field in fields(one)}
    # An empty tuple is as good as none.
    return {
        name: np.asarray(value)
        for name, value in values.items()
        if value is not None and not (isinstance(value, tuple) and not value)
    }


def _unpack(values: dict[str, NDArray[Any]]) -> SegmentedObject:
    scalars = {name: value.item() for name, value in values.items() if value.ndim == 0}
    texts = {name: tuple(value.tolist()) for name, value in values.items() if value.dtype.kind == "U"}
    return SegmentedObject(**{**values, **texts, **scalars})
