"""`shapeconcepts explain`: why a scan resembles what it resembles."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from shapeconcepts.cli.concept_summary import concept_title
from shapeconcepts.cli.model_input import object_reader, read_model
from shapeconcepts.cli.object_reader import ObjectReader, ReadObject
from shapeconcepts.cli.options import (
    DepthScale,
    Intrinsics,
    Json,
    Mask,
    ModelFile,
    Scenes,
    Units,
    Up,
    read_options,
    scan_files,
)
from shapeconcepts.cli.pictures import check_picture_path, save_picture
from shapeconcepts.cli.terminal import fail, print_table, say_notices, tell, tell_json

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.motifs.explanation import Explanation, SimilarPrototype
    from shapeconcepts.segmentation.segmented_object import SegmentedObject
    from shapeconcepts.sources.collection import ScanFile

_MOTIFS_SHOWN = 12
_PROTOTYPES_SHOWN = 3


def explain(
    model: ModelFile,
    scan: Annotated[
        Path,
        typer.Argument(metavar="SCAN", show_default=False, help="A point cloud, depth image, mesh or scene."),
    ],
    number: Annotated[
        int | None,
        typer.Option(
            "--object",
            metavar="N",
            min=2,
            show_default=False,
            help="Which object of a labelled scene: 2 has the labels 20 to 29, 3 has 30 to 39, and so on.",
        ),
    ] = None,
    image: Annotated[
        Path | None,
        typer.Option(metavar="OUT.png", help="Draw the strongest of them and what they remind of."),
    ] = None,
    training_data: Annotated[
        list[Path] | None,
        typer.Option(
            "--training-data",
            metavar="DATA",
            show_default=False,
            help="What the model was learned from, as given to `learn`: with it the picture shows the "
            "training scans, without it their names. May be given several times.",
        ),
    ] = None,
    scenes: Scenes = None,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
    as_json: Json = False,
) -> None:
    """Say why a scan resembles what it resembles.

    Says which of its segments are foreign to the concept, such as a strip of the table, and shows the
    combinations of surfaces that the scan has in common with training scans: how strongly each
    fires (its stimulus, 0 to 1), the motif that it shares with them, which segments of the scan it consists
    of, and the training scans that these resemble most, with the divergence (0 same, 1 nothing in common).
    """
    if image is not None:
        check_picture_path(image, "--image")
    if training_data and image is None:
        raise typer.BadParameter("is for the picture: add --image", param_hint="--training-data")
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    if os.path.isdir(scan):
        raise typer.BadParameter(f"{scan} is a folder, expected one scan", param_hint="SCAN")
    [file] = scan_files([scan], mask)
    training = scan_files(training_data, None) if training_data else []
    learned = read_model(model)
    reader = object_reader(learned, reading, scenes, keep_segmented=True)
    found = _choose(reader(file), scan, number)
    assert found.described is not None and found.segmented is not None
    say_notices([(found.name, notice) for notice in found.notices], 1)
    with _failure_said(found.name, "explained"):
        explanation = learned.explain(found.described)
        recognition = learned.recognise([found.described])
        concept, responses = int(recognition.concepts[0]), recognition.responses[0].tolist()
    if as_json:
        document = _document(learned, found.name, explanation, concept, responses)
        tell_json(document)
    else:
        _print(learned, found, explanation, concept, responses)
    if image is not None:
        from shapeconcepts.report import draw_explanation

        seen = _TrainingObjects(learned, training, reader) if training else None
        with _failure_said(found.name, "drawn"):
            picture = draw_explanation(explanation, found.segmented, seen)
        if not save_picture(lambda: picture, image):
            raise typer.Exit(1)


@contextmanager
def _failure_said(name: str, step: str) -> Iterator[None]:
    from shapeconcepts.scan import ScanError, scan_errors

    try:
        with scan_errors(name, step):
            yield
    except ScanError as error:
        fail(str(error))


def _choose(objects: list[ReadObject], scan: Path, number: int | None) -> ReadObject:
    """The only object of a file, or the one with a number."""
    wanted = objects if number is None else [one for one in objects if one.name == f"{scan.stem}/{number}"]
    if len(wanted) == 1:
        if wanted[0].reason:
            fail(wanted[0].reason)
        return wanted[0]
    numbers = ", ".join(one.name.rpartition("/")[2] for one in objects)
    if len(objects) == 1:
        fail(objects[0].reason or f"{scan}: is a scan of one object, --object is for scenes")
    fail(f"{scan}: is a scene, choose one of its objects with --object: {numbers}")


class _TrainingObjects(Sequence["SegmentedObject"]):
    """The objects that a model was learned from, each read when it is drawn."""

    def __init__(self, model: ShapeConceptModel, files: list[ScanFile], reader: ObjectReader) -> None:
        self._names = model.ensemble_.hierarchies_.object_names
        self._reader = reader
        self._file_of = {**{file.path.stem: file for file in files}, **{file.name: file for file in files}}
        for name in self._names:
            if self._file(name) is None:
                fail(f"--training-data: {name}, which the model was learned from, is not there")

    def __len__(self) -> int:
        return len(self._names)

    def __getitem__(self, index: Any) -> Any:
        from shapeconcepts.scan import ScanError
        from shapeconcepts.sources.mesh_views import mesh_and_count

        name = self._names[index]
        file = self._file(name)
        assert file is not None
        view = mesh_and_count(name)
        reader = replace(self._reader, n_views=view[1]) if view else self._reader
        for one in reader(file):
            if one.name == name and one.segmented is not None:
                return one.segmented
        raise ScanError(
            f"--training-data: {file.path}: does not hold {name}, which the model was learned from"
        )

    def _file(self, name: str) -> ScanFile | None:
        # An object of a scene is called after the scene, and a view after its mesh, with a number.
        return self._file_of.get(name) or self._file_of.get(name.rpartition("/")[0])


def _print(
    model: ShapeConceptModel,
    found: ReadObject,
    explanation: Explanation,
    concept: int,
    responses: list[float],
) -> None:
    tell(f"{found.name}: {_verdict(model, concept, responses)}")
    if explanation.foreign:
        segments = " ".join(map(str, explanation.foreign))
        tell(f"Segments that hardly remind of this concept, and may belong to something else: {segments}")
    rows = list(_motif_rows(explanation))
    if not rows:
        tell("Nothing fired: none of its combinations of surfaces is like those seen in training.")
        return
    count = len(explanation.motifs)
    shown = f", the strongest {len(rows)}" if len(rows) < count else ""
    if explanation.columns == "motifs":
        tell(f"{count} motif{'s' if count > 1 else ''} fired{shown}:")
    elif explanation.n_constellations == 1:
        tell("Its only surface reminds of training scans:")
    else:
        tell(
            f"{count} of its {explanation.n_constellations} combinations of surfaces "
            f"remind{'s' if count == 1 else ''} of training scans{shown}:"
        )
    print_table(("stimulus", "motif", "segments", "reminds of (divergence)"), rows, "reminds of (divergence)")


def _verdict(model: ShapeConceptModel, concept: int, responses: list[float]) -> str:
    nearest = sorted((value, number) for number, value in enumerate(responses) if value == value)[:3]
    listed = ", ".join(f"{concept_title(model, number)} {value:.3g}" for value, number in nearest)
    kind = "unknown, no training scan is near" if concept < 0 else f"concept {concept_title(model, concept)}"
    return kind + (f"; smallest responses: {listed}" if listed else "")


def _motif_rows(explanation: Explanation) -> Iterator[tuple[str, ...]]:
    for motif in explanation.motifs[:_MOTIFS_SHOWN]:
        closest = [_reminded_of(prototype) for prototype in motif.closest[:_PROTOTYPES_SHOWN]]
        yield (
            f"{motif.stimulus:.3f}",
            motif.name if motif.words else "none",
            " ".join(map(str, motif.segments)),
            ", ".join(closest),
        )


def _reminded_of(prototype: SimilarPrototype) -> str:
    like_it = f", {prototype.count - 1:,} like it" if prototype.count > 1 else ""
    return f"{prototype.object_name or prototype.object_index} ({prototype.divergence:.3f}{like_it})"


def _document(
    model: ShapeConceptModel, name: str, explanation: Explanation, concept: int, responses: list[float]
) -> dict[str, Any]:
    return {
        "scan": name,
        "number": concept,
        "concept": concept_title(model, concept),
        "responses": [None if value != value else value for value in responses],
        "n_constellations": explanation.n_constellations,
        "n_unknown": list(explanation.n_unknown),
        "foreign": list(explanation.foreign),
        "motifs": [
            {
                "name": motif.name,
                "dictionary_level": motif.dictionary_level,
                "motif_level": motif.motif_level,
                "words": list(motif.words),
                "stimulus": motif.stimulus,
                "segments": list(motif.segments),
                "n_prototypes": motif.n_prototypes,
                "closest": [
                    {
                        "scan": prototype.object_name,
                        "segments": list(prototype.segments),
                        "divergence": prototype.divergence,
                        "count": prototype.count,
                        "others": list(prototype.others),
                    }
                    for prototype in motif.closest
                ],
            }
            for motif in explanation.motifs
        ],
    }
