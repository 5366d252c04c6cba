"""Labelled data sets for the evaluation, segmented through the user's cache."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from shapeconcepts.cli.object_reader import ObjectReader, read_objects
from shapeconcepts.cli.terminal import busy, fail, progress, say

if TYPE_CHECKING:
    from shapeconcepts.cli.object_reader import Source
    from shapeconcepts.scan import Scan
    from shapeconcepts.segmentation import SegmentedObject
    from shapeconcepts.sources.reader import ReadOptions


@dataclass
class SegmentedSet:
    """Segmented objects of a data set, with labels, and what was left out."""

    name: str
    segmented: list[SegmentedObject] = field(default_factory=list)
    instances: list[str | None] = field(default_factory=list)
    notices: list[tuple[str, str]] = field(default_factory=list)
    skipped: list[tuple[str, str]] = field(default_factory=list)


def parse_renames(texts: Sequence[str]) -> dict[str, str]:
    """New label by old one, from ``OLD=NEW``."""
    renames = {}
    for text in texts:
        old, equals, new = text.partition("=")
        if not (old and equals and new):
            raise typer.BadParameter(f"must be OLD=NEW, got {text!r}", param_hint="--rename")
        renames[old] = new
    return renames


def segment_set(
    name: str, sources: Sequence[Source], skipped: Sequence[tuple[str, str]], reader: ObjectReader, jobs: int
) -> SegmentedSet:
    """Segment a data set; scans that cannot be are skipped."""
    found = SegmentedSet(name, skipped=list(skipped))
    cache_failure = ""
    reading = read_objects(sources, reader, jobs)
    shown = progress(reading, len(sources), f"Segmenting {name}")
    for source, objects in zip(sources, shown, strict=True):
        for one in objects:
            cache_failure = cache_failure or one.cache_failure
            if one.segmented is None:
                found.skipped.append((one.name, one.reason))
            else:
                found.segmented.append(one.segmented)
                found.notices += [(one.name, notice) for notice in one.notices]
                found.instances.append(getattr(source, "instance", None))
    if cache_failure:
        say(f"Note: segments are not kept for the next time ({cache_failure})")
    if not found.segmented:
        fail(f"{name}: none of the scans can be used, such as {'; '.join(found.skipped[0])}")
    return found


def leave_out_rare_labels(found: SegmentedSet, fewest: int) -> None:
    """Skip the scans of labels that too few have for an experiment."""
    counts = Counter(one.label for one in found.segmented)
    is_kept = [counts[one.label] >= fewest for one in found.segmented]
    found.skipped += [
        (
            one.name,
            f"only {counts[one.label]} scans have its label {one.label!r}, at least {fewest} are needed",
        )
        for one, kept in zip(found.segmented, is_kept, strict=True)
        if not kept
    ]
    found.segmented = list(compress(found.segmented, is_kept))
    found.instances = list(compress(found.instances, is_kept))


def read_labelled(
    paths: Sequence[Path], n_views: int | None, reading: ReadOptions
) -> tuple[list[Scan], list[tuple[str, str]]]:
    """Labelled scans in folders, and the files that cannot be used; ends the command where there is none.

    With a number of views, each mesh is scanned from so many sides.
    """
    from shapeconcepts.datasets import load_labelled, load_views
    from shapeconcepts.scan import ScanError

    scans: list[Scan] = []
    skipped: list[tuple[str, str]] = []
    for path in paths:
        try:
            with busy(f"Reading {path}"), warnings.catch_warnings():
                # What is left out is listed at the end.
                warnings.simplefilter("ignore")
                found = (
                    load_labelled(path, **reading)
                    if n_views is None
                    else load_views(path, n_views, **reading)
                )
        except ScanError as error:
            fail(str(error))
        scans += found
        skipped += [(str(path), str(error)) for error in found.skipped]
    return scans, skipped


def renamed(scans: Sequence[Scan], renames: Mapping[str, str]) -> list[Scan]:
    """Scans with their new labels."""
    return [replace(scan, label=renames.get(str(scan.label), scan.label)) for scan in scans]


def data_name(paths: Sequence[Path]) -> str:
    """What tables call the data in folders."""
    return " + ".join(path.resolve().name for path in paths)
