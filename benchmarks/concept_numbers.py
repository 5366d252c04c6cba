"""Whether there are as many concepts as kinds of objects.

    python benchmarks/concept_numbers.py [--seeds SEED ...] [--draws N]

"One kind alone": the number of concepts of the scans of a single kind, for each kind of seven_shapes, of
three simulated seeds and of restaurant_views; the bars are a median of 1 and at most 3. "Unequal kinds": five
simulated kinds of 12, 20, 60, 200 and 600 scans in one set; the share of draws in which each has a concept of
its own, of which it is more than half; the bar is 80 %. "Many kinds": household_meshes (4 simulated views of
each mesh), atwork_parts, and "together", a set of 25: the folders of restaurant_views, 40 scans of each
simulated kind, and the household kinds that have no namesake among these; the bars are 0.7 to 1.6 times as
many concepts as kinds (1.5 for the last), and for the last 0.92 explained.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np

from common import SHARED_DATA, command, described, print_table, simulated_scans, views_of_meshes
from shapeconcepts import (
    DescribedObject,
    Scan,
    ShapeConceptModel,
    datasets,
    read_scans,
)
from shapeconcepts.evaluation import grouping_scores
from shapeconcepts.simulation.categories import CATEGORIES

SEEDS = (400, 401, 402)
COUNTS = (12, 20, 60, 200, 600)
# Kinds of household_meshes that restaurant_views or the simulator have, too.
NAMESAKES = {"ball", "bowl", "box", "cup", "cutlery", "plate"}


def labelled(scans: list[Scan], prefix: str = "") -> list[tuple[DescribedObject, str]]:
    """Scans that can be described, each with its label."""
    return [(one, f"{prefix}{one.label}") for one in described(scans)]


def learned(objects: list[tuple[DescribedObject, str]]) -> tuple[ShapeConceptModel, np.ndarray]:
    model = ShapeConceptModel().fit([one for one, _ in objects])
    return model, np.array([label for _, label in objects])


def one_kind_alone(sets: dict[str, list[tuple[DescribedObject, str]]]) -> None:
    table, numbers = [], []
    for name, objects in sets.items():
        kinds = sorted({label for _, label in objects})
        of_kind = {k: len(learned([o for o in objects if o[1] == k])[0].concepts_) for k in kinds}
        numbers += of_kind.values()
        table.append((name, ", ".join(f"{kind} {n}" for kind, n in of_kind.items())))
    table.append(("all", f"median {np.median(numbers):.0f}, at most {max(numbers)}"))
    print_table(("one kind alone", "concepts"), table)


def unequal_kinds(n_draws: int) -> None:
    has_its_own = []
    for draw in range(n_draws):
        kinds = np.random.default_rng(draw).permutation(CATEGORIES)[: len(COUNTS)]
        scans = [
            scan
            for kind, n in zip(kinds, COUNTS, strict=True)
            for scan in simulated_scans(str(kind), n, 10_000 + draw)
        ]
        model, labels = learned(labelled(scans))
        of_concept = [labels[concept.members] for concept in model.concepts_]
        has_its_own.append([any((one == kind).mean() > 0.5 for one in of_concept) for kind in kinds])
    shares = np.mean(has_its_own, axis=0)
    table = [(n, f"{share:.0%}") for n, share in zip(COUNTS, shares, strict=True)]
    print_table(
        ("scans of the kind", "draws with a concept of its own"), [*table, ("all", f"{shares.mean():.0%}")]
    )


def many_kinds(sets: dict[str, list[tuple[DescribedObject, str]]]) -> None:
    table = []
    for name, objects in sets.items():
        model, labels = learned(objects)
        scores = grouping_scores(model.labels_, labels)
        n_kinds = len(set(labels.tolist()))
        cells = (scores.explained, scores.adjusted_mutual_information, scores.b_cubed_f1)
        ratio = f"{len(model.concepts_) / n_kinds:.2f}"
        table.append(
            (name, len(objects), n_kinds, len(model.concepts_), ratio, *(f"{cell:.3f}" for cell in cells))
        )
    titles = ("scans", "kinds", "concepts", "ratio", "explained", "AMI", "B-cubed F1")
    print_table(("many kinds", *titles), table)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument(
        "--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED", help="of simulated kinds alone"
    )
    parser.add_argument("--draws", type=int, default=20, metavar="N", help="of unequal kinds")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    shapes = labelled(read_scans(SHARED_DATA / "seven_shapes"))
    restaurant = labelled(read_scans(SHARED_DATA / "restaurant_views"))
    household = labelled(views_of_meshes(SHARED_DATA / "household_meshes"))
    simulated = {
        f"simulated {seed}": labelled(datasets.simulate(n_per_category=66, random_state=seed))
        for seed in options.seeds
    }
    one_kind_alone({"seven_shapes": shapes, **simulated, "restaurant_views": restaurant})
    print(flush=True)
    together = [(one, f"restaurant {label}") for one, label in restaurant]
    together += labelled(datasets.simulate(n_per_category=40, random_state=options.seeds[0]), "simulated ")
    together += [(one, label) for one, label in household if label not in NAMESAKES]
    atwork = labelled(read_scans(SHARED_DATA / "atwork_parts"))
    many_kinds({"household_meshes": household, "atwork_parts": atwork, "together": together})
    print(flush=True)
    unequal_kinds(options.draws)


if __name__ == "__main__":
    main()
