"""`shapeconcepts evaluate`: the paper's experiments beside the paper's figures and strong baselines."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from shapeconcepts.cli.labelled_input import (
    SegmentedSet,
    data_name,
    leave_out_rare_labels,
    parse_renames,
    read_labelled,
    renamed,
    segment_set,
)
from shapeconcepts.cli.model_input import one_thread
from shapeconcepts.cli.object_reader import ObjectReader, simulated_objects
from shapeconcepts.cli.options import (
    DepthScale,
    Intrinsics,
    Jobs,
    Json,
    Mask,
    Units,
    Up,
    Views,
    check_jobs,
    read_options,
)
from shapeconcepts.cli.terminal import (
    busy,
    check_writable,
    fail,
    progress,
    say,
    say_notices,
    say_skipped,
    tell_json,
    warnings_said,
)
from shapeconcepts.cli.user_caches import user_cache

if TYPE_CHECKING:
    from shapeconcepts.cli.object_reader import Source
    from shapeconcepts.evaluation.results import Evaluation
    from shapeconcepts.sources.reader import ReadOptions

SIMULATED = "simulated"


def evaluate(
    data: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="DATA",
            show_default="66 simulated scans of each of seven categories",
            help="Folders of labelled scans, which become one data set: a sub-folder for each label, scenes "
            "of the Object Segmentation Database, or objects of the Washington RGB-D Object Dataset.",
        ),
    ] = None,
    also: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DATA",
            help="Another folder of labelled scans, for the generalisation: nothing is learned from it, its "
            "scans are laid out on the map of what was learned from DATA. Can be given several times.",
        ),
    ] = None,
    rename: Annotated[
        list[str] | None,
        typer.Option(
            metavar="OLD=NEW",
            help="Call scans that are labelled OLD by the label NEW, such as cocacola=can, so that data sets "
            "agree on what things are called. Can be given several times.",
        ),
    ] = None,
    views: Views = None,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="REPORT.html",
            help="Write a page with all tables and figures, which opens in any browser, without a network.",
        ),
    ] = None,
    figures: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            file_okay=False,
            help="Write each figure as PNG and SVG into this folder, for a publication.",
        ),
    ] = None,
    preset: Annotated[
        Literal["default", "paper"],
        typer.Option(
            help="The parameters that go through all experiments. The other preset stands beside them where "
            "concepts are learned without labels."
        ),
    ] = "default",
    repetitions: Annotated[
        int,
        typer.Option(
            min=1,
            metavar="N",
            help="How often the scans are split anew into 75 % to learn from and 25 % to test.",
        ),
    ] = 5,
    jobs: Jobs = -1,
    no_cache: Annotated[
        bool,
        typer.Option(
            "--no-cache",
            help="Segment every scan, and keep nothing. By default the segments of each scan are kept in the "
            "user's cache folder, so that the next run is quicker.",
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Measure how good concepts are, on scans whose labels are known.

    Runs the experiments of the paper: concepts learned without labels and scored by them, a classifier on the
    concepts' responses, the number of dictionary levels, concepts chosen with labels, and how other data sets
    fit what was learned. Prints our figures beside the paper's and beside the usual ways to group and to
    classify whole-object histograms, on the same scans and splits. Nothing is learned from labels unless a
    table says so.

    Needs libraries that nothing else needs: pip install 'shapeconcepts[evaluation]'.

    About 460 scans take 2 to 4 minutes on two cores. The same data gives the same figures each time. Scans
    that cannot be used are skipped and listed, as are those with labels that fewer than four scans have. The
    exit code is 0 if all was measured and written, 1 if not, and 2 if the command line is wrong.
    """
    check_jobs(jobs)
    if report is not None:
        check_writable(report, "--report")
    if figures is not None:
        check_writable(figures / "figure.png" if figures.is_dir() else figures, "--figures")
    renames = parse_renames(rename or [])
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    _check_libraries()
    with one_thread():
        result, failures = _evaluate(
            data or [],
            also or [],
            renames,
            views,
            reading,
            preset,
            repetitions,
            jobs,
            no_cache,
            report,
            figures,
        )
    if as_json:
        from shapeconcepts.evaluation.json_document import plain_values

        tell_json(plain_values(result))
    else:
        from shapeconcepts.cli.evaluation_tables import print_evaluation

        print_evaluation(result)
    say(f"Measured in {sum(result.seconds.values()):.0f} s")
    for line in failures:
        say(line)
    if any(line.startswith("Error") for line in failures):
        raise typer.Exit(1)


def _check_libraries() -> None:
    from shapeconcepts.evaluation.libraries import LIBRARIES, check_libraries

    try:
        check_libraries(*LIBRARIES)
    except ModuleNotFoundError as error:
        fail(str(error))


def _evaluate(
    data: list[Path],
    also: list[Path],
    renames: dict[str, str],
    views: int | None,
    reading: ReadOptions,
    preset: str,
    repetitions: int,
    jobs: int,
    no_cache: bool,
    report: Path | None,
    figures: Path | None,
) -> tuple[Evaluation, list[str]]:
    from time import perf_counter

    from shapeconcepts.evaluation.evaluate import evaluate
    from shapeconcepts.evaluation.labelled_objects import FEWEST_PER_LABEL
    from shapeconcepts.model import PRESETS, ShapeConceptModel
    from shapeconcepts.segmentation import Segmenter

    start = perf_counter()
    presets = [preset, *(other for other in PRESETS if other != preset)]
    reader = ObjectReader(
        reading={},
        segmenter=Segmenter(),
        # It holds what the descriptors of all presets hold: what it can describe, they can.
        descriptor=ShapeConceptModel().descriptor,
        cache=None if no_cache else user_cache(),
        keep_segmented=True,
    )
    trained, *others = sets = _data_sets(data, also, renames, views, reading, reader, jobs)
    leave_out_rare_labels(trained, FEWEST_PER_LABEL)
    segmenting = perf_counter() - start
    skipped = [scan for one in sets for scan in one.skipped]
    n_segmented = sum(len(one.segmented) for one in sets)
    say_skipped(skipped, len(skipped) + n_segmented)
    say_notices([notice for one in sets for notice in one.notices], n_segmented)
    try:
        with warnings_said():
            result = evaluate(
                trained.segmented,
                name=trained.name,
                instances=trained.instances,
                also={other.name: other.segmented for other in others},
                presets=presets,
                repetitions=repetitions,
                skipped=skipped,
                command=shlex.join(["shapeconcepts", *sys.argv[1:]]),
                n_jobs=jobs,
                progress=progress,
            )
    except ValueError as error:
        fail(str(error))
    result.seconds["segmentation"] = segmenting
    return result, _write(result, report, figures)


def _data_sets(
    data: list[Path],
    also: list[Path],
    renames: dict[str, str],
    views: int | None,
    reading: ReadOptions,
    reader: ObjectReader,
    jobs: int,
) -> list[SegmentedSet]:
    """What is learned from, and the other data sets."""
    sets: list[tuple[str, list[Source], list[tuple[str, str]]]] = []
    labels: set[str] = set()
    if not data:
        sets.append((SIMULATED, [*simulated_objects()], []))
    for paths in [*([data] if data else []), *([path] for path in also)]:
        scans, skipped = read_labelled(paths, views, reading)
        labels |= {str(scan.label) for scan in scans}
        name = data_name(paths)
        if name in {other for other, _, _ in sets}:
            name = " + ".join(map(str, paths))
        sets.append((name, [*renamed(scans, renames)], skipped))
    for old in renames:
        if old not in labels:
            found = ", ".join(sorted(labels)) or "none that was read from a folder"
            raise typer.BadParameter(f"no scan has the label {old!r}; labels: {found}", param_hint="--rename")
    return [segment_set(*one, reader, jobs) for one in sets]


def _write(result: Evaluation, report: Path | None, figures: Path | None) -> list[str]:
    """Write report and figures, each whatever becomes of the other; what there is to say about it."""
    if report is None and figures is None:
        return []
    from shapeconcepts.evaluation.report import draw_all, save_figures, write_evaluation

    said = []
    for path, description in ((report, "Writing the report"), (figures, "Drawing the figures")):
        if path is None:
            continue
        try:
            with busy(description):
                if path is report:
                    write_evaluation(path, result)
                else:
                    save_figures(draw_all(result), path)
            said.append(f"Wrote {path}")
        except OSError as error:
            said.append(f"Error: cannot write {path}: {error.strerror or error}")
    return said
