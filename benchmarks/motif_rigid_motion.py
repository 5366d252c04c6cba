"""Does a moved scan find itself among the training objects?

    python benchmarks/motif_rigid_motion.py [FOLDER] [--seed N]

FOLDER holds scans, by default ../shared/data/seven_shapes beside the repository. Hierarchies learn from all
of them. Every scan is then turned and moved at random, its viewpoint with it, rounded to 32 bit, segmented
and described anew. Shown is the share of moved scans to whose row, among the rows of all scans, that of their
own original is the nearest under the Jensen-Shannon divergence; an original that shares its place with others
(equal rows) counts as found, and how many do is shown as well.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np

from common import add_folder, command, ensembles, percent, print_table, scans_in
from rigid_motion import moved
from shapeconcepts import describe, segment
from shapeconcepts.topology import jensen_shannon_divergences


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--seed", type=int, default=0, help="seed of the motions (default: 0)")
    options = parser.parse_args()
    generator = np.random.default_rng(options.seed)
    scans = scans_in(parser, options.folder)
    originals = [segment(scan) for scan in scans]
    copies = [segment(moved(scan, generator)) for scan in scans]
    table = []
    for name, (descriptor, ensemble) in ensembles().items():
        described, moved_ones = (
            [describe(one, descriptor) for one in objects] for objects in (originals, copies)
        )
        rows = ensemble.fit(described).transform(described)
        divergences = jensen_shannon_divergences(ensemble.transform(moved_ones), rows)
        own = np.diagonal(divergences)
        found = own <= divergences.min(axis=1) + 1e-12
        shared = (jensen_shannon_divergences(rows) < 1e-12).sum(axis=1) > 1
        table.append([name, len(scans), percent(found), percent(shared), f"{np.median(own):.1e}"])
    print_table(("", "scans", "found, %", "equal rows, %", "median divergence"), table)


if __name__ == "__main__":
    main()
