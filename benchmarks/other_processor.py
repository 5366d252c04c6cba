"""What another processor changes: kernels compiled and sums rounded for the oldest x86-64, and for this one.

    python benchmarks/other_processor.py [FOLDER] [--every N]

Every N-th scan (default 4) in FOLDER, by default ../shared/data/seven_shapes beside the repository, and 84
simulated ones, every second without its viewpoint, are segmented, learned from and asked about twice, each
time in a process of its own: with the instructions that the machine has, and with those that every x86-64 has
(numba's NUMBA_CPU_NAME, OpenBLAS's OPENBLAS_CORETYPE), for which the kernels are compiled anew. Shown is how
many scans have other segments, other concepts and other predictions, and the largest difference of stimuli
and of responses.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import pickle
import subprocess
import sys
import tempfile
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from common import add_folder, command, print_table, scans_in
from shapeconcepts import ShapeConceptModel, datasets, segment
from shapeconcepts.model import PRESETS

OLDEST = {"NUMBA_CPU_NAME": "x86-64", "NUMBA_CPU_FEATURES": "+sse,+sse2", "OPENBLAS_CORETYPE": "Prescott"}


def work(scans_file: Path, answers_file: Path) -> None:
    """Segment, learn, and ask about all scans, in this process."""
    warnings.simplefilter("ignore")
    segmented = [segment(scan) for scan in pickle.loads(scans_file.read_bytes())]
    answers = {"segments": [np.append(one.segment_labels, -1)[one.point_to_voxel] for one in segmented]}
    for preset in PRESETS:
        model = ShapeConceptModel.preset(preset).fit(segmented)
        stimuli = model.stimuli(segmented)
        answers[preset] = (
            model.labels_,
            model.response_.predict(stimuli),
            stimuli.toarray(),
            model.response_.transform(stimuli),
        )
    answers_file.write_bytes(pickle.dumps(answers))


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--every", type=int, default=4, metavar="N", help="take every N-th scan (default: 4)")
    parser.add_argument("--work", nargs=2, type=Path, metavar=("SCANS", "ANSWERS"), help="only one side")
    options = parser.parse_args()
    if options.work:
        work(*options.work)
        return
    simulated = datasets.simulate(n_per_category=12, random_state=3)
    scans = [scan if i % 2 else replace(scan, viewpoint=None) for i, scan in enumerate(simulated)]
    scans += scans_in(parser, options.folder)[:: options.every]
    sides = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scans").write_bytes(pickle.dumps(scans))
        for changes in ({}, {**OLDEST, "NUMBA_CACHE_DIR": str(folder / "kernels")}):
            arguments = [sys.executable, __file__, "--work", str(folder / "scans"), str(folder / "answers")]
            subprocess.run(arguments, env={**os.environ, **changes}, check=True)
            sides.append(pickle.loads((folder / "answers").read_bytes()))
    here, there = sides
    pairs = zip(here["segments"], there["segments"], strict=True)
    print(f"{len(scans)} scans, {sum((one != other).any() for one, other in pairs)} with other segments")
    rows = []
    for preset in PRESETS:
        labels, predictions, *numbers = zip(here[preset], there[preset], strict=True)
        changed = [f"{(one != other).sum()}" for one, other in (labels, predictions)]
        farthest = [
            f"{np.nanmax(np.abs(one - other)):.0e}" if one.shape == other.shape else "other columns"
            for one, other in numbers
        ]
        rows.append([f"preset {preset}", *changed, *farthest])
    print_table(("", "other concept", "other prediction", "stimuli differ by", "responses by"), rows)


if __name__ == "__main__":
    main()
