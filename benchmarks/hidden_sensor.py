"""Do normals point to the sensor when its position is hidden from the code?

    python benchmarks/hidden_sensor.py [DATA] [--every N]

DATA is a folder of category folders of scans in the camera's frame (camera at the origin), by default
../shared/data/seven_shapes beside the repository, or a folder of labelled scenes as in osd_learn. Every scan
is given to `prepare` without its viewpoint: (a) centred on the object; (b) centred and turned at random; (c)
turned at random, half of its points dropped, the rest in random order. A scan passes if at least 99 % of its
normals satisfy n . (sensor - p) > 0.
"""

import argparse
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from shapeconcepts import Scan, datasets, read_scans
from shapeconcepts.preparation import prepare

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "seven_shapes"
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
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("data", nargs="?", type=Path, default=DATA)
    parser.add_argument("--every", type=int, default=1, help="take every N-th scan")
    arguments = parser.parse_args()
    has_scenes = any(arguments.data.glob("*.pcd"))
    scans = datasets.load_osd(arguments.data) if has_scenes else read_scans(arguments.data)

    passed: dict[str, dict[str, list[bool]]] = {way: defaultdict(list) for way in WAYS}
    milliseconds = []
    generator = np.random.default_rng(0)
    for scan in scans[:: arguments.every]:
        for way in WAYS:
            hidden, sensor = hide_sensor(scan, way, generator)
            start = time.perf_counter()
            prepared = prepare(hidden)
            milliseconds.append(1000 * (time.perf_counter() - start))
            share = share_towards(sensor, prepared.points, prepared.normals)
            passed[way][scan.label or "scan"].append(share >= 0.99)

    print("scans with >= 99 % of their normals towards the hidden sensor, %")
    print(f"{'category':12} {'scans':>6} " + " ".join(f"{way:>14}" for way in WAYS))
    for label in sorted(passed[WAYS[0]]):
        shares = " ".join(f"{100 * np.mean(passed[way][label]):14.1f}" for way in WAYS)
        print(f"{label:12} {len(passed[WAYS[0]][label]):6} {shares}")
    totals = [np.concatenate(list(passed[way].values())) for way in WAYS]
    print(f"{'all':12} {len(totals[0]):6} " + " ".join(f"{100 * total.mean():14.1f}" for total in totals))
    print(f"median time of prepare: {np.median(milliseconds):.1f} ms")


if __name__ == "__main__":
    main()
