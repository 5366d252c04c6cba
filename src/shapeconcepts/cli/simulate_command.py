"""`shapeconcepts simulate`: labelled simulated scans as files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from shapeconcepts.cli.terminal import fail, progress, say, tell_json


def simulate(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR",
            file_okay=False,
            show_default=False,
            help="Folder to write to; it is made if need be. Each category gets a folder of its own inside.",
        ),
    ],
    n_per_category: Annotated[int, typer.Option(min=1, help="Scans of each category.")] = 10,
    categories: Annotated[
        str,
        typer.Option(
            metavar="NAME,NAME,…",
            help="Some of sack, can, box, teddy, ball, amphora, plate.",
            show_default="all seven",
        ),
    ] = "",
    random_state: Annotated[int, typer.Option(min=0, help="Seed: the same seed gives the same scans.")] = 0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was written as JSON.")] = False,
) -> None:
    """Write simulated scans of everyday objects, labelled by folder, as PCD files.

    Sacks, cans, boxes, teddies, balls, amphorae and plates, each seen once by a simulated Kinect: with its
    noise, lost points and, for a third of them, something in front. The field "label" of the files is the
    true surface part of each point (box face, can side, can cap …).
    """
    from shapeconcepts.datasets import CATEGORIES, simulate_scan
    from shapeconcepts.io.write_pcd import write_pcd

    chosen = [name.strip() for name in categories.split(",")] if categories else list(CATEGORIES)
    for name in chosen:
        if name not in CATEGORIES:
            raise typer.BadParameter(
                f"unknown category {name!r}, expected some of {', '.join(CATEGORIES)}",
                param_hint="--categories",
            )
    targets = [
        (folder / name / f"{name}_{index:03d}.pcd", name, index)
        for name in dict.fromkeys(chosen)
        for index in range(n_per_category)
    ]
    if not force:
        existing = [path for path, _, _ in targets if path.exists()]
        if existing:
            fail(f"{existing[0]} exists already ({len(existing)} such files); --force overwrites them")

    written = []
    try:
        for path, name, index in progress(targets, len(targets), "Simulating"):
            scan = simulate_scan(name, index, random_state=random_state)
            path.parent.mkdir(parents=True, exist_ok=True)
            write_pcd(path, scan)
            written.append({"path": str(path), "label": name, "n_points": len(scan)})
    except OSError as error:
        fail(f"cannot write to {folder}: {error.strerror or error}")
    if as_json:
        tell_json({"folder": str(folder), "random_state": random_state, "files": written})
    else:
        say(f"Wrote {len(written)} scans of {len(set(chosen))} categories to {folder}")
