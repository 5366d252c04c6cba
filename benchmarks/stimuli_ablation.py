"""What the choices behind the stimuli do to the error of a support vector machine.

    python benchmarks/stimuli_ablation.py [--repeats N] [--only SET ...]

One choice at a time is changed, once from the default (a column is a prototype) and once with motifs as
columns: the levels of the dictionary, the metric of its words, the descriptor, the bandwidth, whether an
object's own prototypes count, how many objects must support a motif. Splits, machine and error are those of
discrimination.py.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np

from common import command, labelled_scans, print_table
from discrimination import SETS, errors, stimuli
from shapeconcepts import MotifHierarchyEnsemble, SegmentDictionary, describe, segment

DESCRIPTORS = ("surflet+fpfh+curvature", "surflet+fpfh", "surflet", "fpfh", "curvature")
# What is changed in the dictionary, and in the ensemble.
VARIANTS = (
    ("default", {}, {}),
    ("4 levels", {"n_levels": 4}, {}),
    ("6 levels", {"n_levels": 6}, {}),
    ("10 levels", {"n_levels": 10}, {}),
    ("words under L2", {"metric": "euclidean"}, {}),
    ("surflet", {}, {"descriptor": "surflet"}),
    ("fpfh", {}, {"descriptor": "fpfh"}),
    ("5 neighbours", {}, {"n_neighbours": 5}),
    ("10 neighbours", {}, {"n_neighbours": 10}),
    ("40 neighbours", {}, {"n_neighbours": 40}),
    ("own prototypes count", {}, {"leave_own_out": False}),
    ("motifs", {}, {"columns": "motifs"}),
    *(
        (
            f"motifs, {descriptor}{name}",
            dictionary,
            {"columns": "motifs", "descriptor": descriptor, **changes},
        )
        for descriptor in ("surflet", "fpfh")
        for name, dictionary, changes in (
            ("", {}, {}),
            (", 4 levels", {"n_levels": 4}, {}),
            (", 6 levels", {"n_levels": 6}, {}),
            (", 10 levels", {"n_levels": 10}, {}),
            (", words under L2", {"metric": "euclidean"}, {}),
            (", 4 levels, words under L2", {"n_levels": 4, "metric": "euclidean"}, {}),
            (", bandwidth 0.025", {}, {"bandwidth": 0.025}),
            (", bandwidth 0.05", {}, {"bandwidth": 0.05}),
            (", bandwidth 0.2", {}, {"bandwidth": 0.2}),
            (", own prototypes count", {}, {"leave_own_out": False}),
            (", every motif counts", {}, {"min_support": 1}),
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
        for line, (_, dictionary, changes) in zip(table, VARIANTS, strict=True):
            ensemble = MotifHierarchyEnsemble(SegmentDictionary(**dictionary), **changes)
            rows = stimuli(ensemble)
            error, _ = errors(described[ensemble.descriptor], labels, rows, options.repeats)
            line.append(f"{np.mean(error):.1f}")
    print_table(("mean error over labels, %", *options.only), table)


if __name__ == "__main__":
    main()
