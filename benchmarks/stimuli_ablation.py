"""What the choices behind the stimuli do to the error of a support vector machine.

    python benchmarks/stimuli_ablation.py [--repeats N] [--only SET ...]

One choice at a time is changed: the levels of the dictionary, the metric of its words, the bandwidth, whether
an object's own prototypes count, how many objects must support a motif. Splits, machine and error are those
of discrimination.py.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np

from common import command, labelled_scans, print_table
from discrimination import SETS, errors, stimuli
from shapeconcepts import MotifHierarchyEnsemble, SegmentDictionary, describe, segment

VARIANTS = (
    ("default", {}, {}),
    ("4 levels", {"n_levels": 4}, {}),
    ("6 levels", {"n_levels": 6}, {}),
    ("10 levels", {"n_levels": 10}, {}),
    ("words under L2", {"metric": "euclidean"}, {}),
    ("4 levels, words under L2", {"n_levels": 4, "metric": "euclidean"}, {}),
    ("bandwidth 0.025", {}, {"bandwidth": 0.025}),
    ("bandwidth 0.05", {}, {"bandwidth": 0.05}),
    ("bandwidth 0.2", {}, {"bandwidth": 0.2}),
    ("own prototypes count", {}, {"leave_own_out": False}),
    ("every motif counts", {}, {"min_support": 1}),
)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--repeats", type=int, default=5, metavar="N")
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    table = [[name, descriptor] for descriptor in ("surflet", "fpfh") for name, _, _ in VARIANTS]
    for data in options.only:
        scans = labelled_scans(parser, data)
        labels = np.array([scan.label for scan in scans])
        segmented = [segment(scan) for scan in scans]
        lines = iter(table)
        for descriptor in ("surflet", "fpfh"):
            described = [describe(one, descriptor) for one in segmented]
            for _, dictionary, ensemble in VARIANTS:
                rows = stimuli(MotifHierarchyEnsemble(SegmentDictionary(**dictionary), **ensemble))
                error, _ = errors(described, labels, rows, options.repeats)
                next(lines).append(f"{np.mean(error):.1f}")
    print_table(("mean error over labels, %", "descriptor", *options.only), table)


if __name__ == "__main__":
    main()
