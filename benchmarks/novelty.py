"""Whether a model notices that it sees a kind of object for the first time.

    python benchmarks/novelty.py [--only SET ...]

Each label in turn is left out of the training objects (75 % of the others). "unknown" is the share of scans
whose prediction is -1: of the label that was left out, which is right, and of the other labels' new scans, as
they are and with half of their points, which is wrong. "AUC": the area under the receiver operating
characteristic where the divergence to the nearest prototype is what tells the label that was left out from
the other labels' new scans. Means over labels. "simulated" is the seed 100.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np
from sklearn.metrics import roc_auc_score

from changed_scans import half_of_the_points
from common import command, print_table
from concept_scores import SETS, scans_by_set
from shapeconcepts import ShapeConceptModel, describe, segment
from shapeconcepts.evaluation import stratified_splits
from shapeconcepts.topology import jensen_shannon_divergences

# Where one of two labels is left out, nothing is left to tell apart.
CHOICES = tuple(name for name in SETS if name != "osd_learn")


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=CHOICES, default=CHOICES, metavar="SET")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    table = []
    for data, scans in scans_by_set(parser, options.only, (100,)).items():
        labels = np.array([scan.label for scan in scans])
        rng = np.random.default_rng(0)
        described = [describe(segment(scan)) for scan in scans]
        sparse = [describe(segment(half_of_the_points(scan, rng))) for scan in scans]
        training, new = stratified_splits(labels, 1, random_state=0)[0]
        rows = []
        for label in np.unique(labels):
            model = ShapeConceptModel().fit([described[i] for i in training if labels[i] != label])
            known = [i for i in new if labels[i] != label]
            stimuli = [
                model.stimuli(one)
                for one in (
                    [described[i] for i in np.flatnonzero(labels == label)],
                    [described[i] for i in known],
                    [sparse[i] for i in known],
                )
            ]
            unknown = [(model.response_.predict(one) < 0).mean() for one in stimuli]
            nearest = [
                jensen_shannon_divergences(one, model.response_.prototypes_).min(axis=1)
                for one in stimuli[:2]
            ]
            is_novel = np.repeat([1, 0], [len(one) for one in nearest])
            rows.append([*unknown, roc_auc_score(is_novel, np.concatenate(nearest))])
        table.append([data, *(f"{mean:.3f}" for mean in np.mean(rows, axis=0))])
    titles = ("unknown: label left out", "others' new scans", "the same with half of the points", "AUC")
    print_table(("novelty", *titles), table)


if __name__ == "__main__":
    main()
