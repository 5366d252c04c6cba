"""How often new scans are told right when a part of them is hidden, or something foreign is left in them.

    python benchmarks/hidden_parts.py [--only SET ...] [--seeds SEED ...] [--splits N]

Learned from 75 % of the scans. The others are predicted as they are; with a third, a half and two thirds of
the points hidden beyond a random line in the image; with whole segments hidden (one of two, two of more; of
scans of several segments); and with foreign points, 10, 20 and 30 % of all: a part of an object of another
label that touches them, or a strip of a table. Shown is the share of errors, as medians over splits: of
`predict`, where the right concept is one in which most have the scan's label, and unknown is an error; of the
label of whose scans a scan reminds most; and of the majority label of the five nearest whole-object
histograms, of the training scans alone and with their imagined occlusions. The last three use labels;
concepts do not. Last comes what imagining costs: time to learn, from points, and size of the model file, in
multiples of those without.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import time
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from changed_scans import foreign_object, segments_hidden, share_hidden, table_strip
from common import command, print_table
from concept_scores import SETS, scans_by_set
from shapeconcepts import DescribedObject, Scan, ScanError, ShapeConceptModel, describe, segment
from shapeconcepts.evaluation.experiments.hidden_parts import recognition_errors
from shapeconcepts.evaluation.splits import stratified_splits

ALL_SETS = (*SETS, "household_meshes", "atwork_parts")
SEEDS = (400, 401, 402)
Change = Callable[[Scan, np.random.Generator], Scan | None]
FOREIGN = (0.1, 0.2, 0.3)
RIVALS = ("predict", "by label", "whole", "whole + occlusions")


def changes(scans: list[Scan]) -> dict[str, Change]:
    """What is done to new scans, which may be joined with parts of any others."""
    found: dict[str, Change] = {"nothing": lambda scan, rng: scan}
    for title, share in (("1/3", 1 / 3), ("1/2", 1 / 2), ("2/3", 2 / 3)):
        found[f"{title} hidden"] = partial(share_hidden, share=share)
    found["segments hidden"] = segments_hidden
    for share in FOREIGN:
        found[f"{share:.0%} other object"] = partial(foreign_object, share=share, others=scans)
    for share in FOREIGN:
        found[f"{share:.0%} table"] = partial(table_strip, share=share)
    return found


def changed(scans: list[Scan], change: Change, number: int) -> list[DescribedObject | None]:
    """Scans after a change, described; None where that is not possible."""
    objects = []
    for index, scan in enumerate(scans):
        try:
            different = change(scan, np.random.default_rng((number, index)))
            objects.append(different and describe(segment(different)))
        except ScanError:
            objects.append(None)
    return objects


def errors(
    training: list[DescribedObject],
    labels: NDArray[np.str_],
    versions: list[list[DescribedObject | None]],
    new_labels: NDArray[np.str_],
) -> NDArray[np.float64]:
    """Share of errors of each rival on each version of new scans, (versions, rivals)."""
    new = []
    for objects in versions:
        usable = [i for i, one in enumerate(objects) if one]
        new.append(([objects[i] for i in usable], new_labels[usable]))
    return recognition_errors(training, labels, "default", new).T


def cost(scans: list[Scan]) -> tuple[float, float]:
    """Time to learn and size of the model file in multiples of those without imagined occlusions."""
    models = [ShapeConceptModel(), ShapeConceptModel().set_params(ensemble__n_occlusions=0)]
    seconds = np.empty((3, 2))
    with TemporaryDirectory() as folder:
        for turn in seconds:
            for number, model in enumerate(models):
                start = time.perf_counter()
                model.fit(scans)
                turn[number] = time.perf_counter() - start
        sizes = []
        for model in models:
            model.save(Path(folder) / "model")
            sizes.append((Path(folder) / "model").stat().st_size)
    return float(np.divide(*np.median(seconds, axis=0))), sizes[0] / sizes[1]


def instances_of(name: str, scans: Sequence[Scan | DescribedObject]) -> list[str] | None:
    """The mesh that each scan is a view of, where there are several views: none is on both sides."""
    return [scan.name.rpartition("_")[0] for scan in scans] if name == "household_meshes" else None


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=ALL_SETS, default=ALL_SETS, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED")
    parser.add_argument("--splits", type=int, default=5, metavar="N")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    lines, costs = [], []
    for name, scans in scans_by_set(parser, options.only, options.seeds).items():
        n_occlusions = ShapeConceptModel().get_params()["ensemble__n_occlusions"]
        usable, learned = [], []
        for scan in scans:
            try:
                learned.append(describe(segment(scan), n_occlusions=n_occlusions))
                usable.append(scan)
            except ScanError:
                continue
        labels = np.array([scan.label for scan in usable])
        versions = {
            title: changed(usable, change, number)
            for number, (title, change) in enumerate(changes(usable).items())
        }
        results = [
            errors(
                [learned[i] for i in training],
                labels[training],
                [[objects[i] for i in new] for objects in versions.values()],
                labels[new],
            )
            for training, new in stratified_splits(
                labels, options.splits, random_state=0, instances=instances_of(name, usable)
            )
        ]
        for title, row in zip(versions, np.median(results, axis=0), strict=True):
            lines.append([name, title, *(f"{cell:.3f}" for cell in row)])
            print(*lines[-1], flush=True)
        costs.append([name, *(f"{ratio:.2f}" for ratio in cost(usable))])
        print(*costs[-1], flush=True)
    print()
    print_table(("set", "new scans", *RIVALS), lines)
    print()
    print_table(("set", "time to learn", "model file"), costs)


if __name__ == "__main__":
    main()
