"""Do normals point to the sensor when its position is hidden from the code?

    python benchmarks/hidden_sensor.py [FOLDER] [--every N]

FOLDER is a folder of category folders of scans in the camera's frame (camera at the origin), by default
../shared/data/seven_shapes beside the repository, or a folder of labelled scenes as in osd_learn. Every scan
is given to `prepare` without its viewpoint: (a) centred on the object; (b) centred and turned at random; (c)
turned at random, half of its points dropped, the rest in random order. A scan passes if at least 99 % of its
normals satisfy n . (sensor - p) > 0.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import time
from collections import defaultdict

import numpy as np
from scipy.spatial.transform import Rotation

from common import add_folder, command, percent, print_table, scans_in
from shapeconcepts import Scan
from shapeconcepts.preparation import prepare

WAYS = ("centred", "turned", "turned, half")


def hide_sensor(scan: Scan, way: str, generator: np.random.Generator) -> tuple[Scan, np.ndarray]:
    """The scan in another frame and without a viewpoint, and where the sensor is in that frame."""
    points = scan.points[np.isfinite(scan.points).all(axis=1)]
    sensor = np.zeros(3) if scan.viewpoint is None else scan.viewpoint
    centre = points.mean(axis=0)
    turn = np.eye(3) if way == "centred" else Rotation.random(random_state=generator).as_matrix()
    if way == "turned, half":
        points = points[generator.permutation(len(points))[: len(points) // 2]]
    hidden = ((points - centre) @ turn.T).astype(np.float32)
    return Scan(hidden, name=scan.name, label=scan.label), turn @ (sensor - centre)


def share_towards(sensor: np.ndarray, points: np.ndarray, normals: np.ndarray) -> float:
    return float((np.einsum("ij,ij->i", normals, sensor - points) > 0).mean())


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="take every N-th scan (default: 1)")
    options = parser.parse_args()
    scans = scans_in(parser, options.folder)

    passed: dict[str, dict[str, list[bool]]] = {way: defaultdict(list) for way in WAYS}
    milliseconds = []
    generator = np.random.default_rng(0)
    for scan in scans[:: options.every]:
        for way in WAYS:
            hidden, sensor = hide_sensor(scan, way, generator)
            start = time.perf_counter()
            prepared = prepare(hidden)
            milliseconds.append(1000 * (time.perf_counter() - start))
            share = share_towards(sensor, prepared.points, prepared.normals)
            passed[way][scan.label or "scan"].append(share >= 0.99)

    print("scans with >= 99 % of their normals towards the hidden sensor, %")
    labels = sorted(passed[WAYS[0]])
    rows = [(label, [passed[way][label] for way in WAYS]) for label in labels]
    rows.append(("all", [np.concatenate(list(passed[way].values())) for way in WAYS]))
    print_table(
        ("", "scans", *WAYS), [[name, len(ways[0]), *(percent(way) for way in ways)] for name, ways in rows]
    )
    print(f"median time of prepare: {np.median(milliseconds):.1f} ms")


if __name__ == "__main__":
    main()
