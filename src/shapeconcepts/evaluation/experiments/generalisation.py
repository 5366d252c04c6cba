"""Generalisation: the concept responses of several data sets to concepts of one, on a map (figure 10).

A region is all cells of the map with the same majority label, as in the paper; it need not be connected.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from sklearn.manifold import TSNE

from shapeconcepts.evaluation.experiments.concept_responses import fit
from shapeconcepts.evaluation.labelled_objects import LabelledObjects
from shapeconcepts.evaluation.results import Floats, MapResult
from shapeconcepts.evaluation.splits import Split
from shapeconcepts.parallel import libraries_in_one_thread

# Cells along each side of the map.
CELLS = 60
NEAREST_SHARE = 0.05
_MARGIN = 0.03
_PERPLEXITY = 30.0


def generalisation(
    trained: LabelledObjects,
    others: Sequence[LabelledObjects],
    preset: str,
    split: Split,
    random_state: int = 0,
) -> MapResult | None:
    """Learn from the training part of one data set, and lay the responses of all objects out on a map.

    The map is made without labels, by t-SNE of all data sets together. Each of its cells has the majority
    label of the 5 % of the objects that are nearest to its centre.

    Parameters
    ----------
    trained : LabelledObjects
        Its training part gives motifs and concepts; both parts are on the map.
    others : sequence of LabelledObjects
    preset : str
    split : (training, test)
        Indices.
    random_state : int
        Seed of t-SNE.

    Returns
    -------
    MapResult or None
        None where there is no concept, or there are fewer than four objects with a response.
    """
    training, test = split
    described = trained.described[preset]
    model = fit([described[i] for i in training], preset)
    if not model.concepts_:
        return None
    parts = [
        (f"{trained.name}, training", model.response_.transform(model.stimuli_), trained.labels[training]),
        (f"{trained.name}, testing", model.transform([described[i] for i in test]), trained.labels[test]),
        *((one.name, model.transform(one.described[preset]), one.labels) for one in others),
    ]
    responses = np.concatenate([rows for _, rows, _ in parts])
    labels = np.concatenate([names for _, _, names in parts])
    data_set = np.concatenate([np.full(len(rows), name) for name, rows, _ in parts])
    placed = ~np.isnan(responses).any(axis=1)
    unplaced = Counter(data_set[~placed].tolist())
    labels, data_set = labels[placed], data_set[placed]
    if len(labels) < 4:
        return None
    return _map(_embedded(responses[placed], random_state), data_set, labels, parts[0][0], dict(unplaced))


def majority_labels(
    places: Floats, positions: Floats, labels: NDArray[np.str_], k: int
) -> tuple[NDArray[np.str_], Floats]:
    """Majority label of the k objects nearest to each place, and its share; of equals the first by name."""
    names, label_of = np.unique(labels, return_inverse=True)
    nearest = cKDTree(positions).query(places, k=list(range(1, k + 1)))[1]
    counts = np.stack([(label_of[nearest] == number).sum(axis=1) for number in range(len(names))], axis=1)
    return names[counts.argmax(axis=1)], counts.max(axis=1) / k


def _embedded(responses: Floats, random_state: int) -> Floats:
    start = "pca" if min(responses.shape) >= 2 else "random"
    perplexity = min(_PERPLEXITY, (len(responses) - 1) / 3)
    with libraries_in_one_thread():
        positions = TSNE(2, perplexity=perplexity, init=start, random_state=random_state).fit_transform(
            responses
        )
    return np.asarray(positions, np.float64)


def _map(
    positions: Floats,
    data_set: NDArray[np.str_],
    labels: NDArray[np.str_],
    trained: str,
    unplaced: dict[str, int],
) -> MapResult:
    grid_x, grid_y = (_cell_centres(axis) for axis in positions.T)
    cells = np.stack([axis.ravel() for axis in np.meshgrid(grid_x, grid_y)], axis=1)
    k = max(1, round(NEAREST_SHARE * len(labels)))
    majority, share = majority_labels(cells, positions, labels, k)
    cell_of = cKDTree(cells).query(positions)[1]
    label_names = np.unique(labels)
    region_of = majority[cell_of]
    counts = np.array(
        [
            [((region_of == region) & (labels == label)).sum() for label in label_names]
            for region in label_names
        ]
    )
    is_trained = data_set == trained
    k_trained = max(1, round(NEAREST_SHARE * is_trained.sum()))
    trained_majority = majority_labels(cells, positions[is_trained], labels[is_trained], k_trained)[0]
    known = np.isin(labels, labels[is_trained])
    return MapResult(
        positions=positions,
        data_set=data_set,
        labels=labels,
        grid_x=grid_x,
        grid_y=grid_y,
        majority=majority.reshape(CELLS, CELLS),
        share=share.reshape(CELLS, CELLS),
        k=k,
        label_names=label_names.tolist(),
        region_of_labels=_shares(counts),
        labels_to_regions=_shares(counts.T),
        nearest_region_right=_right(region_of == labels, data_set, labels),
        nearest_trained_right=_right(
            trained_majority[cell_of][known] == labels[known], data_set[known], labels[known]
        ),
        unplaced=unplaced,
    )


def _cell_centres(positions: Floats) -> Floats:
    """Centres of equal cells that cover the positions along an axis, and a little more."""
    margin = _MARGIN * np.ptp(positions)
    low, high = positions.min() - margin, positions.max() + margin
    edges = np.linspace(low, high, CELLS + 1)
    return (edges[:-1] + edges[1:]) / 2


def _shares(counts: NDArray[np.int64]) -> Floats:
    return counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)


def _right(
    is_right: NDArray[np.bool_], data_set: NDArray[np.str_], labels: NDArray[np.str_]
) -> dict[str, dict[str, float]]:
    """Share of what is right, by data set and label."""
    return {
        str(name): {
            str(label): float(is_right[(data_set == name) & (labels == label)].mean())
            for label in np.unique(labels[data_set == name])
        }
        for name in dict.fromkeys(data_set.tolist())
    }
