"""What each choice of the default preset does to the concepts: one is changed at a time.

    python benchmarks/concept_ablation.py [--only SET ...]

Scores are those of concept_quality.py: medians over 5 splits of the number of concepts, "explained" and
"AMI"; the error of a support vector machine on concept responses, over the new objects of these splits
together; and the stability over 10 subsets. "motifs as columns" was the default before columns were
prototypes: surflet histograms, words of 8 levels, bandwidth 0.1.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from common import command, print_table
from concept_scores import SETS, median_scores, on_splits, pooled_svm_error, scans_by_set, stability
from shapeconcepts import ShapeConceptModel, describe, segment
from shapeconcepts.evaluation import stratified_splits

SEEDS = (100,)
REPEATS = 5
N_SUBSETS = 10
DESCRIPTORS = (
    "surflet+fpfh+curvature",
    "surflet+fpfh+curvature+distance",
    "surflet+fpfh",
    "surflet",
    "fpfh",
    "curvature",
)

Model = Callable[[], ShapeConceptModel]
changed = partial(ShapeConceptModel.preset, "default")
VARIANTS: dict[str, Model] = {
    "default": ShapeConceptModel,
    **{f"descriptor {name}": partial(changed, descriptor=name) for name in DESCRIPTORS[1:]},
    "motifs as columns": partial(
        changed,
        descriptor="surflet",
        ensemble__columns="motifs",
        ensemble__dictionary__n_levels=8,
        ensemble__bandwidth=0.1,
    ),
    **{f"{n} neighbours": partial(changed, ensemble__n_neighbours=n) for n in (10, 20, 40, 80)},
    **{f"{n} level{'s' * (n > 1)}": partial(changed, ensemble__dictionary__n_levels=n) for n in (1, 4, 8)},
    "own prototypes count": partial(changed, ensemble__leave_own_out=False),
    **{f"resolution {d}": partial(changed, ensemble__resolution=d) for d in (1e-5, 0.03, 0.07)},
    **{f"error rate {a}": partial(changed, filtration__error_rate=a) for a in (0.01, 0.2, 1.0)},
    **{f"granularity {g}": partial(changed, filtration__granularity=g) for g in (0.08, 0.12, 0.16, 0.25)},
    "stop annexations": partial(changed, filtration__stop="annexations"),
    "heat geodesic, stop annexations": partial(
        changed, filtration__heat="geodesic", filtration__stop="annexations"
    ),
    "response mahalanobis": partial(changed, response__distance="mahalanobis"),
    "preset paper": partial(ShapeConceptModel.preset, "paper"),
}


def fit(model: Model, objects: Sequence[object]) -> ShapeConceptModel:
    return model().fit(objects)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    for data, scans in scans_by_set(parser, options.only, SEEDS).items():
        labels = np.array([scan.label for scan in scans])
        segmented = [segment(scan) for scan in scans]
        described = {name: [describe(one, name) for one in segmented] for name in DESCRIPTORS}
        splits = stratified_splits(labels, REPEATS, random_state=0)
        table = []
        for name, model in VARIANTS.items():
            objects = described[str(model().descriptor)]
            learn = partial(fit, model)
            results = on_splits(learn, objects, labels, splits)
            scores = median_scores(results)
            table.append(
                (
                    name,
                    f"{scores.n_groups:.0f}",
                    f"{scores.explained:.3f}",
                    f"{scores.adjusted_mutual_information:.3f}",
                    f"{pooled_svm_error(results, labels, splits):.1f}",
                    f"{stability(learn, objects, N_SUBSETS):.3f}",
                )
            )
        print_table((data, "concepts", "explained", "AMI", "SVM, %", "stability"), table)
        print(flush=True)


if __name__ == "__main__":
    main()
