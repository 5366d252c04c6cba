"""Objects found in table-top scenes, beside what Open3D's planes and clusters find.

    python benchmarks/extraction.py osd [FOLDER]
    python benchmarks/extraction.py simulated [--seed S] [--scenes N]
    python benchmarks/extraction.py time [FOLDER] [--repeats N]
    python benchmarks/extraction.py learn [FOLDER]

`osd` takes the labelled scenes in FOLDER, by default ../shared/data/osd_learn beside the repository, and
hides the labels. `simulated` takes the first N scenes of a seed. An object is found if a predicted one has an
intersection over union of 0.75 or more with its points; at most one predicted object is right for it. Points
without a label do not count. Of a simulated scene, objects with fewer than 300 visible points are not looked
for; a predicted object that matches one is right all the same.

Rows show objects apart that touch: in simulated scenes those of which any part is within 1 cm of another
object, in real ones those with visible points so near. *Left together* are objects that one predicted object
holds with others, *and said* those where it tells that it may be several. Rows of all objects count all that
was predicted; others what lies for the most part on one of their objects.

`time` is the median time of a whole scene, all methods in turns; kernels are warm. "and responses" adds those
of a model to all of its objects, one after the other. `learn` learns concepts from the objects that are found
in the scenes of FOLDER, and from the annotated ones; the labels of both are those of their scenes.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "2")

import time
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import shapeconcepts as sc
from common import add_folder, command, percent, print_table
from shapeconcepts import Scene, datasets
from shapeconcepts.evaluation import grouping_scores
from shapeconcepts.evaluation.object_detection import match_objects, touching_objects
from shapeconcepts.sources.osd import scene_category

try:
    from euclidean_clusters import plane_and_clusters
except (ImportError, OSError) as error:  # its wheel needs system libraries that may be missing
    print(f"Open3D is left out: {error}")
    plane_and_clusters = None

SHAPE = (480, 640)
FEWEST_POINTS = 300
ALL = "all"

Extractor = Callable[[Scene], list[Any]]


class AnnotatedScene(NamedTuple):
    """A scene with labels, and the true objects to look for: their labels by the name of a table's row."""

    scene: Scene
    rows: dict[str, set[int]]

    def without_truth(self) -> Scene:
        scene = self.scene
        return Scene(scene.points, viewpoint=scene.viewpoint, up=scene.up, name=scene.name)


class Tally:
    """Counts of one row over all scenes."""

    def __init__(self) -> None:
        self.is_found: list[bool] = []
        self.is_right: list[bool] = []
        self.n_joined = self.n_said = 0

    def cells(self) -> tuple[object, ...]:
        return (
            len(self.is_found),
            percent(self.is_found),
            len(self.is_right),
            percent(self.is_right),
            self.n_joined,
            self.n_said,
        )


def extractors() -> dict[str, Extractor]:
    rivals = {} if plane_and_clusters is None else {"Open3D planes and clusters": plane_and_clusters}
    return {"shapeconcepts": sc.extract_objects, **rivals}


def osd_scenes(folder: Path) -> Iterator[AnnotatedScene]:
    for path in sorted(folder.glob("*.pcd"), key=lambda path: (len(path.stem), path.stem)):
        scan = sc.read_scan(path)
        labels = scan.point_labels.reshape(SHAPE)
        scene = Scene(
            scan.points.reshape(*SHAPE, 3), viewpoint=(0, 0, 0), name=path.stem, point_labels=labels
        )
        every = set((labels[labels >= 20] // 10 * 10).tolist())
        touching = touching_objects(scene.points, labels)
        category = scene_category(path.stem)
        yield AnnotatedScene(scene, {**rows_of(every, touching), f"{ALL}, label {category}": every})


def simulated_scenes(n_scenes: int, seed: int) -> Iterator[AnnotatedScene]:
    for index in range(n_scenes):
        scene = datasets.simulate_scene(index, random_state=seed)
        objects = [seen for seen in scene.objects if seen.n_points >= FEWEST_POINTS]
        rows = rows_of({seen.label for seen in objects}, {seen.label for seen in objects if seen.touching})
        rows["thin (1 cm or less)"] = {seen.label for seen in objects if seen.is_thin}
        rows["cut by the border"] = {seen.label for seen in objects if seen.is_cut}
        yield AnnotatedScene(scene, rows)


def rows_of(every: set[int], touching: set[int]) -> dict[str, set[int]]:
    return {ALL: every, "apart": every - touching, "touching or stacked": every & touching}


def tallies(scenes: Iterable[AnnotatedScene], methods: dict[str, Extractor]) -> dict[str, dict[str, Tally]]:
    """Counts by method and row."""
    counts: dict[str, dict[str, Tally]] = {name: {} for name in methods}
    for annotated in scenes:
        hidden = annotated.without_truth()
        for name, extract in methods.items():
            add(counts[name], annotated, extract(hidden))
    return counts


def add(counts: dict[str, Tally], annotated: AnnotatedScene, predicted: list[Any]) -> None:
    """Count what was predicted for one scene."""
    matches = match_objects(annotated.scene.point_labels, [found.indices for found in predicted])
    for row, labels in annotated.rows.items():
        tally = counts.setdefault(row, Tally())
        here = np.isin(matches.labels, list(labels))
        tally.is_found += matches.is_found[here].tolist()
        joined_in = matches.joined_in[here & ~matches.is_found]
        joined_in = joined_in[joined_in >= 0]
        tally.n_joined += len(joined_in)
        tally.n_said += sum(bool(predicted[number].may_be_several) for number in joined_in)
        counted = row.startswith(ALL) | np.isin(matches.main_labels, list(labels))
        tally.is_right += matches.is_right[counted].tolist()


def show(scenes: Iterable[AnnotatedScene]) -> None:
    titles = ("", "objects", "recall %", "predicted", "precision %", "left together", "and said")
    for name, rows in tallies(scenes, extractors()).items():
        print(f"\n{name}")
        print_table(titles, [(row, *tally.cells()) for row, tally in rows.items()])


def show_times(options: Namespace) -> None:
    scenes = [annotated.without_truth() for annotated in osd_scenes(options.folder)]
    model = sc.ShapeConceptModel().fit([one.scan for scene in scenes for one in sc.extract_objects(scene)])

    def with_responses(scene: Scene) -> list[Any]:
        return [model.recognise([one.scan]) for one in sc.extract_objects(scene)]

    methods = {**extractors(), "shapeconcepts, and responses": with_responses}
    taken: dict[str, list[float]] = {name: [] for name in methods}
    for method in methods.values():
        method(scenes[0])
    for _ in range(options.repeats):
        for scene in scenes:
            for name, extract in methods.items():
                start = time.perf_counter()
                extract(scene)
                taken[name].append(1e3 * (time.perf_counter() - start))
    rows = [(name, f"{np.median(times):.0f}", f"{max(times):.0f}") for name, times in taken.items()]
    print_table(("a scene of 640 x 480, ms", "median", "largest"), rows)


def show_learned(options: Namespace) -> None:
    """Concepts of what was found beside those of what was annotated."""
    annotated = datasets.load_osd(options.folder)
    found = [
        replace(one.scan, label=scene_category(scene.scene.name))
        for scene in osd_scenes(options.folder)
        for one in sc.extract_objects(scene.without_truth())
    ]
    rows = []
    for title, scans in (("annotated", annotated), ("found", found)):
        model = sc.ShapeConceptModel().fit(scans)
        scores = grouping_scores(model.labels_, np.array([scan.label for scan in scans]))
        values = (scores.explained, scores.adjusted_mutual_information)
        rows.append((title, len(scans), len(model.concepts_), *(f"{value:.3f}" for value in values)))
    print_table(("objects", "", "concepts", "explained", "AMI"), rows)


def main() -> None:
    parser = command(__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    add_folder(commands.add_parser("osd"), "osd_learn")
    simulated = commands.add_parser("simulated")
    simulated.add_argument("--seed", type=int, default=0, metavar="S")
    simulated.add_argument("--scenes", type=int, default=60, metavar="N")
    timed = commands.add_parser("time")
    add_folder(timed, "osd_learn")
    timed.add_argument("--repeats", type=int, default=3, metavar="N")
    add_folder(commands.add_parser("learn"), "osd_learn")
    options = parser.parse_args()
    if options.command == "learn":
        show_learned(options)
    elif options.command == "osd":
        show(osd_scenes(options.folder))
    elif options.command == "simulated":
        show(simulated_scenes(options.scenes, options.seed))
    else:
        show_times(options)


if __name__ == "__main__":
    main()
