"""A small model for the tests of model files, files with forged content, and a comparison to the last bit."""

import warnings
from collections.abc import Callable
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse import issparse

from shapeconcepts import DescribedObject, ModelError, Scan, ShapeConceptModel, load_model
from shapeconcepts.descriptors import DescribedOcclusion, Description, Descriptor
from shapeconcepts.descriptors.registry import get_descriptor
from shapeconcepts.model_file.container import read_container, write_container
from shapeconcepts.model_file.layout import widened
from shapeconcepts.parameters import StagesMixin

# Computed when they are first asked for.
LAZY = {
    "_field",
    "_reminder_field",
    "_training_stimuli",
    "rows",
    "prototypes_of",
    "prototype_entropies",
    "_vertex_of",
}


DESCRIPTOR = "distance"
# Columns, heat, stop and responses of the paper, with a bandwidth that suits the objects below.
LIKE_THE_PAPER: dict[str, Any] = {
    "ensemble__columns": "motifs",
    "ensemble__bandwidth": 0.1,
    "filtration__heat": "geodesic",
    "filtration__stop": "annexations",
    "response__distance": "mahalanobis",
}


def described_objects(
    n_per_kind: int, seed: int = 0, descriptor: str | Descriptor = DESCRIPTOR
) -> list[DescribedObject]:
    """Objects of four kinds, with one to four segments in a row, in 12 of the bins of a descriptor."""
    unused = [(0, 0), (0, getattr(get_descriptor(descriptor), "n_bins", 12) - 12)]
    random, hiding = np.random.default_rng(seed), np.random.default_rng((seed, 1))
    objects = []
    for number in range(4 * n_per_kind):
        kind = number % 4
        segments = np.pad(random.random((kind + 1, 12)) * 0.3, unused)
        segments[np.arange(kind + 1), 3 * kind + np.arange(kind + 1) % 3] += 2 + random.random()
        edges = np.array([(i, i + 1) for i in range(kind)], np.int32).reshape(-1, 2)
        label = None if number % 5 == 0 else f"kind {kind}"
        name = f"object {number}"
        # As if a part of the first segment, and all others, were hidden.
        left = np.pad(hiding.random((1, 12)) ** 4, unused)
        rest = DescribedObject(Description(segments[:1] * left), name=name)
        occlusions = (DescribedOcclusion(rest, np.zeros(1, np.int32)),)
        objects.append(DescribedObject(Description(segments), edges, name, label, occlusions))
    return objects


def fitted_model(**parameters: Any) -> ShapeConceptModel:
    """A model of 40 objects, the third of which could not be segmented, with a named concept."""
    descriptor = parameters.pop("descriptor", DESCRIPTOR)
    objects: list[object] = list(described_objects(10, descriptor=descriptor))
    objects[2] = Scan(np.full((5, 3), np.nan), name="not\udcff a scan")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = ShapeConceptModel(descriptor=descriptor)
        model.set_params(**{"ensemble__dictionary__n_levels": 3, **parameters})
        model.fit(objects)
    for number, concept in enumerate(model.concepts_):
        concept.name = f'näme "{number}"\n\udcff' if number == 1 else f"concept of kind {number}"
    return model


def forge(source: Path, target: Path, change: Callable[[dict[str, Any], dict[str, Any]], object]) -> Path:
    """Change tensors or description of a model file; the checksum is right again."""
    tensors, description = read_container(source)
    tensors = {name: tensor.copy() for name, tensor in widened(tensors).items()}
    change(tensors, description)
    tensors = {name: np.ascontiguousarray(tensor) for name, tensor in tensors.items()}
    write_container(target, tensors, description)
    return target


def differences(first: object, second: object, path: str = "model") -> list[str]:
    """Where two objects differ in type, shape, order of memory, or any bit, all attributes included."""
    if type(first) is not type(second):
        return [f"{path}: {type(first)} and {type(second)}"]
    if isinstance(first, np.ndarray) and isinstance(second, np.ndarray):
        same = (
            (first.dtype, first.shape, first.flags.c_contiguous)
            == (second.dtype, second.shape, second.flags.c_contiguous)
        ) and first.tobytes() == second.tobytes()
        return [] if same else [path]
    if issparse(first):
        fields = ("shape", "data", "indices", "indptr")
        return [d for f in fields for d in differences(getattr(first, f), getattr(second, f), f"{path}.{f}")]
    if isinstance(first, list | tuple):
        if len(first) != len(second):
            return [f"{path}: {len(first)} and {len(second)} items"]
        pairs = enumerate(zip(first, second, strict=True))
        return [d for i, (a, b) in pairs for d in differences(a, b, f"{path}[{i}]")]
    if isinstance(first, dict) and isinstance(second, dict):
        if first.keys() != second.keys():
            return [f"{path}: {first.keys()} and {second.keys()}"]
        return [d for key in first for d in differences(first[key], second[key], f"{path}[{key!r}]")]
    if isinstance(first, StagesMixin) and isinstance(second, StagesMixin):
        # A stage left to its default is there after loading; its parameters are compared where it is fitted.
        first, second = copy(first), copy(second)
        for estimator in (first, second):
            vars(estimator).update(dict.fromkeys(estimator._default_stages))
    if hasattr(first, "__dict__"):
        ours, theirs = vars(first).keys() - LAZY, vars(second).keys() - LAZY
        found = [f"{path}: {name}" for name in ours ^ theirs]
        for name in sorted(ours & theirs):
            found += differences(getattr(first, name), getattr(second, name), f"{path}.{name}")
        return found
    return [] if first == second else [f"{path}: {first!r} and {second!r}"]


def refusal(path: Path) -> str:
    """What `load_model` says about a file; nothing but a ModelError is raised, and no warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ModelError) as caught:
            load_model(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert len(message) < len(str(path)) + 400
    return message
