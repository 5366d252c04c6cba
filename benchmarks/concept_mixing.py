"""How concepts depend on what mixing means: the size of a neighbourhood, and how much of mixing is enough.

    python benchmarks/concept_mixing.py [--only SET ...]

The default takes 3 sqrt(n) neighbours (36 at least, half of all objects at most) and refuses below 0.8.
Each cell: number of concepts, "explained", "AMI" (medians over 5 splits), and the stability over 10 subsets,
as in concept_quality.py. "simulated" are the simulator's seeds 100 to 107, by which the default was chosen;
shown is the mean over them, and the least stability.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from common import command, print_table
from concept_scores import SETS, grouping_stability, random_subsets, scans_by_set
from shapeconcepts import DescribedObject, Filtration, ShapeConceptModel, describe, segment
from shapeconcepts.evaluation import grouping_scores, stratified_splits

SEEDS = range(100, 108)
N_SUBSETS = 10
PER_ROOT = (2.0, 2.5, 3.0, 3.5)
LEAST = (0.6, 0.7, 0.75, 0.8, 0.85)

Rows = tuple[NDArray[np.int64], csr_matrix]


def stimuli_of(described: list[DescribedObject], chosen: NDArray[np.int64]) -> Rows:
    return chosen, ShapeConceptModel().fit([described[i] for i in chosen]).stimuli_


def cell(
    filtration: Filtration, on_splits: list[Rows], on_subsets: list[Rows], labels: NDArray[np.str_]
) -> NDArray[np.float64]:
    """Number of concepts, explained, mutual information, stability."""
    scores = [grouping_scores(filtration.fit_predict(rows), labels[chosen]) for chosen, rows in on_splits]
    rows_of_scores = [(one.n_groups, one.explained, one.adjusted_mutual_information) for one in scores]
    groupings = [(chosen, filtration.fit_predict(rows)) for chosen, rows in on_subsets]
    return np.append(np.median(rows_of_scores, axis=0), grouping_stability(groupings, len(labels)))


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    cells: dict[str, dict[tuple[float, float], list[NDArray[np.float64]]]] = {}
    for data, scans in scans_by_set(parser, options.only, SEEDS).items():
        labels = np.array([scan.label for scan in scans])
        described = [describe(segment(scan)) for scan in scans]
        splits = [training for training, _ in stratified_splits(labels, 5, random_state=0)]
        on_splits = [stimuli_of(described, chosen) for chosen in splits]
        on_subsets = [stimuli_of(described, chosen) for chosen in random_subsets(len(labels), N_SUBSETS)]
        of_set = cells.setdefault(data.split()[0], {})
        for per_root in PER_ROOT:
            for least in LEAST:
                filtration = Filtration(neighbours_per_root=per_root, least_mixing=least)
                found = cell(filtration, on_splits, on_subsets, labels)
                of_set.setdefault((per_root, least), []).append(found)
    for data, of_set in cells.items():
        table = []
        for per_root in PER_ROOT:
            texts = []
            for least in LEAST:
                values = np.array(of_set[per_root, least])
                n, explained, information, stable = values.mean(axis=0)
                lowest = f" ({values[:, 3].min():.2f})" if len(values) > 1 else ""
                texts.append(f"{n:.0f}  {explained:.3f}  {information:.3f}  {stable:.2f}{lowest}")
            table.append((f"{per_root} sqrt(n) neighbours", *texts))
        print_table((data, *(f"mixing {least}" for least in LEAST)), table)
        print(flush=True)


if __name__ == "__main__":
    main()
