"""Whether a model notices that it sees a kind of object for the first time, and how often it is wrong.

    python benchmarks/novelty.py [--only SET ...] [--seeds SEED ...]

False alarms: learned from 75 % of all scans, the share of the others with a p-value up to each rate, pooled
over 20 splits; the same for changed copies of them, see `changed_scans.py`. New kinds: each label in turn is
left out of training, 3 splits; the share of its scans with a p-value up to 5 %, and the area under the
receiver operating characteristic where the p-value tells them from the other labels' new scans.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np
from sklearn.metrics import roc_auc_score

from changed_scans import half_of_the_points, third_hidden, twice_its_noise
from common import command, print_table
from concept_scores import SETS, scans_by_set
from shapeconcepts import ShapeConceptModel, describe, segment
from shapeconcepts.evaluation import stratified_splits

# Where one of two labels is left out, nothing is left to tell apart.
CHOICES = tuple(name for name in SETS if name != "osd_learn")
RATES = (0.01, 0.05, 0.1, 0.2)
N_SPLITS = 20
N_LEFT_OUT_SPLITS = 3
CHANGES = {
    "half of the points": half_of_the_points,
    "a third hidden": third_hidden,
    "twice its noise": twice_its_noise,
}


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=CHOICES, default=CHOICES, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=[400, 401, 402], metavar="SEED")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    alarms, found = [], []
    for data, scans in scans_by_set(parser, options.only, options.seeds).items():
        labels = np.array([scan.label for scan in scans])
        segmented = [segment(scan) for scan in scans]
        whole = [describe(one, n_occlusions=2) for one in segmented]
        copies = {"as they are": whole}
        for name, change in CHANGES.items():
            rng = np.random.default_rng(0)
            copies[name] = [describe(segment(change(scan, rng))) for scan in scans]
        p_values: dict[str, list[float]] = {name: [] for name in copies}
        for training, new in stratified_splits(labels, N_SPLITS, random_state=0):
            model = ShapeConceptModel(n_jobs=2).fit([whole[i] for i in training])
            for name, described in copies.items():
                p_values[name].extend(model.recognise([described[i] for i in new]).p_values)
        for name, values in p_values.items():
            shares = [f"{np.mean(np.array(values) <= rate):.3f}" for rate in RATES]
            alarms.append([data, name, *shares])
            print(*alarms[-1], flush=True)
        for label, row in left_out(whole, labels).items():
            found.append([data, label, *(f"{value:.3f}" for value in row)])
            print(*found[-1], flush=True)
    print_table(("false alarms", "new scans", *(f"{100 * rate:.0f} %" for rate in RATES)), alarms)
    print_table(("new kinds", "left out", "found at 5 %", "called unknown by default", "area"), found)


def left_out(whole: list, labels: np.ndarray) -> dict[str, np.ndarray]:
    """Found at 5 %, called unknown without a rate, and area: of each label, and their means."""
    rows: dict[str, list[list[float]]] = {}
    for training, new in stratified_splits(labels, N_LEFT_OUT_SPLITS, random_state=0):
        for label in np.unique(labels).tolist():
            model = ShapeConceptModel(n_jobs=2).fit([whole[i] for i in training if labels[i] != label])
            novel = model.recognise([whole[i] for i in np.flatnonzero(labels == label)])
            known = model.recognise([whole[i] for i in new if labels[i] != label]).p_values
            is_novel = np.repeat([1, 0], [len(novel.p_values), len(known)])
            area = roc_auc_score(is_novel, -np.concatenate([novel.p_values, known]))
            row = [(novel.p_values <= 0.05).mean(), (novel.concepts < 0).mean(), area]
            rows.setdefault(label, []).append(row)
    means = {label: np.mean(values, axis=0) for label, values in rows.items()}
    return {**means, "mean": np.mean(list(means.values()), axis=0)}


if __name__ == "__main__":
    main()
