"""What can be told from stimuli alone: errors of a support vector machine on the objects' labels.

    python benchmarks/discrimination.py [--repeats N] [--only SET ...] [--confusions]

Objects are split 75 % / 25 % with equal shares of every label, N times (default 5). Hierarchies learn from
the 75 % without labels. The machine's kernel is exp(-JSD / mean JSD of the training pairs), C = 10, for all
rows: stimuli, and whole-object histograms of the same segmented scans. Shown is the error in percent,
averaged over labels, then over splits, with the standard deviation over splits.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from sklearn.model_selection import StratifiedShuffleSplit

from common import command, ensembles, labelled_scans, print_table
from shapeconcepts import DescribedObject, MotifHierarchyEnsemble, describe, segment
from shapeconcepts.evaluation import svm_predictions

SETS = ("seven_shapes", "restaurant_views", "osd_learn", "simulated")

Rows = Callable[[list[DescribedObject], list[DescribedObject]], tuple[object, object]]


def whole_object(training: list[DescribedObject], new: list[DescribedObject]) -> tuple[object, object]:
    return tuple(np.stack([one.description.whole() for one in objects]) for objects in (training, new))


def stimuli(ensemble: MotifHierarchyEnsemble) -> Rows:
    return lambda training, new: (ensemble.fit(training).stimuli_, ensemble.transform(new))


def errors(
    objects: Sequence[DescribedObject], labels: NDArray[np.str_], rows: Rows, repeats: int
) -> tuple[list[float], Counter]:
    """Mean error over labels in percent of each split, and what was taken for what."""
    result, confusions = [], Counter()
    splits = StratifiedShuffleSplit(repeats, test_size=0.25, random_state=0)
    for training, new in splits.split(labels, labels):
        training_rows, new_rows = rows([objects[i] for i in training], [objects[i] for i in new])
        predicted = svm_predictions(training_rows, labels[training], new_rows, "histogram")
        wrong = predicted != labels[new]
        result.append(100 * np.mean([wrong[labels[new] == label].mean() for label in np.unique(labels)]))
        confusions.update(zip(labels[new][wrong].tolist(), predicted[wrong].tolist(), strict=True))
    return result, confusions


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--repeats", type=int, default=5, metavar="N")
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    parser.add_argument("--confusions", action="store_true", help="list what was taken for what")
    options = parser.parse_args()
    candidates = (
        *((f"stimuli, {name}", descriptor, stimuli(one)) for name, (descriptor, one) in ensembles().items()),
        ("whole object, surflet+fpfh+curvature", "surflet+fpfh+curvature", whole_object),
        ("whole object, surflet", "surflet", whole_object),
        ("whole object, mean FPFH", "fpfh", whole_object),
    )
    table = [[name] for name, _, _ in candidates]
    for data in options.only:
        scans = labelled_scans(parser, data)
        labels = np.array([scan.label for scan in scans])
        segmented = [segment(scan) for scan in scans]
        described = {
            name: [describe(one, name) for one in segmented] for name in {name for _, name, _ in candidates}
        }
        for line, (name, descriptor, rows) in zip(table, candidates, strict=True):
            error, confusions = errors(described[descriptor], labels, rows, options.repeats)
            line.append(f"{np.mean(error):.1f} ± {np.std(error):.1f}")
            if options.confusions:
                common = ", ".join(f"{a} as {b}: {count}" for (a, b), count in confusions.most_common(6))
                print(f"{data}, {name}: {common}")
    print_table(("mean error over labels, %", *options.only), table)


if __name__ == "__main__":
    main()
