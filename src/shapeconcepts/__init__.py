"""Learns what shapes a set of scanned objects have in common, without labels."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from shapeconcepts.version import __version__

if TYPE_CHECKING:
    from shapeconcepts import datasets
    from shapeconcepts.concepts import Concept, ConceptResponse, Filtration
    from shapeconcepts.descriptors import (
        FPFH,
        Curvature,
        DescribedObject,
        Description,
        Joint,
        PointDistances,
        Surflet,
        compute_principal_curvatures,
        describe,
        get_descriptor,
    )
    from shapeconcepts.export import Export, export_scans
    from shapeconcepts.extraction import ExtractedObject, extract_objects
    from shapeconcepts.model import ShapeConceptModel, load_model
    from shapeconcepts.model_file import ModelError
    from shapeconcepts.motifs import MotifHierarchyEnsemble, SegmentDictionary, decompose
    from shapeconcepts.scan import Scan, ScanError, ScanWarning
    from shapeconcepts.scene import Scene
    from shapeconcepts.segmentation import SegmentedObject, Segmenter, segment
    from shapeconcepts.sources import read_scan, read_scans, read_scene
    from shapeconcepts.topology import TopologicalSpace

__all__ = [
    "FPFH",
    "Concept",
    "ConceptResponse",
    "Curvature",
    "DescribedObject",
    "Description",
    "Export",
    "ExtractedObject",
    "Filtration",
    "Joint",
    "ModelError",
    "MotifHierarchyEnsemble",
    "PointDistances",
    "Scan",
    "ScanError",
    "ScanWarning",
    "Scene",
    "SegmentDictionary",
    "SegmentedObject",
    "Segmenter",
    "ShapeConceptModel",
    "Surflet",
    "TopologicalSpace",
    "__version__",
    "compute_principal_curvatures",
    "datasets",
    "decompose",
    "describe",
    "export_scans",
    "extract_objects",
    "get_descriptor",
    "load_model",
    "read_scan",
    "read_scans",
    "read_scene",
    "segment",
]

# numba and scikit-learn take a second to import, numpy a tenth of one: what needs them is imported when it is
# first used, and so are the packages themselves.
_NAMES_IN = {
    "concepts": ("Concept", "ConceptResponse", "Filtration"),
    "descriptors": (
        "FPFH",
        "Curvature",
        "DescribedObject",
        "Description",
        "Joint",
        "PointDistances",
        "Surflet",
        "compute_principal_curvatures",
        "describe",
        "get_descriptor",
    ),
    "extraction": ("ExtractedObject", "extract_objects"),
    "export": ("Export", "export_scans"),
    "model": ("ShapeConceptModel", "load_model"),
    "model_file": ("ModelError",),
    "motifs": ("MotifHierarchyEnsemble", "SegmentDictionary", "decompose"),
    "scan": ("Scan", "ScanError", "ScanWarning"),
    "scene": ("Scene",),
    "segmentation": ("SegmentedObject", "Segmenter", "segment"),
    "sources": ("read_scan", "read_scans", "read_scene"),
    "topology": ("TopologicalSpace",),
}
_PACKAGES = ("datasets", "evaluation", "io", "preparation", "recordings", "report", "simulation", *_NAMES_IN)
_HOME_OF = {name: home for home, names in _NAMES_IN.items() for name in names}


def __getattr__(name: str) -> Any:
    if name in _HOME_OF:
        value = getattr(import_module(f".{_HOME_OF[name]}", __name__), name)
        globals()[name] = value
        return value
    if name in _PACKAGES:
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
