"""How the share of exactly segmented objects falls off with size and distance; pictures of all shapes.

    python benchmarks/fall_off.py [--views N] [--images FOLDER]

Boxes (edges of 1, 0.85 and 0.7 times the size), cans (as wide as high) and balls are simulated at each size
and distance, from random directions. An object is exact if it has as many segments as true parts with 5 %
of the points; a part with 3.5 to 6.5 % may count either way, and 30 voxels are not asked for, so that small
objects count in full. Writes fall_off.png and a sheet of simulated objects of each category into FOLDER, by
default docs/images.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from common import command, print_table
from shapeconcepts import Scan, ScanError, datasets, segment
from shapeconcepts.report import draw_segments
from shapeconcepts.simulation.shapes import Mesh
from shapeconcepts.simulation.shapes.box import rounded_box
from shapeconcepts.simulation.shapes.mesh import ellipsoid, revolve
from true_parts import acceptable_counts, compare

SIZES = (0.04, 0.05, 0.06, 0.08, 0.10, 0.14, 0.20, 0.30)
DISTANCES = (0.6, 0.8, 1.0, 1.2, 1.4, 1.7, 2.0)
CELL_WIDTH, CELL_HEIGHT = 62, 44
LOW, HIGH = np.array([0xB3, 0x29, 0x4F]), np.array([0x30, 0x9F, 0x97])
INK = "#262b33"


def box(size: float) -> Mesh:
    return rounded_box(size * np.array([0.5, 0.425, 0.35]), radius=0.001)


def can(size: float) -> Mesh:
    radius = size / 2
    return revolve([0.0, radius, radius, 0.0], [0.0, 0.0, size, size], labels=[0, 1, 2])


def ball(size: float) -> Mesh:
    return ellipsoid(np.full(3, size / 2), n=48)


def is_exact(scan: Scan) -> bool:
    segmented = segment(scan)
    least, most = acceptable_counts(compare(scan, segmented), min_voxels=1)
    return least <= segmented.n_segments <= most


def share_exact(make: Callable[[float], Mesh], size: float, distance: float, views: int) -> float:
    mesh = make(size)
    flags = []
    for view in range(views):
        try:
            scan = datasets.scan_mesh(
                *mesh[:2], face_labels=mesh.face_labels, distance=distance, random_state=view
            )
        except ScanError:  # too large to be seen from so near
            return np.nan
        flags.append(is_exact(scan))
    return float(np.mean(flags))


def draw_table(draw: ImageDraw.ImageDraw, left: int, title: str, shares: NDArray[np.float64]) -> None:
    font, bold = ImageFont.load_default(size=17), ImageFont.load_default(size=22)
    width = len(DISTANCES) * CELL_WIDTH
    draw.text((left + width / 2, 24), title, fill=INK, font=bold, anchor="mm")
    for column, distance in enumerate(DISTANCES):
        middle = left + (column + 0.5) * CELL_WIDTH
        draw.text((middle, 58), f"{distance:g} m", fill=INK, font=font, anchor="mm")
        for row, share in enumerate(shares[:, column]):
            top = 76 + row * CELL_HEIGHT
            corners = (
                left + column * CELL_WIDTH,
                top,
                left + (column + 1) * CELL_WIDTH - 3,
                top + CELL_HEIGHT - 3,
            )
            if np.isnan(share):
                draw.rectangle(corners, fill="#eef0f2")
                continue
            # White between the two colours: readers who cannot tell them apart read the figures.
            end, strength = (HIGH, 2 * share - 1) if share > 0.5 else (LOW, 1 - 2 * share)
            colour = tuple((255 + (end - 255) * strength).astype(int).tolist())
            draw.rectangle(corners, fill=colour)
            ink = "white" if strength > 0.6 else INK
            draw.text((middle, top + CELL_HEIGHT / 2), f"{100 * share:.0f}", fill=ink, font=font, anchor="mm")


def draw_fall_off(shares: dict[str, NDArray[np.float64]], path: Path) -> None:
    font = ImageFont.load_default(size=17)
    step = len(DISTANCES) * CELL_WIDTH + 36
    picture = Image.new("RGB", (84 + len(shares) * step, 76 + len(SIZES) * CELL_HEIGHT + 12), "white")
    draw = ImageDraw.Draw(picture)
    for row, size in enumerate(SIZES):
        draw.text(
            (72, 76 + (row + 0.5) * CELL_HEIGHT), f"{100 * size:g} cm", fill=INK, font=font, anchor="rm"
        )
    for index, (title, table) in enumerate(shares.items()):
        draw_table(draw, 84 + index * step, title, table)
    picture.save(path)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--views", type=int, default=12, metavar="N", help="scans of each cell (default: 12)")
    images = Path(__file__).resolve().parents[1] / "docs" / "images"
    parser.add_argument("--images", type=Path, default=images, metavar="FOLDER", help="where to draw to")
    options = parser.parse_args()
    options.images.mkdir(parents=True, exist_ok=True)

    shares = {
        title: np.array([[share_exact(make, size, d, options.views) for d in DISTANCES] for size in SIZES])
        for title, make in (("boxes", box), ("cans", can), ("balls", ball))
    }
    for title, table in shares.items():
        print(f"\n{title}: exact number of segments, %")
        rows = [
            [f"{100 * s:g} cm", *(f"{100 * x:.0f}" for x in row)] for s, row in zip(SIZES, table, strict=True)
        ]
        print_table(("", *(f"{d:g} m" for d in DISTANCES)), rows)
    draw_fall_off(shares, options.images / "fall_off.png")

    for category in datasets.CATEGORIES:
        scans = datasets.simulate(18, categories=[category], random_state=0)
        sheet = options.images / f"{category}.png"
        draw_segments([segment(scan) for scan in scans], sheet, columns=6, size=200)


if __name__ == "__main__":
    main()
