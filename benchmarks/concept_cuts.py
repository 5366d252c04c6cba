"""Whether the default granularity is one of the best cuts of the tree of concepts.

    python benchmarks/concept_cuts.py [--only SET ...] [--seeds SEED ...]

All scans of each set, without a split. Beside explained and adjusted mutual information of the default cut
stands the largest value that any cut of the same tree has: of each measure the best cut of its own, chosen by
labels. The bar: the default within 0.03 of both.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np

from common import command, described, print_table
from concept_scores import SETS, scans_by_set
from shapeconcepts import ShapeConceptModel
from shapeconcepts.evaluation import GroupingScores, grouping_scores

ALL_SETS = (*SETS, "household_meshes", "atwork_parts")
SEEDS = (400, 401, 402)


def scores_of_cuts(model: ShapeConceptModel, labels: list[str | None]) -> dict[float, GroupingScores]:
    """Scores at the coarsest cut, and just beyond each granularity where the cut changes."""
    changes = model.concept_tree_.granularities
    cuts = [0.0, *np.minimum(1.0001 * changes, 1.0).tolist()]
    return {cut: grouping_scores(model.filtration_.at_granularity(cut).labels_, labels) for cut in cuts}


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=ALL_SETS, default=ALL_SETS, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    table = []
    for name, scans in scans_by_set(parser, options.only, options.seeds).items():
        objects = described(scans)
        labels = [one.label for one in objects]
        model = ShapeConceptModel().fit(objects)
        at_default, cuts = grouping_scores(model.labels_, labels), scores_of_cuts(model, labels)
        row = [name, len(objects), f"{at_default.n_groups} at {model.filtration_.granularity_:.3f}"]
        for measure in ("explained", "adjusted_mutual_information"):
            best = max(cuts, key=lambda cut: getattr(cuts[cut], measure))
            row.append(f"{getattr(at_default, measure):.3f}")
            row.append(f"{getattr(cuts[best], measure):.3f} ({cuts[best].n_groups} at {best:.3f})")
        table.append(row)
        print(*row, flush=True)
    print()
    print_table(("set", "scans", "concepts", "explained", "best cut", "AMI", "best cut"), table)


if __name__ == "__main__":
    main()
