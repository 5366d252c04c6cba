"""What a user without labels gets who takes one method for all sets: every representation, every grouping.

    python benchmarks/rivals.py [--only SET ...] [--seeds SEED ...] [--jobs N]

All objects of a set are grouped, without a split and without labels, by every method that `evaluate` compares
with, under the same limit on the number of groups. A method is a representation, a way to group it and a way
to choose what that leaves open. Cells: groups, explained, adjusted mutual information, B-cubed F1; methods
with the most information, averaged over sets, come first. "simulated" are 66 objects a category of the
simulator, averaged over the seeds (100 to 102 by default), which count as one set. household_meshes are four
simulated scans of each mesh.

"shapeconcepts" is our filtration of our motif stimuli. "Best of all" knows the labels of a set, as nobody
does: it stands beside the one rival that is best on average, and beside ours. The last table holds what the
motifs add: scores of stimuli less those of whole-object rows of the same descriptor, by the same way to
group, averaged over sets.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings
from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from common import command, print_table
from concept_scores import scans_by_set
from shapeconcepts import Scan, ShapeConceptModel, describe, segment
from shapeconcepts.evaluation import (
    TopicModel,
    baseline_rows,
    grouping_baselines,
    grouping_scores,
    most_groups,
    point_histograms,
    whole_object_rows,
)
from shapeconcepts.evaluation.baselines import OUR_FILTRATION, STIMULI, WHOLE_OBJECT
from shapeconcepts.evaluation.labelled_objects import run

SETS = ("seven_shapes", "osd_learn", "restaurant_views", "household_meshes", "atwork_parts", "simulated")
SEEDS = (100, 101, 102)
MEASURES = ("explained", "AMI", "B-cubed F1")
INFORMATION = MEASURES.index("AMI")
OURS = (STIMULI, OUR_FILTRATION)

# A representation and a way to group it.
Method = tuple[str, str]
# Groups, and the three measures.
Scores = NDArray[np.float64]


def name_of(method: Method) -> str:
    return "shapeconcepts" if method == OURS else f"{method[0]}: {method[1]}"


def features(scan: Scan) -> tuple[object, ...]:
    """Of one scan: description, rows of the whole object, histograms of points."""
    segmented = segment(scan)
    return describe(segmented), baseline_rows([segmented]), point_histograms(segmented)


def groupings(scans: Sequence[Scan], n_jobs: int) -> Iterator[tuple[Method, NDArray[np.int64]]]:
    """Groups of all scans by every method."""
    described, of_objects, points = zip(
        *run(features, [(scan,) for scan in scans], n_jobs, None, ""), strict=True
    )
    rows = {name: np.concatenate([one[name] for one in of_objects]) for name in of_objects[0]}
    rows[WHOLE_OBJECT] = whole_object_rows(described)
    rows[STIMULI] = ShapeConceptModel().fit(described).stimuli_
    limit = most_groups(len(scans))
    for representation, of_set in rows.items():
        for method, grouping in grouping_baselines(of_set, limit).items():
            yield (representation, method), grouping.labels
    yield ("FPFH words", "topics"), TopicModel(limit).fit(points).grouping_.labels


def scored(groups: NDArray[np.int64], labels: Sequence[str | None]) -> Scores:
    scores = grouping_scores(groups, labels)
    return np.array(
        [scores.n_groups, scores.explained, scores.adjusted_mutual_information, scores.b_cubed_f1]
    )


def print_methods(results: dict[str, dict[Method, Scores]], ranking: Sequence[Method]) -> None:
    """All methods, the one with the most information first."""
    rows = []
    for method in ranking:
        of_sets = [by_method[method] for by_method in results.values()]
        mean = np.mean(of_sets, axis=0)[1:]
        cells = [f"{n:.0f} {' '.join(f'{value:.3f}' for value in values)}" for n, *values in of_sets]
        rows.append((name_of(method), *(f"{value:.3f}" for value in mean), *cells))
    print_table(("method", *(f"mean {name}" for name in MEASURES), *results), rows)


def print_best(results: dict[str, dict[Method, Scores]], ranking: Sequence[Method]) -> None:
    """For each set and measure, the best of all beside the single rival that is best on average, and ours."""
    single = next(method for method in ranking if method != OURS)
    rows = []
    for data, by_method in results.items():
        for measure, name in enumerate(MEASURES, start=1):
            best = max(by_method, key=lambda method: by_method[method][measure])
            better = sum(scores[measure] > by_method[OURS][measure] for scores in by_method.values())
            values = (by_method[method][measure] for method in (best, single, OURS))
            rows.append((f"{data}, {name}", *(f"{value:.3f}" for value in values), better, name_of(best)))
    titles = ("set", "best of all", name_of(single), name_of(OURS), "better than it", "best of all is")
    print_table(titles, rows)


def print_gain(results: dict[str, dict[Method, Scores]]) -> None:
    """Stimuli less whole-object rows by the same way to group, and on how many sets they are better."""
    rows = []
    for representation, way in next(iter(results.values())):
        if representation != STIMULI:
            continue
        gains = np.array(
            [by_method[STIMULI, way] - by_method[WHOLE_OBJECT, way] for by_method in results.values()]
        )[:, 1:]
        cells = (f"{gain.mean():+.3f} ({(gain > 0).sum()} of {len(gain)})" for gain in gains.T)
        rows.append((way, *cells))
    print_table((f"{STIMULI} less {WHOLE_OBJECT}", *MEASURES), rows)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=SETS, default=SETS, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED", help="of simulated")
    parser.add_argument("--jobs", type=int, default=1, metavar="N")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    collected: dict[str, dict[Method, list[Scores]]] = {}
    for data, scans in scans_by_set(parser, options.only, options.seeds).items():
        # The seeds of the simulator are one set.
        of_set = collected.setdefault(data.split()[0], defaultdict(list))
        labels = [scan.label for scan in scans]
        for method, groups in groupings(scans, options.jobs):
            of_set[method].append(scored(groups, labels))
        print(f"{data}: {len(scans)} objects of {len(set(labels))} labels", flush=True)
    results = {
        data: {method: np.mean(scores, axis=0) for method, scores in by_method.items()}
        for data, by_method in collected.items()
    }
    information = {
        method: np.mean([by_method[method][1:][INFORMATION] for by_method in results.values()])
        for method in next(iter(results.values()))
    }
    ranking = sorted(information, key=lambda method: -information[method])
    print()
    print_methods(results, ranking)
    print()
    print_best(results, ranking)
    print()
    print_gain(results)


if __name__ == "__main__":
    main()
