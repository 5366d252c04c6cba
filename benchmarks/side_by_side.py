"""Whether a change of the code left everything as it was that a user sees, and what it did to the times.

    python benchmarks/side_by_side.py OTHER_CHECKOUT [--repeats N]

"old" is another clone of the project, "new" is this one; each runs in a process of its own, in one thread,
the other one in its own .venv where it has one. Both learn with the default and with the paper's preset from
the shared data sets and from simulated scans of two seeds. A cell says "same", or "old -> new".

Results: "same" is the same to the last bit; of other numbers of the same kind, how many differ or by how much
at most. Scores: concepts, the share of the objects that are in a concept whose majority label is theirs, and
adjusted mutual information with labels, of a model of all objects; "new right" is the share of a quarter of
the objects whose predicted concept has their label, where the model learned from the other three quarters.
Files: "same" is byte for byte.

Times: medians of N runs (default 5), old and new in turns, milliseconds, and new / old; the kernels, compiled
anew on both sides, are warm. Segmenting and describing is for each of about 60 scans, `fit` from all
described objects, `predict` for each described object of the quarter.

The exit code is 1 if results, scores or files differ.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import json
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import numpy as np

# The old version runs this file, too: what is imported here, and used in `Worker`, must be in both.
import shapeconcepts as sc
from shapeconcepts.report.html import preview, write_report

ROOT = Path(__file__).resolve().parents[1]
SETS = ("seven_shapes", "osd_learn", "restaurant_views")
SEEDS = (100, 200)
PRESETS = ("default", "paper")
N_TIMED_SCANS = 60
# Titles of the tables.
RESULTS = ("results", "segment labels", "descriptions", "stimuli", "labels", "predictions")
SCORES = ("scores", "concepts", "explained", "AMI", "new right")
FILES = ("files, bytes", "model", "report")
TIMES = ("times, ms", "segment, describe", "fit", "predict", "load")


class Worker:
    """What one version makes of a set: arrays and files in a folder, everything else as answers."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def start(self) -> str:
        return sc.__file__

    def read(self, source: str | int) -> list[str]:
        """Read a folder of scans or of scenes, or simulate with a seed; labels."""
        if isinstance(source, int):
            self.scans = sc.datasets.simulate(n_per_category=66, random_state=source)
        else:
            is_scenes = any(Path(source).glob("*.pcd"))
            self.scans = sc.datasets.load_osd(Path(source)) if is_scenes else sc.read_scans(Path(source))
        self.segmented = [sc.segment(scan) for scan in self.scans]
        return [scan.label for scan in self.scans]

    def learn(self, preset: str, training: list[int], new: list[int]) -> int:
        """Learn from all objects and from the training objects; number of concepts."""
        self.model = sc.ShapeConceptModel.preset(preset)
        self.described = [sc.describe(one, self.model.descriptor) for one in self.segmented]
        self.new = [self.described[i] for i in new]
        self.model.fit(self.described)
        self.part = sc.ShapeConceptModel.preset(preset).fit([self.described[i] for i in training])
        descriptions = [one.description for one in self.described]
        histograms = [
            rows.ravel() for d in descriptions for rows in (d.segment_histograms, d.pair_histograms)
        ]
        arrays = {
            "segment labels": np.concatenate([one.segment_labels for one in self.segmented]),
            "descriptions": np.concatenate(histograms),
            "stimuli": self.model.stimuli_.toarray(),
            "labels": self.model.labels_,
            "part": self.part.labels_,
            "predictions": self.part.predict(self.new),
        }
        np.savez(self.folder / "results.npz", **arrays)
        self.model.save(self.folder / "model")
        write_report(self.folder / "report", self.model, [preview(one) for one in self.segmented])
        return len(self.model.concepts_)

    def run(self, preset: str) -> list[float]:
        """Milliseconds of what TIMES names."""
        timed = self.scans[:: max(1, len(self.scans) // N_TIMED_SCANS)]
        kind = self.model.descriptor
        return [
            milliseconds(lambda: [sc.describe(sc.segment(scan), kind) for scan in timed]) / len(timed),
            milliseconds(lambda: sc.ShapeConceptModel.preset(preset).fit(self.described)),
            milliseconds(lambda: self.part.predict(self.new)) / len(self.new),
            milliseconds(lambda: sc.load_model(self.folder / "model")),
        ]


def milliseconds(function: Callable[[], object]) -> float:
    start = time.perf_counter()
    function()
    return 1e3 * (time.perf_counter() - start)


def work(folder: Path) -> None:
    """Answer requests, one a line, until there are no more; what the library prints goes elsewhere."""
    answers, sys.stdout = sys.stdout, sys.stderr
    warnings.simplefilter("ignore")
    worker = Worker(folder)
    for line in sys.stdin:
        name, *arguments = json.loads(line)
        print(json.dumps(getattr(worker, name)(*arguments)), file=answers, flush=True)


class Side:
    """A checkout, and the process in which its version works."""

    def __init__(self, checkout: Path, python: str, folder: Path) -> None:
        self.folder = folder
        folder.mkdir()
        source = checkout.resolve() / "src"
        self._process = subprocess.Popen(
            [python, __file__, "--worker", str(folder)],
            # Kernels compiled before may be older than a constant that they use from another file.
            env={**os.environ, "PYTHONPATH": str(source), "NUMBA_CACHE_DIR": str(folder / "kernels")},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        found = Path(self.ask("start"))
        if not found.is_relative_to(source):
            sys.exit(f"{checkout}: no version of its own, {found} was imported instead")

    def ask(self, *request: object) -> Any:
        with suppress(BrokenPipeError):
            print(json.dumps(request), file=self._process.stdin, flush=True)
        answer = self._process.stdout.readline()
        if not answer:
            sys.exit(f"{self.folder.name}: its process ended at {request[0]!r}")
        return json.loads(answer)

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()

    def results(self) -> dict[str, np.ndarray]:
        with np.load(self.folder / "results.npz") as arrays:
            return dict(arrays)


def compared(old: np.ndarray, new: np.ndarray) -> str:
    if old.shape != new.shape or old.dtype != new.dtype:
        return f"{old.dtype} {old.shape} -> {new.dtype} {new.shape}"
    if old.tobytes() == new.tobytes():
        return "same"
    if old.dtype.kind == "f":
        return f"by up to {np.abs(old - new).max():.1e}"
    return f"{(old != new).sum():,} of {old.size:,}"


def compared_scores(old: float, new: float) -> str:
    texts = [f"{score}" if isinstance(score, int) else f"{score:.4f}" for score in (old, new)]
    return f"same: {texts[1]}" if old == new else " -> ".join(texts)


def compared_files(old: Path, new: Path) -> str:
    sizes = [f"{path.stat().st_size:,}" for path in (old, new)]
    if old.read_bytes() == new.read_bytes():
        return f"same: {sizes[1]}"
    return f"{' -> '.join(sizes)}{', other bytes' if sizes[0] == sizes[1] else ''}"


def main() -> None:
    # Here, as the old version need not have what these import.
    from common import RESTAURANT_SHAPES, SHARED_DATA, command, print_table
    from concept_scores import majority_labels
    from shapeconcepts.evaluation import grouping_scores, stratified_splits

    parser = command(__doc__)
    parser.add_argument("other", type=Path, metavar="OTHER_CHECKOUT", help="a clone of the old version")
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="timed runs (default: 5)")
    options = parser.parse_args()
    if not (options.other / "src" / "shapeconcepts").is_dir():
        parser.error(f"{options.other}: not a clone of the project")
    own_python = options.other.resolve() / ".venv" / "bin" / "python"
    python = str(own_python) if own_python.exists() else sys.executable
    sources = {name: str(SHARED_DATA / name) for name in SETS} | {f"simulated {s}": s for s in SEEDS}

    def scores(side: Side, n_concepts: int) -> list[float]:
        found = side.results()
        of_all = grouping_scores(found["labels"], labels)
        told = majority_labels(found["part"], labels[training])[found["predictions"]]
        right = float((told == labels[new]).mean())
        return [n_concepts, of_all.explained, of_all.adjusted_mutual_information, right]

    results, all_scores, files, times, ratios = [], [], [], [], []
    with (
        tempfile.TemporaryDirectory() as folder,
        closing(Side(options.other, python, Path(folder) / "old")) as of_old,
        closing(Side(ROOT, sys.executable, Path(folder) / "new")) as of_new,
    ):
        sides = (of_old, of_new)
        for name, source in sources.items():
            read, also_read = (side.ask("read", source) for side in sides)
            if read != also_read:
                sys.exit(f"{name}: the versions read other scans")
            labels = np.array([RESTAURANT_SHAPES.get(label, label) for label in read])
            training, new = stratified_splits(labels, 1, random_state=0)[0]
            for preset in PRESETS:
                row = f"{name} ({len(labels)}), {preset}"
                print(row, file=sys.stderr)
                learned = [side.ask("learn", preset, training.tolist(), new.tolist()) for side in sides]
                pair = [side.results() for side in sides]
                results.append([row, *(compared(*(found[key] for found in pair)) for key in RESULTS[1:])])
                all_scores.append([row, *map(compared_scores, *map(scores, sides, learned))])
                paths = [[side.folder / file for side in sides] for file in FILES[1:]]
                files.append([row, *(compared_files(*path) for path in paths)])
                runs = [[side.ask("run", preset) for side in sides] for _ in range(options.repeats)]
                medians = np.median(runs, axis=0)
                ratios.append(medians[1] / medians[0])
                cells = zip(*medians, ratios[-1], strict=True)
                times.append([row, *(f"{a:.2f} -> {b:.2f} ({ratio:.2f})" for a, b, ratio in cells)])

    times.append(["geometric mean", *(f"({mean:.2f})" for mean in np.exp(np.log(ratios).mean(axis=0)))])
    for titles, rows in ((RESULTS, results), (SCORES, all_scores), (FILES, files), (TIMES, times)):
        print_table(titles, rows)
        print()
    cells = [cell for table in (results, all_scores, files) for _, *row in table for cell in row]
    n_other = sum(not cell.startswith("same") for cell in cells)
    print(f"{n_other or 'none'} of {len(cells)} results, scores and files differ")
    sys.exit(1 if n_other else 0)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--worker"]:
        work(Path(sys.argv[2]))
    else:
        main()
