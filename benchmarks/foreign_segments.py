"""Whether segments that belong to something else are told from a scan's own.

    python benchmarks/foreign_segments.py [--only SET ...] [--seeds SEED ...]

Learned from 75 % of the scans; the others are explained as they are, and with a quarter of foreign points: a
part of an object of another label that touches them, or a strip of a table. Shown is the share of segments
that are called foreign: of the scans as they are, and of the segments nine tenths of whose points are the
scan's own, or are not. Where only one segment is found, none can be foreign to it: such scans are left out.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings
from functools import partial

import numpy as np

from changed_scans import foreign_object, table_strip
from common import command, described, percent, print_table
from concept_scores import SETS, scans_by_set
from shapeconcepts import DescribedObject, Scan, ShapeConceptModel, describe, segment
from shapeconcepts.evaluation.splits import stratified_splits

SEEDS = (400, 401, 402)
FOREIGN_SHARE = 0.25


def foreign_points(scan: Scan, n_own: int) -> tuple[list[float], DescribedObject]:
    """Share of each segment's points that are not among the first, and the described object."""
    segmented = segment(scan)
    of_point = np.append(segmented.segment_labels, -1)[segmented.point_to_voxel]
    is_foreign = np.arange(len(of_point)) >= n_own
    return [is_foreign[of_point == s].mean() for s in range(segmented.n_segments)], describe(segmented)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    table = []
    for name, scans in scans_by_set(parser, options.only, options.seeds).items():
        labels = np.array([scan.label for scan in scans])
        [(training, new)] = stratified_splits(labels, 1, random_state=0)
        model = ShapeConceptModel().fit(described(scans[i] for i in training))
        changes = {
            "nothing": lambda scan, rng: scan,
            "other object": partial(foreign_object, share=FOREIGN_SHARE, others=scans),
            "table": partial(table_strip, share=FOREIGN_SHARE),
        }
        for title, change in changes.items():
            own, foreign = [], []
            for i in new:
                scan = change(scans[i], np.random.default_rng(i))
                shares, one = foreign_points(scan, len(scans[i]))
                called = model.explain(one).foreign
                for number, share in enumerate(shares if len(shares) > 1 else ()):
                    if not 0.1 < share < 0.9:
                        (foreign if share >= 0.9 else own).append(number in called)
            table.append([name, title, len(own), percent(own), len(foreign), percent(foreign)])
            print(*table[-1], flush=True)
    print()
    print_table(("set", "added", "own segments", "called foreign, %", "foreign", "called foreign, %"), table)


if __name__ == "__main__":
    main()
