"""Segments of real crops and of views without a known sensor position.

    python benchmarks/real_crops.py [OSD_FOLDER [VIEWS_FOLDER]] [--image FOLDER] [--verbose]

OSD_FOLDER holds labelled scenes of boxes and cylindric objects, by default ../shared/data/osd_learn beside
the repository; VIEWS_FOLDER a folder of single-object views for each category, by default
../shared/data/restaurant_views. --image draws contact sheets of all of them into a folder.

Shown are the number of segments, and how many objects have a surface that is cut into strips. Both are
found without annotated parts:

* Cylinders (crops of cans, views of cocacola). The axis is the direction to which the object's normals are
  as parallel or perpendicular as they get. A segment with at least 5 % of a part is a side if its median
  normal is more than 45 degrees from the axis. Of each part, that is each voxel-connected set of voxels
  with one label, only one side may bulge outwards, and only one inwards: the inside of an open cup is
  another surface than its outside.
* Cartons (milk, yogurt). A face is cut if two adjacent segments have mean normals less than 20 degrees apart.
"""

import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from common import SHARED_DATA, command, percent, print_table, scans_in
from shapeconcepts import Scan, ScanError, SegmentedObject, segment
from shapeconcepts.report import draw_segments

CANS = ("can", "cocacola")
CARTONS = ("milk", "yogurt")
MIN_SHARE = 0.05
MIN_PART_VOXELS = 30
SAME_FACE = np.radians(20.0)


def cylinder_axis(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Direction (3,) to which normals are as parallel or perpendicular as they get."""
    index = np.arange(1500) + 0.5
    z, turn = index / len(index), index * np.pi * (3 - np.sqrt(5))
    directions = np.column_stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])
    cosine = np.abs(normals @ directions.T)
    return directions[np.minimum(cosine, 1 - cosine).mean(axis=0).argmin()]


def connected_parts(segmented: SegmentedObject, labels: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
    """Voxels of each connected set of voxels with the same label, small ones left out."""
    pairs = cKDTree(segmented.points).query_pairs(2 * segmented.voxel_size, output_type="ndarray")
    pairs = pairs[labels[pairs[:, 0]] == labels[pairs[:, 1]]]
    m = len(labels)
    _, part = connected_components(csr_array((np.ones(len(pairs)), pairs.T), shape=(m, m)), directed=False)
    for index in range(part.max() + 1):
        members = np.flatnonzero(part == index)
        if len(members) >= MIN_PART_VOXELS:
            yield members


def voxel_labels(scan: Scan, segmented: SegmentedObject) -> NDArray[np.int64]:
    """Annotated label of most points of each voxel, 0 where there is no annotation."""
    if scan.point_labels is None:
        return np.zeros(len(segmented.points), np.int64)
    values, label = np.unique(scan.point_labels, return_inverse=True)
    votes = np.zeros((len(segmented.points), len(values)), int)
    kept = segmented.point_to_voxel >= 0
    np.add.at(votes, (segmented.point_to_voxel[kept], label[kept]), 1)
    return values[votes.argmax(axis=1)]


def sides_of_parts(scan: Scan, segmented: SegmentedObject) -> list[tuple[int, int]]:
    """For each part of a cylinder, how many side segments bulge outwards and inwards."""
    axis = cylinder_axis(segmented.normals)
    sides = []
    for members in connected_parts(segmented, voxel_labels(scan, segmented)):
        counts = [0, 0]
        for index in range(segmented.n_segments):
            own = members[segmented.segment_labels[members] == index]
            if len(own) < MIN_SHARE * len(members):
                continue
            points, normals = segmented.points[own], segmented.normals[own]
            if np.median(np.abs(normals @ axis)) < np.cos(np.pi / 4):
                bulge = np.einsum("ij,ij->", normals, points - points.mean(axis=0))
                counts[int(bulge < 0)] += 1
        sides.append((counts[0], counts[1]))
    return sides


def has_cut_face(segmented: SegmentedObject) -> bool:
    means = np.array(
        [segmented.normals[segmented.segment_labels == s].mean(axis=0) for s in range(segmented.n_segments)]
    )
    means /= np.linalg.norm(means, axis=1, keepdims=True)
    first, second = segmented.segment_edges.T
    return bool((np.einsum("ij,ij->i", means[first], means[second]) > np.cos(SAME_FACE)).any())


def is_in_strips(scan: Scan, segmented: SegmentedObject) -> bool:
    if scan.label in CANS:
        return any(max(counts) > 1 for counts in sides_of_parts(scan, segmented))
    return scan.label in CARTONS and has_cut_face(segmented)


def report(scans: list[Scan], images: Path | None, verbose: bool) -> None:
    rows = []
    all_cuts = []
    for category in sorted({scan.label for scan in scans}):
        members = [scan for scan in scans if scan.label == category]
        done: list[tuple[Scan, SegmentedObject]] = []
        for scan in members:
            try:
                done.append((scan, segment(scan)))
            except ScanError as error:
                print(f"not segmented: {error}")
        numbers = Counter(segmented.n_segments for _, segmented in done)
        cuts = []
        if category in CANS + CARTONS:
            cuts = [is_in_strips(scan, segmented) for scan, segmented in done]
            all_cuts += cuts
            if verbose:
                names = [scan.name for (scan, _), cut in zip(done, cuts, strict=True) if cut]
                print(f"{category}, cut into strips: {', '.join(names) or 'none'}")
        if category == "box" and verbose:
            odd = [scan.name for scan, segmented in done if segmented.n_segments not in (2, 3)]
            print(f"box, neither 2 nor 3 segments: {', '.join(odd) or 'none'}")
        histogram = ", ".join(f"{numbers[n]} x {n}" for n in sorted(numbers))
        two_or_three = [segmented.n_segments in (2, 3) for _, segmented in done]
        rows.append(
            [
                category,
                len(members),
                len(done),
                percent(two_or_three),
                percent(np.logical_not(cuts)),
                histogram,
            ]
        )
        if images is not None:
            sheet = images / f"{category}.png"
            draw_segments([segmented for _, segmented in done], sheet, columns=8, size=240)
    print_table(
        ("", "scans", "segmented", "2 or 3 segments, %", "not in strips, %", "how many x segments"), rows
    )
    print(f"cans and cartons not in strips: {percent(np.logical_not(all_cuts))} %")


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("osd", nargs="?", type=Path, default=SHARED_DATA / "osd_learn", metavar="OSD_FOLDER")
    parser.add_argument(
        "views", nargs="?", type=Path, default=SHARED_DATA / "restaurant_views", metavar="VIEWS_FOLDER"
    )
    parser.add_argument("--image", type=Path, metavar="FOLDER", help="draw contact sheets into this folder")
    parser.add_argument("--verbose", action="store_true", help="list the scans that are cut")
    options = parser.parse_args()
    if options.image is not None:
        options.image.mkdir(parents=True, exist_ok=True)
    for folder in (options.osd, options.views):
        print(f"\n{folder.name}")
        report(scans_in(parser, folder), options.image, options.verbose)


if __name__ == "__main__":
    main()
