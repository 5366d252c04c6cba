"""Models as `learn` hands them to a report, made from stimuli alone, and scans of known shape."""

import dataclasses
import warnings
from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix

from shapeconcepts import ConceptResponse, Filtration, ShapeConceptModel
from shapeconcepts.segmentation import SegmentedObject

# What files may be called.
HOSTILE = [
    "</script><script>window.attacked = 1</script>",
    "<!--<script>",
    "]]>\"'`${window.attacked = 2}\\",
    "<img src=x onerror='window.attacked=3'>",
    "líne\u2028break\u2029 and \x00 \r\n",
    "\u202egpj.exe",
    "undecodable \udcff",
    "__proto__",
    "$style $contents &lt;b&gt;",
    "",
]

# Stimuli from which no concept comes.
WITHOUT_CONCEPTS = {
    "one scan": np.ones((1, 3)),
    "two scans": np.eye(2),
    "equal scans": np.ones((2, 2)),
    "no stimuli at all": np.zeros((4, 3)),
    "all different": np.eye(8),
}


def model_of(
    stimuli: np.ndarray,
    labels: Sequence[str | None] | None = None,
    names: Sequence[str] | None = None,
    skipped: dict[int, str] | None = None,
    *,
    heat: str = "divergence",
    stop: str | None = None,
) -> ShapeConceptModel:
    """A model whose training scans have these stimuli."""
    stop = stop or ("persistence" if heat == "divergence" else "annexations")
    model = ShapeConceptModel(filtration=Filtration(heat=heat, stop=stop))
    n = len(stimuli)
    model.stimuli_ = csr_matrix(stimuli)
    model.skipped_ = skipped or {}
    model.history_, model.response_ = (), ConceptResponse()
    model._waiting = []
    model.scan_names_ = list(names) if names is not None else [f"scans/scan_{i}.pcd" for i in range(n)]
    model.scan_labels_ = list(labels) if labels is not None else [None] * n
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model.filtration_ = Filtration(heat=heat, stop=stop).fit(model.stimuli_)
    model.concepts_ = model.filtration_.concepts_
    model.concept_tree_ = model.filtration_.concept_tree_
    model.labels_ = model.filtration_.labels_
    return model


def grouped_stimuli(n: int, n_groups: int, seed: int = 0) -> tuple[np.ndarray, list[str]]:
    """Noisy stimuli of some groups, and the group of each as its label."""
    rng = np.random.default_rng(seed)
    own = np.eye(30)[: 2 * n_groups].reshape(n_groups, 2, 30).sum(axis=1)
    group = np.arange(n) % n_groups
    rows = np.array([rng.dirichlet(10 * own[g] + 0.02) for g in group])
    return rows, [f"kind {g}" for g in group]


def hostile_model() -> ShapeConceptModel:
    """Concepts of 40 scans with such names and labels, one of them skipped."""
    rows, labels = grouped_stimuli(40, 4)
    names = (HOSTILE * 4)[:40]
    labels = [HOSTILE[int(label[-1])] for label in labels]
    model = model_of(rows, labels, names, {3: HOSTILE[0]})
    assert len(model.concepts_) >= 2
    model.concepts_[0].name = HOSTILE[0]
    return model


def ball(n_points: int = 2000, radius: float = 0.05, seed: int = 0) -> SegmentedObject:
    """The half of a ball that a sensor at the origin sees, in two segments: left and right."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(n_points, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    directions[:, 2] = -np.abs(directions[:, 2])
    return segmented(directions * radius + (0, 0, 0.8), directions, (directions[:, 0] > 0).astype(np.int32))


def segmented(points: np.ndarray, normals: np.ndarray, labels: np.ndarray) -> SegmentedObject:
    n = len(points)
    return SegmentedObject(
        points=np.asarray(points, float),
        normals=np.asarray(normals, float),
        patch_labels=np.zeros(n, np.int32),
        segment_labels=np.asarray(labels, np.int32),
        segment_edges=np.empty((0, 2), np.int32),
        n_segments=int(labels.max()) + 1,
        point_to_voxel=np.arange(n, dtype=np.int32),
        voxel_size=0.005,
        viewpoint=np.zeros(3),
    )


def shuffled(scan: SegmentedObject, seed: int) -> SegmentedObject:
    order = np.random.default_rng(seed).permutation(len(scan.points))
    return dataclasses.replace(
        scan,
        points=scan.points[order],
        normals=scan.normals[order],
        patch_labels=scan.patch_labels[order],
        segment_labels=scan.segment_labels[order],
    )
