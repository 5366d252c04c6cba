"""Learning that goes on: in parts or at once, identities, births of new kinds, and the time of an update.

    python benchmarks/continued_learning.py [--only SET ...] [--seeds SEED ...]

"parts": scans in three random orders, one by one, in ten parts, and at once; concepts with their adjusted
mutual information, the adjusted Rand index of their scans with those of all at once, and what is recorded in
ten parts: concepts of at least ten scans whose identity ended although they neither split nor merged.
"births": each label left out of a model of three quarters of the others, its scans then come one by one, each
after six of the other labels; how many until a concept has more of them than of all else. "update": median
and largest time of `partial_fit` with one described scan.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import time
import warnings

import numpy as np
from sklearn.metrics import adjusted_rand_score

from common import command, print_table
from concept_scores import SETS, scans_by_set
from shapeconcepts import DescribedObject, ShapeConceptModel, describe, segment
from shapeconcepts.evaluation import grouping_scores, stratified_splits

CHOICES = tuple(name for name in SETS if name != "osd_learn")
N_ORDERS = 3
N_PARTS = 10
N_FIRST = 20
OTHERS_BETWEEN = 6
MOST = 40


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=CHOICES, default=CHOICES, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=[400], metavar="SEED")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    parts, births = [], []
    for data, scans in scans_by_set(parser, options.only, options.seeds).items():
        objects = [describe(segment(scan), n_occlusions=2) for scan in scans]
        labels = np.array([scan.label for scan in scans])
        for order in range(N_ORDERS):
            parts.append([data, str(order), *in_parts(objects, labels, order)])
            print(*parts[-1], flush=True)
        waited = births_after(objects, labels)
        births += [[data, label, str(n)] for label, n in waited.items()]
        births.append([data, "median", f"{np.median(list(waited.values())):.0f}"])
        print(*births[-1], waited, flush=True)
    ten, single = ("in ten parts", "index", "ended"), ("one by one", "index", "update, ms", "largest")
    titles = ("parts", "order", "at once", *ten, *single)
    print_table(titles, parts)
    print_table(("births", "label", "scans until it has a concept"), births)


def in_parts(objects: list[DescribedObject], labels: np.ndarray, order: int) -> list[str]:
    drawn = np.random.default_rng(order).permutation(len(objects))
    objects, labels = [objects[i] for i in drawn], labels[drawn]
    at_once = ShapeConceptModel().fit(objects)
    in_ten = ShapeConceptModel()
    for part in np.array_split(np.arange(len(objects)), N_PARTS):
        in_ten.partial_fit([objects[i] for i in part]).consolidate()
    ended = sum(
        change.kind == "dissolved" and change.n_before >= 10
        for update in in_ten.history_
        for change in update.changes
    )
    one_by_one, times = ShapeConceptModel().fit(objects[:N_FIRST]), []
    for one in objects[N_FIRST:]:
        start = time.perf_counter()
        one_by_one.partial_fit([one])
        times.append(time.perf_counter() - start)
    one_by_one.consolidate()
    said = [
        f"{len(model.concepts_)}, {grouping_scores(model.labels_, labels).adjusted_mutual_information:.3f}"
        for model in (at_once, in_ten, one_by_one)
    ]
    index = [f"{adjusted_rand_score(at_once.labels_, model.labels_):.3f}" for model in (in_ten, one_by_one)]
    milliseconds = [f"{1000 * value:.0f}" for value in (np.median(times), max(times))]
    return [said[0], said[1], index[0], str(ended), said[2], index[1], *milliseconds]


def births_after(objects: list[DescribedObject], labels: np.ndarray) -> dict[str, int]:
    """Scans of each label until it has a concept of its own; `MOST` where it has none by then."""
    training, new = stratified_splits(labels, 1, random_state=0)[0]
    waited = {}
    for label in np.unique(labels).tolist():
        model = ShapeConceptModel(n_jobs=2).fit([objects[i] for i in training if labels[i] != label])
        drawn = np.random.default_rng(0).permutation(np.flatnonzero(labels == label))
        others = np.random.default_rng(1).permutation([i for i in new if labels[i] != label])
        known = [labels[i] for i in training if labels[i] != label]
        waited[label] = MOST
        for count, one in enumerate(drawn[:MOST], start=1):
            between = np.take(
                others, range(count * OTHERS_BETWEEN, (count + 1) * OTHERS_BETWEEN), mode="wrap"
            )
            for i in (*between, one):
                model.partial_fit([objects[i]])
                known.append(labels[i])
            is_its = np.array(known) == label
            if any(is_its[concept.members].mean() > 0.5 for concept in model.concepts_):
                waited[label] = count
                break
    return waited


if __name__ == "__main__":
    main()
