"""Segments against the true parts of boxes, cans and balls.

    python benchmarks/segment_accuracy.py [FOLDER] [--simulated SEED ...] [--verbose]

FOLDER holds a folder of labelled scans for each category, by default ../shared/data/seven_shapes beside the
repository; --simulated takes scans of the project's own simulator instead, 66 of each category and seed.

Shown are the share of the scans with the exact number of segments, and the adjusted Rand index of segments
and parts over the points that belong to a segment. A part counts from 5 % of these points and 30 voxels on;
one with 3.5 to 6.5 % may count either way. "near" are objects whose visible surface measures 4 cm or more
and whose median point is within 1.0 m of the sensor. "edge" is the shortest edge of a box, the lesser of
diameter and height of a can, as far as it is seen (see `true_parts.shortest_edge`). The index is measured
three times: each point with its own true part ("points"), and each voxel with the part of most of its
points ("voxels"). It is 0 where one face is all that counts, one segment is found, and a few points belong
to another face; so it is also measured over the points of the parts that count ("no slivers").
"""

import os
from typing import NamedTuple

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np

from common import add_folder, command, percent, print_table, scans_in
from shapeconcepts import Scan, datasets, segment
from true_parts import (
    acceptable_counts,
    adjusted_rand_index,
    compare,
    index_without_slivers,
    shortest_edge,
)

CATEGORIES = ("box", "can", "ball")
NEAR = 1.0
SMALLEST = 0.04
SHORT_EDGE = 0.08


class Result(NamedTuple):
    scan: Scan
    distance: float
    extent: float
    edge: float
    n_segments: int
    counts: tuple[int, int]
    index_of_points: float
    index_of_voxels: float
    index_without_slivers: float

    @property
    def is_exact(self) -> bool:
        return self.counts[0] <= self.n_segments <= self.counts[1]

    @property
    def is_near(self) -> bool:
        return self.distance <= NEAR and self.extent >= SMALLEST


def evaluate(scan: Scan) -> Result:
    segmented = segment(scan)
    parts = compare(scan, segmented)
    points = scan.points[np.isfinite(scan.points).all(axis=1)]
    return Result(
        scan=scan,
        distance=float(np.linalg.norm(np.median(points, axis=0) - scan.viewpoint)),
        extent=float(np.ptp(points, axis=0).max()),
        edge=shortest_edge(parts),
        n_segments=segmented.n_segments,
        counts=acceptable_counts(parts),
        index_of_points=adjusted_rand_index(parts.point_parts, parts.point_segments),
        index_of_voxels=adjusted_rand_index(parts.voxel_parts, parts.voxel_segments),
        index_without_slivers=index_without_slivers(parts),
    )


def is_wanted(scan: Scan) -> bool:
    return scan.label in CATEGORIES and scan.point_labels is not None and scan.viewpoint is not None


def exact_row(title: str, results: list[Result]) -> list[object]:
    groups = (
        [result for result in results if result.is_near],
        [result for result in results if result.extent >= SMALLEST],
        results,
    )
    cells = [(len(group), percent([result.is_exact for result in group])) for group in groups]
    return [title, *(cell for pair in cells for cell in pair)]


def index_row(title: str, results: list[Result]) -> list[object]:
    if not results:
        return [title, 0, *6 * ["-"]]
    indices = np.array([(r.index_of_points, r.index_of_voxels, r.index_without_slivers) for r in results])
    figures = np.column_stack([indices.mean(axis=0), np.median(indices, axis=0)]).ravel()
    return [title, len(results), *(f"{figure:.3f}" for figure in figures)]


def report(results: list[Result], verbose: bool) -> None:
    by_category = {name: [r for r in results if r.scan.label == name] for name in CATEGORIES}
    print("\nexact number of segments, %")
    print_table(
        ("", "near", "exact", "4 cm and more", "exact", "all", "exact"),
        [exact_row(name, group) for name, group in (*by_category.items(), ("together", results))],
    )
    print("\nadjusted Rand index, near")
    rows = []
    for name in ("box", "can"):
        near = [result for result in by_category[name] if result.is_near]
        rows.append(index_row(name, near))
        rows.append(index_row("  edges of 8 cm or more", [r for r in near if r.edge >= SHORT_EDGE]))
        rows.append(index_row("  an edge under 8 cm", [r for r in near if r.edge < SHORT_EDGE]))
    print_table(
        ("", "scans", "points: mean", "median", "voxels: mean", "median", "no slivers: mean", "median"), rows
    )
    if verbose:
        print("\nnot exact")
        print_table(
            ("scan", "near", "distance", "extent", "edge", "segments", "expected", "index"),
            [
                [
                    r.scan.name,
                    "yes" if r.is_near else "no",
                    f"{r.distance:.2f}",
                    f"{r.extent:.3f}",
                    f"{r.edge:.3f}",
                    r.n_segments,
                    " to ".join(map(str, sorted(set(r.counts)))),
                    f"{r.index_of_points:.2f}",
                ]
                for r in results
                if not r.is_exact
            ],
        )


def main() -> None:
    parser = command(__doc__)
    add_folder(parser, "seven_shapes")
    parser.add_argument("--simulated", type=int, nargs="+", metavar="SEED", help="seeds of the simulator")
    parser.add_argument("--n-per-category", type=int, default=66, metavar="N", help="scans to simulate")
    parser.add_argument("--verbose", action="store_true", help="list the scans that are not exact")
    options = parser.parse_args()
    if options.simulated is None:
        sources = {str(options.folder.name): scans_in(parser, options.folder)}
    else:
        sources = {
            f"simulated, seed {seed}": datasets.simulate(
                options.n_per_category, categories=CATEGORIES, random_state=seed
            )
            for seed in options.simulated
        }
    everything = []
    for name, scans in sources.items():
        results = [evaluate(scan) for scan in scans if is_wanted(scan)]
        if not results:
            parser.error(f"{options.folder}: holds no labelled scans of {', '.join(CATEGORIES)}")
        everything += results
        print(f"\n{name}: {len(results)} scans")
        report(results, options.verbose)
    if len(sources) > 1:
        print(f"\nall seeds: {len(everything)} scans")
        report(everything, verbose=False)


if __name__ == "__main__":
    main()
