"""Learns what shapes a set of scanned objects have in common, without labels."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shapeconcepts import datasets
    from shapeconcepts.concepts import Concept, ConceptResponse, Filtration
    from shapeconcepts.descriptors import (
        FPFH,
        Curvature,
        DescribedObject,
        Surflet,
        compute_principal_curvatures,
        describe,
        get_descriptor,
    )
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.model_file import ModelError, load_model
    from shapeconcepts.motifs import MotifHierarchyEnsemble, SegmentDictionary, decompose
    from shapeconcepts.scan import Scan, ScanError, ScanWarning
    from shapeconcepts.segmentation import SegmentedObject, segment
    from shapeconcepts.sources import read_scan, read_scans
    from shapeconcepts.topology import TopologicalSpace

__version__ = "0.1.0"

__all__ = [
    "FPFH",
    "Concept",
    "ConceptResponse",
    "Curvature",
    "DescribedObject",
    "Filtration",
    "ModelError",
    "MotifHierarchyEnsemble",
    "Scan",
    "ScanError",
    "ScanWarning",
    "SegmentDictionary",
    "SegmentedObject",
    "ShapeConceptModel",
    "Surflet",
    "TopologicalSpace",
    "__version__",
    "compute_principal_curvatures",
    "datasets",
    "decompose",
    "describe",
    "get_descriptor",
    "load_model",
    "read_scan",
    "read_scans",
    "segment",
]

# numba and scikit-learn take a second to import, numpy a tenth of one: what needs them is imported when it is
# first used.
_HOME_OF = {
    "FPFH": ".descriptors",
    "Concept": ".concepts",
    "ConceptResponse": ".concepts",
    "Curvature": ".descriptors",
    "DescribedObject": ".descriptors",
    "Filtration": ".concepts",
    "ModelError": ".model_file",
    "MotifHierarchyEnsemble": ".motifs",
    "Scan": ".scan",
    "ScanError": ".scan",
    "ScanWarning": ".scan",
    "SegmentDictionary": ".motifs",
    "SegmentedObject": ".segmentation",
    "ShapeConceptModel": ".model",
    "Surflet": ".descriptors",
    "TopologicalSpace": ".topology",
    "compute_principal_curvatures": ".descriptors",
    "decompose": ".motifs",
    "describe": ".descriptors",
    "get_descriptor": ".descriptors",
    "load_model": ".model_file",
    "read_scan": ".sources",
    "read_scans": ".sources",
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
