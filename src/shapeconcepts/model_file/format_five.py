"""Files of format 5, in which parameters stood one by one, in five sets."""

from __future__ import annotations

from typing import Any

from shapeconcepts.concepts import ConceptResponse, Filtration
from shapeconcepts.model_file.error import require
from shapeconcepts.model_file.parameters import encode_parameters
from shapeconcepts.motifs import MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.segmentation import Segmenter

_DESCRIPTORS = {"fpfh": "FPFH", "surflet": "Surflet", "curvature": "Curvature"}


def in_present_format(description: dict[str, Any]) -> dict[str, Any]:
    """The description of a file of format 5 as it would be written today.

    Raises
    ------
    ModelError
        If a set of parameters is missing; what is in them is checked as in any file.
    """
    sets = {}
    for name in ("", "dictionary_", "ensemble_", "filtration_", "response_"):
        sets[name] = description.pop(f"{name}parameters", None)
        found = sets[name]
        require(isinstance(found, dict), f"{name}parameters must be a JSON object, got {found!r:.60}")
    whole, ensemble = sets[""], dict(sets["ensemble_"])
    descriptor = ensemble.pop("descriptor", None)
    if isinstance(descriptor, dict):
        descriptor = {**descriptor, "type": _DESCRIPTORS.get(str(descriptor.get("type")))}
    dictionary = {**encode_parameters(SegmentDictionary()), **sets["dictionary_"]}
    segmenting = {name: whole.get(name) for name in ("voxel_size", "seed_size", "max_segments")}
    description["stages"] = {
        "segmenter": {**encode_parameters(Segmenter()), **segmenting},
        "descriptor": descriptor,
        "ensemble": {**encode_parameters(MotifHierarchyEnsemble()), **ensemble, "dictionary": dictionary},
        "filtration": {**encode_parameters(Filtration()), **sets["filtration_"]},
        "response": {**encode_parameters(ConceptResponse()), **sets["response_"]},
    }
    return description
