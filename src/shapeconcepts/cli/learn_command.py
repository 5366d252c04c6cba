"""`shapeconcepts learn`: from scans to concepts, a model and a report."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import typer

from shapeconcepts.cli.cluster_option import Cluster, on_cluster
from shapeconcepts.cli.concept_summary import in_words, model_summary, other_cuts_in_words, print_concepts
from shapeconcepts.cli.learning_on import (
    corrected_before,
    is_new,
    keep_corrections,
    known_as,
    known_scans,
    say_edits,
    say_update,
)
from shapeconcepts.cli.model_input import one_thread, read_model
from shapeconcepts.cli.object_reader import (
    ObjectReader,
    SimulatedObject,
    read_objects,
    simulated_objects,
)
from shapeconcepts.cli.options import (
    DepthScale,
    Extract,
    Granularity,
    Intrinsics,
    Jobs,
    Json,
    Mask,
    Scenes,
    Strict,
    Units,
    Up,
    Views,
    VoxelSize,
    check_jobs,
    read_options,
    scan_files,
    set_from_options,
)
from shapeconcepts.cli.terminal import (
    busy,
    check_writable,
    fail,
    is_same_file,
    progress,
    say,
    say_notices,
    say_skipped,
    tell_json,
    warnings_said,
)
from shapeconcepts.cli.user_caches import descriptions_beside, user_cache

if TYPE_CHECKING:
    from shapeconcepts.descriptors import DescribedObject
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.report.html import ScanPreview
    from shapeconcepts.sources.collection import ScanFile


THE_PRESETS = "as in the preset"


class _Collection(NamedTuple):
    """What the scans gave."""

    described: list[DescribedObject]
    previews: list[ScanPreview | None]
    skipped: list[tuple[str, str]]
    undrawn: list[tuple[str, str]]
    notices: list[tuple[str, str]]


def learn(
    data: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="DATA",
            show_default="66 simulated scans of each of seven categories",
            help="Files and folders of point clouds, depth images or meshes, one object each, or of labelled "
            "scenes. A sub-folder's name is the label of its scans; nothing is learned from labels.",
        ),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL",
            show_default="that of --update",
            help="File to write the model to (.safetensors).",
        ),
    ] = None,
    update: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL",
            help="Model that learns on from DATA, which are new scans: its concepts keep their identities "
            "and names, whatever becomes of them. Scans that it knows may be among them: they count once, "
            "and the report shows them.",
        ),
    ] = None,
    identities_of: Annotated[
        Path | None,
        typer.Option(
            metavar="MODEL",
            show_default=False,
            help="Earlier model of some of the scans: concepts of the new one keep its identities and names.",
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="REPORT.html",
            help="Write a page to look at, which opens in any browser, without a network.",
        ),
    ] = None,
    preset: Annotated[
        Literal["default", "paper"],
        typer.Option(help="Where the parameters start from: the best known ones, or the paper's."),
    ] = "default",
    min_size: Annotated[
        int | None,
        typer.Option(metavar="N", show_default=THE_PRESETS, help="Smallest number of scans in a concept."),
    ] = None,
    descriptor: Annotated[
        Literal[
            "surflet+fpfh+curvature",
            "surflet+fpfh+curvature+distance",
            "surflet+fpfh",
            "surflet",
            "fpfh",
            "curvature",
            "distance",
        ]
        | None,
        typer.Option(
            show_default=THE_PRESETS,
            help="What describes a segment: pairs of points, FPFH, curvatures, distances, or several.",
        ),
    ] = None,
    scale: Annotated[
        Literal["relative", "metric"],
        typer.Option(
            help="Whether objects of the same shape are alike at any size, or size in metres counts, too, "
            "as between a small nut and a large one: the descriptor surflet+fpfh+curvature+distance.",
        ),
    ] = "relative",
    levels: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            show_default=THE_PRESETS,
            help="Levels of the dictionary; n has 2^n words.",
        ),
    ] = None,
    granularity: Granularity = None,
    voxel_size: VoxelSize = None,
    views: Views = None,
    scenes: Scenes = None,
    extract: Extract = False,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
    jobs: Jobs = -1,
    cluster: Cluster = None,
    no_cache: Annotated[
        bool,
        typer.Option(
            "--no-cache",
            help="Segment every scan, and keep nothing. By default the segments of each scan are kept in the "
            "user's cache folder, so that learning again with other parameters is quick.",
        ),
    ] = False,
    strict: Strict = False,
    as_json: Json = False,
) -> None:
    """Learn shape concepts from scans, without labels.

    Scans whose composition of surfaces is alike end in one concept. The concepts are printed as a table; the
    model can then say of new scans which concept they resemble (`respond`), and why (`explain`).

    Scans that cannot be used are skipped and listed at the end, as are those that the report cannot show. The
    exit code is 0 if a model was written (and the report, if wanted), 1 if not, and 2 if the command line is
    wrong. Ctrl-C ends it with 130 and leaves files as they were.
    """
    from shapeconcepts.segmentation import Segmenter

    check_jobs(jobs)
    model = model or update
    if model is None:
        raise typer.BadParameter("say where to write the model", param_hint="--model")
    check_writable(model, "--model")
    if report is not None:
        check_writable(report, "--report")
        if is_same_file(report, model):
            raise typer.BadParameter("must be another file than --model", param_hint="--report")
    if granularity is not None and preset == "paper":
        raise typer.BadParameter(
            "is not for the preset paper, which takes concepts at a time", param_hint="--granularity"
        )
    if scale == "metric":
        if descriptor is not None or preset == "paper":
            raise typer.BadParameter(
                "'metric' is a descriptor of its own: not with --descriptor or the preset paper",
                param_hint="--scale",
            )
        descriptor = "surflet+fpfh+curvature+distance"
    if cluster is not None and mask is not None:
        mask = mask.absolute()
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    sources: list[ScanFile | SimulatedObject] = [*scan_files(data, mask)] if data else simulated_objects()
    if cluster is not None:
        # Workers were started elsewhere.
        sources = [
            one._replace(path=one.path.absolute()) if isinstance(one, tuple) else one for one in sources
        ]
    parameters: dict[str, tuple[str, object]] = {
        "--min-size": ("filtration__min_concept_size", min_size),
        "--descriptor": ("descriptor", descriptor),
        "--levels": ("ensemble__dictionary__n_levels", levels),
        "--granularity": ("filtration__granularity", granularity),
        "--voxel-size": ("segmenter__voxel_size", voxel_size),
    }
    if update is not None:
        given = [option for option, (_, value) in parameters.items() if value is not None]
        given += ["--preset"] * (preset != "default")
        if given:
            raise typer.BadParameter("is for a new model: that of --update has its own", param_hint=given[0])
        if not data:
            raise typer.BadParameter("needs new scans", param_hint="--update")
        if identities_of is not None:
            raise typer.BadParameter(
                "is for a new model: that of --update keeps its own", param_hint="--identities-of"
            )
    earlier = None if identities_of is None else read_model(identities_of)
    corrected = corrected_before(model) if update is None and earlier is None else None
    learner = _learner(preset) if update is None else read_model(update)
    set_from_options(learner, parameters)
    cache = None if no_cache else user_cache()
    reader = ObjectReader(
        reading=reading,
        segmenter=learner.segmenter or Segmenter(),
        descriptor=learner.descriptor,
        scenes=scenes,
        extract=extract,
        cache=cache,
        descriptions=descriptions_beside(cache),
        make_preview=report is not None,
        n_occlusions=learner.get_params()["ensemble__n_occlusions"],
        n_views=views,
    )
    learner.set_params(n_jobs=jobs)
    with one_thread(), on_cluster(cluster, jobs):
        collection = _collect(sources, reader, jobs, strict)
        n_described = len(collection.described)
        with busy("Learning concepts"), warnings_said():
            if update is None:
                learner.fit(_given_away(collection.described))
                if earlier is not None:
                    _take_identities(learner, earlier)
                elif corrected is not None:
                    keep_corrections(learner, corrected)
            else:
                collection = _learn_on(learner, collection)
        told = _told_by_the_report(
            {
                "--intrinsics": (intrinsics, None),
                "--depth-scale": (depth_scale, None),
                "--mask": (mask, None),
                "--views": (views, None),
                "--scenes": (None if scenes is None else "yes" if scenes else "no", None),
                "--extract": ("yes" if extract else None, None),
                "--voxel-size": (voxel_size, None),
                "--units": (units, "auto"),
                "--up": (up, None),
            }
        )
        _write(learner, collection, model, report, told)
    if as_json:
        skipped = [{"name": name, "reason": reason} for name, reason in collection.skipped]
        paths = {"model": str(model), "report": None if report is None else str(report)}
        tell_json({**paths, **model_summary(learner), "skipped": skipped})
    else:
        print_concepts(learner)
    if learner.history_:
        say_update(learner, learner.history_[-1])
    say_edits(learner)
    say(f"Learned {in_words(learner)}")
    if others := other_cuts_in_words(learner):
        say(others)
    say_skipped(collection.skipped, n_described + len(collection.skipped))
    say_notices(collection.notices, n_described)
    say_skipped(collection.undrawn, n_described, "Could not draw")
    for path in filter(None, (model, report)):
        say(f"Wrote {path}")


def _learner(preset: str) -> ShapeConceptModel:
    from shapeconcepts.model import ShapeConceptModel

    return ShapeConceptModel.preset(preset)


def _take_identities(learner: ShapeConceptModel, earlier: ShapeConceptModel) -> None:
    try:
        learner.take_identities(earlier)
    except ValueError:
        fail("none of the scans is in the model of --identities-of")


def _given_away(described: list[DescribedObject]) -> Iterator[DescribedObject]:
    """Each of a list, which is empty then: once they are learned, nobody needs descriptions."""
    described.reverse()
    while described:
        yield described.pop()


def _learn_on(learner: ShapeConceptModel, collection: _Collection) -> _Collection:
    """Learn from the scans that the model does not know yet; what there is to show of all."""
    known = known_scans(learner)
    are_new = [is_new(one, known) for one in collection.described]
    old = [one.name for one, new in zip(collection.described, are_new, strict=True) if not new]
    if old:
        say(f"{len(old):,} of {len(are_new):,} scans are in the model already, such as {old[0]}")
    if not any(are_new):
        fail("none of the scans is new to the model")
    previews: list[ScanPreview | None] = [None] * len(learner.scan_names_)
    for one, preview in zip(collection.described, collection.previews, strict=True):
        if (row := known[known_as(one)]) >= 0:
            previews[row] = preview
    learner.partial_fit(itertools.compress(collection.described, are_new)).consolidate()
    return collection._replace(previews=[*previews, *itertools.compress(collection.previews, are_new)])


def _collect(
    sources: list[ScanFile | SimulatedObject], reader: ObjectReader, jobs: int, strict: bool
) -> _Collection:
    collection = _Collection([], [], [], [], [])
    cache_failure = ""
    reading = read_objects(sources, reader, jobs, strict=strict)
    for objects in progress(reading, len(sources), "Segmenting"):
        for one in objects:
            cache_failure = cache_failure or one.cache_failure
            if one.described is None:
                collection.skipped.append((one.name, one.reason))
            else:
                collection.notices.extend((one.name, notice) for notice in one.notices)
                collection.described.append(one.described)
                collection.previews.append(one.preview)
                if one.drawing_failure:
                    collection.undrawn.append((one.name, one.drawing_failure))
    if cache_failure:
        say(
            f"Note: segments are not kept for the next time, as the cache cannot be written ({cache_failure})"
        )
    if strict and collection.skipped:
        fail(collection.skipped[0][1])
    if not collection.described:
        say_skipped(collection.skipped, len(collection.skipped))
        fail("none of the scans can be used")
    return collection


def _told_by_the_report(reading_options: dict[str, tuple[object, object]]) -> dict[str, str]:
    """Text of each option whose value, the first of the pair, is not its default, the second."""
    return {option: str(value) for option, (value, default) in reading_options.items() if value != default}


def _write(
    learner: ShapeConceptModel,
    collection: _Collection,
    model: Path,
    report: Path | None,
    reading_told: dict[str, str],
) -> None:
    """Write model and report: both or, where one of them cannot be written, none."""
    from shapeconcepts.io.atomic_write import written_together
    from shapeconcepts.model_file import ModelError
    from shapeconcepts.report.html import write_report

    paths = [model] if report is None else [model, report]
    try:
        with warnings_said(), written_together():
            learner.save(model)
            if report is not None:
                with busy("Writing the report"):
                    write_report(
                        report,
                        learner,
                        collection.previews,
                        unread=collection.skipped,
                        reading=reading_told,
                    )
    except ModelError as error:
        fail(str(error))
    except OSError as error:
        fail(f"cannot write {' and '.join(map(str, paths))}: {error.strerror or error}")
