"""How many actions take a user from scans without labels to a data set with all labels right.

    python benchmarks/labelling.py [--only SET ...] [--seeds SEED ...]

A scripted user answers what the model asks (`next_question`) until it asks no more. Asked what a concept is,
it looks at the scans shown and names the concept after most of them, or splits it along the tree where less
than three in five are of one kind. Asked which scans are something else, it puts each of these where it
belongs, and confirms the others. An action is a name, a split, a scan that is picked out, or a page that is
confirmed. The user knows the true label of what it is shown, and sees nothing else. Labels of
restaurant_views are its seven shapes, in which milk and yogurt are cartons.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from common import command, labelled_scans, print_table
from shapeconcepts import Scan, ShapeConceptModel, datasets

SETS = ("demo", "seven_shapes", "restaurant_views")
# Under this share of one kind, what is shown is a mixture.
MIXED = 0.6
MOST_ACTIONS = 200


class Labelling(NamedTuple):
    """What a scripted user did."""

    names: int
    splits: int
    picked: int
    confirmed: int
    edits: int
    n_wrong: int

    @property
    def actions(self) -> int:
        return self.names + self.splits + self.picked + self.confirmed


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="*", choices=SETS, default=SETS, metavar="SET")
    parser.add_argument(
        "--seeds", nargs="*", type=int, default=[], metavar="SEED", help="simulated sets, too"
    )
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    sets: dict[str, Sequence[Scan]] = {
        name: datasets.simulate(n_per_category=24) if name == "demo" else labelled_scans(parser, name)
        for name in options.only
    }
    for seed in options.seeds:
        sets[f"simulated {seed}"] = datasets.simulate(n_per_category=24, random_state=seed)
    rows = []
    for name, scans in sets.items():
        model = ShapeConceptModel(n_jobs=2).fit(scans)
        labels = [str(scan.label) for scan in scans]
        first = wrong_at_first(model, labels)
        done = answered(model, labels)
        rows.append([name, len(scans), len(set(labels)), len(model.concepts_), first, *done, done.actions])
    titles = ["set", "scans", "labels", "concepts", "wrong at first"]
    print_table([*titles, "names", "splits", "picked", "confirmed", "edits", "wrong", "actions"], rows)


def wrong_at_first(model: ShapeConceptModel, labels: Sequence[str]) -> int:
    """Scans that would be wrong if each concept were named after most of its scans."""
    right = sum(
        max(Counter(labels[i] for i in concept.members.tolist()).values()) for concept in model.concepts_
    )
    return len(labels) - right


def answered(model: ShapeConceptModel, labels: Sequence[str]) -> Labelling:
    """Answer all questions of a model, which is corrected."""
    names = splits = picked = confirmed = 0
    while names + splits + picked + confirmed < MOST_ACTIONS:
        question = model.next_question()
        if question is None:
            break
        shown = question.scans.tolist()
        if question.kind == "name":
            label, count = Counter(labels[i] for i in shown).most_common(1)[0]
            if count < MIXED * len(shown):
                try:
                    model.split(question.key)
                    splits += 1
                    continue
                except ValueError:
                    pass
            name(model, question.key, label)
            names += 1
            continue
        called = {i: concept.name for concept in model.concepts_ for i in concept.members.tolist()}
        for label in sorted({labels[i] for i in shown}):
            wrong = [i for i in shown if labels[i] == label and called.get(i) != label]
            if wrong:
                move(model, wrong, label)
                picked += len(wrong)
        model.confirm(shown)
        confirmed += 1
    called = {i: concept.name for concept in model.concepts_ for i in concept.members.tolist()}
    n_wrong = sum(called.get(i) != label for i, label in enumerate(labels))
    n_edits = len([edit for edit in model.journal if not edit.is_undone])
    return Labelling(names, splits, picked, confirmed, n_edits, n_wrong)


def name(model: ShapeConceptModel, key: int, label: str) -> None:
    """Name a concept; one that has the name already takes it in."""
    same = [concept.key for concept in model.concepts_ if concept.name == label]
    if same:
        model.merge([*same, key], label)
    else:
        model.rename(key, label)


def move(model: ShapeConceptModel, scans: Sequence[int], label: str) -> None:
    """Put scans where they belong, or into a new concept."""
    same = [concept.key for concept in model.concepts_ if concept.name == label]
    if same:
        model.move(scans, same[0])
    else:
        model.move(scans, name=label)


if __name__ == "__main__":
    main()
