"""`shapeconcepts watch`: learns from scans as they come, and answers each."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from shapeconcepts.cli.concept_summary import concept_title
from shapeconcepts.cli.learning_on import Known, is_new, known_scans, say_update
from shapeconcepts.cli.model_input import object_reader, one_thread, read_model
from shapeconcepts.cli.object_reader import ObjectReader
from shapeconcepts.cli.options import DepthScale, Extract, Intrinsics, Mask, Scenes, Units, Up, read_options
from shapeconcepts.cli.terminal import check_writable, fail, say, tell
from shapeconcepts.cli.user_caches import descriptions_beside, user_cache
from shapeconcepts.printable import encodable

if TYPE_CHECKING:
    from shapeconcepts.descriptors import DescribedObject
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.sources.collection import ScanFile

# What a file was when it was looked at: size and time of the last change.
_Look = tuple[int, int]


def watch(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="FOLDER", exists=True, file_okay=False, help="Where scans are written to, one file each."
        ),
    ],
    model: Annotated[
        Path,
        typer.Option(metavar="MODEL", show_default=False, help="Model to go on from; saved there, too."),
    ],
    unknown_rate: Annotated[
        float,
        typer.Option(metavar="RATE", min=0, max=1, help="Share of scans of something known called novel."),
    ] = 0.05,
    every: Annotated[
        float, typer.Option(metavar="SECONDS", min=0.01, help="Time between two looks into the folder.")
    ] = 0.5,
    save_every: Annotated[
        int,
        typer.Option(metavar="N", min=1, help="Save after so many scans, or a tenth more, and at the end."),
    ] = 50,
    once: Annotated[
        bool, typer.Option("--once", help="End when the scans that are there are answered.")
    ] = False,
    scenes: Scenes = None,
    extract: Extract = False,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
) -> None:
    """Learn from scans as they come, and answer each with a line of JSON.

    A file is read when it has not changed between two looks, so a writer may take its time; best is to move
    it into the folder when it is whole. Each line says the scan, its concept by name and by the key that it
    keeps, the p-value, whether the scan is novel, and the responses; or why a file cannot be used. A scan
    counts once: what the model knows already, by name and content, is passed over, so `watch` goes on where
    it was, however it ended. It ends at Ctrl-C or SIGTERM, and saves the model before; at a second one, at
    once.
    """
    from shapeconcepts.interruption import signals_awaited

    check_writable(model, "--model")
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    learned = read_model(model)
    known, cache = known_scans(learned), user_cache()
    reader = replace(
        object_reader(learned, reading, scenes, extract=extract, n_occlusions=learned.ensemble_.n_occlusions),
        cache=cache,
        descriptions=descriptions_beside(cache),
    )
    n_saved = len(learned.scan_names_)
    say(f"Watching {folder}; {n_saved:,} scans are known")
    with one_thread(), signals_awaited() as told:
        for file in _finished_files(folder, every, once, told):
            for line in _answers(learned, reader, file, unknown_rate, known):
                tell(json.dumps(line, allow_nan=False))
            # Saving takes as long as filtering all scans.
            if len(learned.scan_names_) >= n_saved + max(save_every, n_saved // 10):
                n_saved = _save(learned, model)
        if len(learned.scan_names_) > n_saved:
            _save(learned, model)
        say(f"{len(learned.scan_names_):,} scans are known")
        number = told()
    if number:
        raise typer.Exit(128 + number)


def _finished_files(folder: Path, every: float, once: bool, told: Any) -> Iterator[ScanFile]:
    """Each file when it has not changed between two looks, and again when it has after that; until told."""
    looked: dict[Path, _Look] = {}
    done: dict[Path, _Look] = {}
    while not told():
        present = {file.path: (file, _look(file.path)) for file in _files_in(folder)}
        finished = [
            file
            for path, (file, look) in present.items()
            if look is not None and look != done.get(path) and (once or look == looked.get(path))
        ]
        for file in finished:
            if told():
                return
            look = present[file.path][1]
            assert look is not None
            done[file.path] = look
            yield file
        if once and not finished:
            return
        looked = {path: look for path, (_, look) in present.items() if look is not None}
        until = time.monotonic() + every
        while not once and not told() and time.monotonic() < until:
            time.sleep(min(every, 0.05))


def _files_in(folder: Path) -> list[ScanFile]:
    from shapeconcepts.scan import ScanError
    from shapeconcepts.sources.collection import find_scan_files

    try:
        return [file for file in find_scan_files(folder) if not file.failure]
    except ScanError:
        # There is none yet.
        return []


def _look(path: Path) -> _Look | None:
    try:
        found = os.stat(path)
    except OSError:
        # Moved away since the folder was listed.
        return None
    return found.st_size, found.st_mtime_ns


def _answers(
    model: ShapeConceptModel, reader: ObjectReader, file: ScanFile, unknown_rate: float, known: Known
) -> Iterator[dict[str, Any]]:
    for one in reader(file):
        if one.described is None:
            yield {"scan": encodable(one.name), "error": one.reason}
            continue
        if not is_new(one.described, known):
            continue
        yield _answer(model, one.described, unknown_rate)
        n_updates = len(model.history_)
        model.partial_fit([one.described], unknown_rate=unknown_rate)
        if len(model.history_) > n_updates:
            say_update(model, model.history_[-1])


def _answer(model: ShapeConceptModel, described: DescribedObject, unknown_rate: float) -> dict[str, Any]:
    can_promise = model.novelty_.smallest_rate <= unknown_rate
    recognition = model.recognise([described], unknown_rate if can_promise else None)
    assert recognition.p_values is not None
    concept, p_value = int(recognition.concepts[0]), float(recognition.p_values[0])
    titles, responses = model.get_feature_names_out().tolist(), recognition.responses[0].tolist()
    return {
        "scan": encodable(described.name),
        "number": concept,
        "key": model.concepts_[concept].key if concept >= 0 else -1,
        "concept": concept_title(model, concept),
        "p_value": p_value,
        "novel": p_value <= unknown_rate,
        "responses": {
            title: None if value != value else value for title, value in zip(titles, responses, strict=True)
        },
    }


def _save(model: ShapeConceptModel, path: Path) -> int:
    from shapeconcepts.model_file import ModelError

    n_updates = len(model.history_)
    try:
        model.save(path)
    except OSError as error:
        fail(f"cannot write {path}: {error.strerror or error}")
    except ModelError as error:
        fail(str(error))
    for update in model.history_[n_updates:]:
        say_update(model, update)
    return len(model.scan_names_)
