"""What the benchmark commands share: where the data lies, the ensembles to compare, and tables."""

from __future__ import annotations

from argparse import ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from shapeconcepts import (
    DescribedObject,
    MotifHierarchyEnsemble,
    Scan,
    ScanError,
    SegmentDictionary,
    datasets,
    describe,
    read_scans,
    segment,
)
from shapeconcepts.descriptors.registry import DEFAULT

# Folders of restaurant_views that hold another shape than their name says.
RESTAURANT_SHAPES = {"cocacola": "can", "milk": "carton", "yogurt": "carton", "fork": "cutlery"}
SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
VIEWS_OF_A_MESH = 4


def command(description: str) -> ArgumentParser:
    """Parser of a command whose docstring is its manual."""
    return ArgumentParser(description=description, formatter_class=RawDescriptionHelpFormatter)


def add_folder(parser: ArgumentParser, name: str) -> None:
    """Add the argument `folder`, by default one of the shared data sets."""
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        default=SHARED_DATA / name,
        help=f"data; by default ../shared/data/{name} beside the repository",
    )


def scans_in(parser: ArgumentParser, folder: Path) -> list[Scan]:
    """Scans of a folder of category folders, or the objects of labelled scenes."""
    try:
        return datasets.load_osd(folder) if any(folder.glob("*.pcd")) else read_scans(folder)
    except ScanError as error:
        parser.error(str(error))


def simulated_scans(category: str, n: int, seed: int) -> list[Scan]:
    """The first n simulated scans of a category, but for objects of which next to nothing is ever visible."""
    scans = []
    for index in range(n):
        try:
            scans.append(datasets.simulate_scan(category, index, random_state=seed))
        except ScanError:
            continue
    return scans


def described(
    scans: Iterable[Scan], descriptor: str = DEFAULT, n_occlusions: int = 0
) -> list[DescribedObject]:
    """Scans that can be segmented, described."""
    found = []
    for scan in scans:
        try:
            found.append(describe(segment(scan), descriptor, n_occlusions))
        except ScanError:
            continue
    return found


def labelled_scans(parser: ArgumentParser, name: str) -> list[Scan]:
    """Scans of one of the shared data sets by its folder's name, or "simulated", with labels of shapes."""
    if name == "simulated":
        return datasets.simulate(n_per_category=66, random_state=100)
    if name == "household_meshes":
        return views_of_meshes(SHARED_DATA / name)
    scans = scans_in(parser, SHARED_DATA / name)
    return [replace(scan, label=RESTAURANT_SHAPES.get(scan.label, scan.label)) for scan in scans]


def views_of_meshes(folder: Path) -> list[Scan]:
    """Four simulated scans of each mesh in the folders of a folder, from random sides."""
    scans = []
    for number, path in enumerate(sorted(folder.glob("*/*.ply"))):
        mesh = trimesh.load(path, process=False, force="mesh")
        for view in range(VIEWS_OF_A_MESH):
            rng = np.random.default_rng((number, view))
            name, label = f"{path.stem}_{view}", path.parent.name
            scans.append(
                datasets.scan_mesh(mesh.vertices, mesh.faces, random_state=rng, name=name, label=label)
            )
    return scans


def ensembles() -> dict[str, tuple[str, MotifHierarchyEnsemble]]:
    """The default, motifs as columns under each descriptor, and the paper's, by name, with descriptors."""
    return {
        "default": (DEFAULT, MotifHierarchyEnsemble()),
        "motifs as columns, surflet": ("surflet", motifs_as_columns()),
        "motifs as columns, fpfh": ("fpfh", motifs_as_columns()),
        "preset paper": ("fpfh", MotifHierarchyEnsemble.preset("paper")),
    }


def motifs_as_columns() -> MotifHierarchyEnsemble:
    """Eight levels of words, as it takes many to tell objects apart by words alone."""
    return MotifHierarchyEnsemble(SegmentDictionary(n_levels=8), columns="motifs")


def percent(flags: Sequence[bool] | NDArray[np.bool_]) -> str:
    """Share of what is true, as text; "-" where there is nothing."""
    return f"{100 * np.mean(flags):.1f}" if len(flags) else "-"


def print_table(titles: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Columns as wide as they need, the first to the left, the others to the right."""
    lines = [[str(cell) for cell in row] for row in (titles, *rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(titles))]
    for line in lines:
        cells = [cell.rjust(width) for cell, width in zip(line, widths, strict=True)]
        print("  ".join([line[0].ljust(widths[0]), *cells[1:]]).rstrip())
