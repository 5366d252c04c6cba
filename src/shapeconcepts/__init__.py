"""Learns what shapes a set of scanned objects have in common, without labels."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from shapeconcepts.scan import Scan, ScanError

if TYPE_CHECKING:
    from shapeconcepts import datasets
    from shapeconcepts.descriptors import FPFH, DescribedObject, Surflet, describe, get_descriptor
    from shapeconcepts.io import ScanWarning, read_scan, read_scans
    from shapeconcepts.motifs import MotifHierarchyEnsemble, SegmentDictionary, decompose
    from shapeconcepts.segmentation import SegmentedObject, segment

__version__ = "0.1.0"

__all__ = [
    "FPFH",
    "DescribedObject",
    "MotifHierarchyEnsemble",
    "Scan",
    "ScanError",
    "ScanWarning",
    "SegmentDictionary",
    "SegmentedObject",
    "Surflet",
    "__version__",
    "datasets",
    "decompose",
    "describe",
    "get_descriptor",
    "read_scan",
    "read_scans",
    "segment",
]

# numba takes longer to import than everything else together: these are imported when they are first used.
_HOME_OF = {
    "DescribedObject": ".descriptors",
    "FPFH": ".descriptors",
    "MotifHierarchyEnsemble": ".motifs",
    "ScanWarning": ".io",
    "SegmentDictionary": ".motifs",
    "SegmentedObject": ".segmentation",
    "Surflet": ".descriptors",
    "decompose": ".motifs",
    "describe": ".descriptors",
    "get_descriptor": ".descriptors",
    "read_scan": ".io",
    "read_scans": ".io",
    "segment": ".segmentation",
}


def __getattr__(name: str) -> Any:
    if name == "datasets":
        return import_module(".datasets", __name__)
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME_OF[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
