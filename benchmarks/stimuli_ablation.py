"""What the choices behind the stimuli do to the error of a support vector machine.

    python benchmarks/stimuli_ablation.py [--repeats N] [--only SET ...]

One choice at a time is changed, once from the default (a column is a prototype, words are of 2 levels) and
once with motifs as columns (of 8 levels): the levels of the dictionary, the metric of its words, the
descriptor, the bandwidth, whether an object's own prototypes count, how many objects must support a motif.
Splits, machine and error are those of discrimination.py.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np

from common import command, labelled_scans, print_table
from discrimination import SETS, errors, stimuli
from shapeconcepts import MotifHierarchyEnsemble, describe, segment
from shapeconcepts.descriptors.registry import DEFAULT

DESCRIPTORS = (DEFAULT, "surflet", "fpfh")
MOTIFS = {"columns": "motifs", "dictionary__n_levels": 8}
# The descriptor, and what is changed in the default ensemble.
VARIANTS = (
    ("default", DEFAULT, {}),
    ("1 level", DEFAULT, {"dictionary__n_levels": 1}),
    *((f"{n} levels", DEFAULT, {"dictionary__n_levels": n}) for n in (4, 6, 8, 10)),
    ("words under L2", DEFAULT, {"dictionary__metric": "euclidean"}),
    ("surflet", "surflet", {}),
    ("fpfh", "fpfh", {}),
    *((f"{n} neighbours", DEFAULT, {"n_neighbours": n}) for n in (5, 10, 40)),
    ("own prototypes count", DEFAULT, {"leave_own_out": False}),
    ("motifs", DEFAULT, MOTIFS),
    *(
        (f"motifs, {descriptor}{name}", descriptor, {**MOTIFS, **changes})
        for descriptor in ("surflet", "fpfh")
        for name, changes in (
            ("", {}),
            *((f", {n} levels", {"dictionary__n_levels": n}) for n in (4, 6, 10)),
            (", words under L2", {"dictionary__metric": "euclidean"}),
            (
                ", 4 levels, words under L2",
                {"dictionary__n_levels": 4, "dictionary__metric": "euclidean"},
            ),
            *((f", bandwidth {width}", {"bandwidth": width}) for width in (0.025, 0.05, 0.2)),
            (", own prototypes count", {"leave_own_out": False}),
            (", every motif counts", {"min_support": 1}),
        )
    ),
)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--repeats", type=int, default=5, metavar="N")
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    table = [[name] for name, _, _ in VARIANTS]
    for data in options.only:
        scans = labelled_scans(parser, data)
        labels = np.array([scan.label for scan in scans])
        segmented = [segment(scan) for scan in scans]
        described = {name: [describe(one, name) for one in segmented] for name in DESCRIPTORS}
        for line, (_, descriptor, changes) in zip(table, VARIANTS, strict=True):
            rows = stimuli(MotifHierarchyEnsemble().set_params(**changes))
            error, _ = errors(described[descriptor], labels, rows, options.repeats)
            line.append(f"{np.mean(error):.1f}")
    print_table(("mean error over labels, %", *options.only), table)


if __name__ == "__main__":
    main()
