"""What the usual methods reach on the same segmented scans: the figures that shape concepts are held against.

    python benchmarks/baselines.py [--repeats N] [--only SET ...]

Objects are split 75 % / 25 % with equal shares of every label, N times (default 5). The 75 % are grouped
without labels; shown are the medians over splits. Parameters are chosen without labels, and all methods have
the same limit on the number of groups. "explained" is the share of all objects that are in a group of at
least two whose majority label is theirs; "AMI" is adjusted mutual information. "SVM" is the error in percent
of the machine of discrimination.py on the other 25 %, averaged over labels, then over splits, with the
standard deviation.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
from numpy.typing import NDArray

from common import command, labelled_scans, print_table
from shapeconcepts import describe, segment
from shapeconcepts.evaluation import (
    Grouping,
    TopicModel,
    baseline_rows,
    grouping_baselines,
    grouping_scores,
    most_groups,
    point_histograms,
    stratified_splits,
    svm_errors,
    whole_object_rows,
)
from shapeconcepts.evaluation.baselines import WHOLE_OBJECT

SETS = ("seven_shapes", "restaurant_views", "osd_learn", "simulated")
TITLES = ("groups", "purity", "pure", "coverage", "explained", "AMI", "B-cubed F1")


def chosen(groupings: list[Grouping]) -> str:
    """Smallest and largest value of each parameter over splits."""
    texts = []
    for name in groupings[0].parameters:
        values = sorted({one.parameters[name] for one in groupings})
        texts.append(f"{name} {values[0]:.3g}" + (f" to {values[-1]:.3g}" if len(values) > 1 else ""))
    return ", ".join(texts)


class Results:
    """Groupings and errors of all splits by the names of rows and methods."""

    def __init__(self) -> None:
        self.groupings: dict[tuple[str, str], list[tuple[Grouping, NDArray[np.str_]]]] = {}
        self.errors: dict[str, list[float]] = {}

    def add_grouping(self, rows: str, method: str, grouping: Grouping, labels: NDArray[np.str_]) -> None:
        self.groupings.setdefault((rows, method), []).append((grouping, labels))

    def add_errors(self, rows: str, errors: dict[str, float]) -> None:
        self.errors.setdefault(rows, []).append(100 * float(np.mean(list(errors.values()))))

    def print(self) -> None:
        table = []
        for (rows, method), of_splits in self.groupings.items():
            scores = [list(vars(grouping_scores(one.labels, labels)).values()) for one, labels in of_splits]
            medians = np.nanmedian(np.array(scores, float), axis=0)
            cells = [f"{medians[0]:.0f}", *(f"{value:.3f}" for value in medians[1:])]
            table.append((f"{rows}: {method}", *cells, chosen([one for one, _ in of_splits])))
        print_table(("rows: grouping", *TITLES, "chosen"), table)
        errors = ((rows, f"{np.mean(all_):.1f} ± {np.std(all_):.1f}") for rows, all_ in self.errors.items())
        print_table(("rows", "SVM, %"), errors)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--repeats", type=int, default=5, metavar="N")
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    options = parser.parse_args()
    for data in options.only:
        scans = labelled_scans(parser, data)
        labels = np.array([scan.label for scan in scans])
        segmented = [segment(scan) for scan in scans]
        rows_by_name = baseline_rows(segmented)
        rows_by_name[WHOLE_OBJECT] = whole_object_rows([describe(one) for one in segmented])
        points = [point_histograms(one) for one in segmented]
        results = Results()
        splits = stratified_splits(labels, options.repeats, random_state=0)
        for name, rows in rows_by_name.items():
            for training, new in splits:
                limit = most_groups(len(training))
                for method, grouping in grouping_baselines(rows[training], limit).items():
                    results.add_grouping(name, method, grouping, labels[training])
                errors = svm_errors(rows[training], labels[training], rows[new], labels[new], "histogram")
                results.add_errors(name, errors)
        for training, new in splits:
            model = TopicModel(most_groups(len(training))).fit([points[i] for i in training])
            results.add_grouping("FPFH words", "topics", model.grouping_, labels[training])
            rows = model.transform([points[i] for i in new])
            errors = svm_errors(model.rows_, labels[training], rows, labels[new], "histogram")
            results.add_errors("FPFH words: topics", errors)
        limits = ", ".join(sorted({str(most_groups(len(training))) for training, _ in splits}))
        print(f"\n{data}: {len(scans)} objects, at most {limits} groups")
        results.print()


if __name__ == "__main__":
    main()
