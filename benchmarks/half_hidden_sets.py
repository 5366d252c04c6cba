"""Concepts learned from sets in which half of the scans are half hidden.

    python benchmarks/half_hidden_sets.py [--only SET ...] [--seeds SEED ...]

Every second scan of each label, at random, is without the half of its points that is beyond a random line in
the image. Shown are the number of concepts, explained and mutual information with labels, over all scans and,
explained, over those that are hidden in part; the same of the set as it is.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np
from numpy.typing import NDArray

from changed_scans import share_hidden
from common import command, described, print_table
from concept_scores import SETS, scans_by_set
from shapeconcepts import DescribedObject, Scan, ShapeConceptModel
from shapeconcepts.evaluation import grouping_scores

ALL_SETS = (*SETS, "household_meshes", "atwork_parts")
SEEDS = (400, 401, 402)


def hidden_in_half(scans: list[Scan]) -> tuple[list[Scan], NDArray[np.bool_]]:
    """The scans, every second one of each label half hidden, and which these are."""
    rng = np.random.default_rng(0)
    labels = np.array([scan.label for scan in scans])
    is_hidden = np.zeros(len(scans), bool)
    for label in np.unique(labels):
        is_hidden[rng.permutation(np.flatnonzero(labels == label))[::2]] = True
    return [
        share_hidden(scan, np.random.default_rng(i), 0.5) if hidden else scan
        for i, (scan, hidden) in enumerate(zip(scans, is_hidden, strict=True))
    ], is_hidden


def row(objects: list[DescribedObject], hidden_names: set[str]) -> list[str]:
    model = ShapeConceptModel().fit(objects)
    labels = np.array([one.label for one in objects])
    scores = grouping_scores(model.labels_, labels)
    is_hidden = np.array([one.name in hidden_names for one in objects])
    majority = np.array([_majority(labels[concept.members]) for concept in model.concepts_] + [""])
    is_explained = majority[model.labels_] == labels
    return [
        str(len(model.concepts_)),
        f"{scores.explained:.3f}",
        f"{is_explained[is_hidden].mean():.3f}" if is_hidden.any() else "-",
        f"{scores.adjusted_mutual_information:.3f}",
    ]


def _majority(labels: NDArray[np.str_]) -> str:
    names, counts = np.unique(labels, return_counts=True)
    return str(names[counts.argmax()])


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=ALL_SETS, default=ALL_SETS, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    table = []
    for name, scans in scans_by_set(parser, options.only, options.seeds).items():
        changed, is_hidden = hidden_in_half(scans)
        hidden_names = {scan.name for scan, hidden in zip(scans, is_hidden, strict=True) if hidden}
        for title, some, names in (("as it is", scans, set()), ("half hidden", changed, hidden_names)):
            table.append([name, title, *row(described(some, n_occlusions=2), names)])
            print(*table[-1], flush=True)
    print()
    print_table(("set", "scans", "concepts", "explained", "of the hidden", "information"), table)


if __name__ == "__main__":
    main()
