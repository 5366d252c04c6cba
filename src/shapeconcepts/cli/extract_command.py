"""`shapeconcepts extract`: from scenes and recordings to scans of single objects."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from shapeconcepts.cli.object_reader import useful_jobs
from shapeconcepts.cli.options import (
    DepthScale,
    Intrinsics,
    Jobs,
    Json,
    Strict,
    Units,
    check_jobs,
    read_options,
    scan_files,
)
from shapeconcepts.cli.terminal import fail, progress, say, say_notices, say_skipped, tell_json

if TYPE_CHECKING:
    from shapeconcepts.extraction import ExtractedObject
    from shapeconcepts.scene import Scene
    from shapeconcepts.sources.collection import ScanFile
    from shapeconcepts.sources.reader import ReadOptions

# Not .csv, which could be a scan.
INDEX = "objects.tsv"
_COLUMNS = (
    "file", "scene", "number", "time", "points", "left", "top", "right", "bottom",
    "viewpoint_x", "viewpoint_y", "viewpoint_z", "is_cut", "may_be_several",
)  # fmt: skip
Row = dict[str, object]
# Of a recording, as far as anybody knows before it is read.
_FRAMES = 1000


class _Task(NamedTuple):
    """A scene, or the file that holds it, and where its objects go: a folder and how their names begin."""

    source: Scene | ScanFile
    folder: str
    stem: str


class _Result(NamedTuple):
    """What became of a scene: rows of the index, or why there are none."""

    name: str
    rows: list[Row]
    reason: str = ""
    notices: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Extractor:
    """Finds the objects of a scene and writes them."""

    out: Path
    reading: ReadOptions
    fewest_points: int
    pictures: bool

    def __call__(self, task: _Task) -> _Result:
        from shapeconcepts.extraction import extract_objects
        from shapeconcepts.scan import ScanError, scan_errors
        from shapeconcepts.scene import Scene
        from shapeconcepts.sources.scene_files import read_scene

        name = task.source.name
        try:
            with scan_errors(name, "taken apart"):
                scene = task.source
                if not isinstance(scene, Scene):
                    scene = read_scene(scene.path, **self.reading)
                objects = extract_objects(scene, fewest_points=self.fewest_points)
            rows = [self._written(task, scene, number, one) for number, one in enumerate(objects)]
            if self.pictures:
                self._draw(task, scene, objects)
        except ScanError as error:
            return _Result(name, [], str(error))
        return _Result(name, rows, notices=scene.notices)

    def _written(self, task: _Task, scene: Scene, number: int, found: ExtractedObject) -> Row:
        from shapeconcepts.io.write_pcd import write_pcd

        file = Path(task.folder) / f"{task.stem}_{number}.pcd"
        (self.out / task.folder).mkdir(parents=True, exist_ok=True)
        # Labels of the scene's points tell its objects apart, of which this is one.
        write_pcd(self.out / file, replace(found.scan, point_labels=None))
        viewpoint = ("", "", "") if found.scan.viewpoint is None else map(float, found.scan.viewpoint)
        values = (
            file.as_posix(), task.source.name, number, "" if found.time is None else found.time,
            len(found.scan), *found.box, *viewpoint, int(found.is_cut), int(found.may_be_several),
        )  # fmt: skip
        return dict(zip(_COLUMNS, values, strict=True))

    def _draw(self, task: _Task, scene: Scene, objects: list[ExtractedObject]) -> None:
        from io import BytesIO

        from shapeconcepts.io.atomic_write import write_atomically
        from shapeconcepts.report.scene_picture import draw_scene

        content = BytesIO()
        # Where objects are scans, pictures must not be: a PNG image could be one of depths.
        draw_scene(scene, objects).save(content, "JPEG", quality=90)
        folder = self.out / task.folder
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(folder / f"{task.stem}.jpg", content.getvalue())


def extract(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="SOURCE... OUT",
            show_default=False,
            help="Scenes: point clouds and depth images, or folders of them; or recordings: rosbags, .mcap "
            "and .db3 (extra `recordings`). Last, the folder to write to, which is made if need be.",
        ),
    ],
    topic: Annotated[
        str | None,
        typer.Option(
            metavar="TOPIC",
            show_default="the only one with clouds or depth images",
            help="Of a recording: what to take. Where there is a choice, it is listed.",
        ),
    ] = None,
    every: Annotated[int, typer.Option(min=1, metavar="N", help="Of a recording: take one frame in N.")] = 1,
    start: Annotated[
        float | None,
        typer.Option(
            "--from", metavar="SECONDS", help="Of a recording: since its beginning.", show_default=False
        ),
    ] = None,
    end: Annotated[
        float | None,
        typer.Option(
            "--to", metavar="SECONDS", help="Of a recording: since its beginning.", show_default=False
        ),
    ] = None,
    fewest_points: Annotated[
        int, typer.Option(min=1, metavar="N", help="Leave out objects of which fewer points are seen.")
    ] = 250,
    pictures: Annotated[
        bool, typer.Option(help="Draw each scene, with its objects outlined and numbered (.jpg).")
    ] = True,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    units: Units = "auto",
    jobs: Jobs = -1,
    force: Annotated[bool, typer.Option("--force", help="Write into a folder that holds something.")] = False,
    strict: Strict = False,
    as_json: Json = False,
) -> None:
    """Take scenes apart: a scan for each object that stands on a table, a board or the floor.

    Into OUT come the objects as PCD files, named by their scene and their number from left to right; a
    picture of each scene, with the objects outlined; and objects.tsv: scene, time, pixels, position of the
    sensor, whether the border of the image cuts it, and whether it may be several objects that touch. A
    sub-folder's name stays the label of its scenes' objects. OUT is what `learn` and `respond` take.

    Scenes that cannot be read are skipped and listed at the end, as are those in which nothing was found. The
    exit code is 0 if an object was found, 1 if not, and 2 if the command line is wrong.
    """
    from shapeconcepts.parallel import map_in_order

    check_jobs(jobs)
    if len(paths) < 2:
        raise typer.BadParameter(
            "needs a scene or a recording, and a folder to write to", param_hint="SOURCE... OUT"
        )
    *sources, out = paths
    if out.exists() and not out.is_dir():
        raise typer.BadParameter(f"{out} must be a folder", param_hint="OUT")
    if out.is_dir() and not force and any(out.iterdir()):
        raise typer.BadParameter(f"{out} is not empty: --force writes into it", param_hint="OUT")
    reading = read_options(intrinsics, depth_scale, None, units, None)
    problems: list[tuple[str, str]] = []
    tasks, n_files, n_scenes_about = _tasks(sources, topic, every, start, end, problems)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        fail(f"cannot make {out}: {error.strerror or error}")
    work = _Extractor(out, reading, fewest_points, pictures)
    rows: list[Row] = []
    empty: list[str] = []
    notices: list[tuple[str, str]] = []
    n_scenes = n_used = 0
    try:
        with (out / INDEX).open("w", newline="", encoding="utf-8", errors="surrogateescape") as file:
            table = csv.DictWriter(file, _COLUMNS, delimiter="\t")
            table.writeheader()
            results = map_in_order(work, tasks, useful_jobs(jobs, n_scenes_about))
            for result in progress(results, n_files, "Taking apart"):
                n_scenes += 1
                if result.reason:
                    problems.append((result.name, result.reason))
                    if strict:
                        break
                    continue
                n_used += bool(result.rows)
                notices.extend((result.name, notice) for notice in result.notices)
                if not result.rows:
                    empty.append(result.name)
                table.writerows(result.rows)
                file.flush()
                rows += result.rows
    except OSError as error:
        fail(f"cannot write into {out}: {error.strerror or error}")
    if strict and problems:
        fail(problems[0][1])
    if as_json:
        skipped = [{"name": name, "reason": reason} for name, reason in problems]
        tell_json({"out": str(out), "scenes": n_scenes, "objects": rows, "empty": empty, "skipped": skipped})
    say(f"Found {len(rows):,} objects in {n_used:,} of {n_scenes:,} scenes")
    if empty:
        more = f" and {len(empty) - 3:,} more" if len(empty) > 3 else ""
        say(f"Nothing stands on anything that can be seen in {', '.join(empty[:3])}{more}")
    say_skipped(problems, n_used + len(empty) + len(problems))
    say_notices(notices, n_scenes)
    if not rows:
        fail("no object was found")
    say(f"Wrote {out}")


def _tasks(
    sources: list[Path],
    topic: str | None,
    every: int,
    start: float | None,
    end: float | None,
    problems: list[tuple[str, str]],
) -> tuple[Iterator[_Task], int, int]:
    """Scenes of files and recordings, how many of these there are, and about how many scenes."""
    from shapeconcepts.recordings import is_recording

    recordings = [path for path in sources if is_recording(path)]
    others = [path for path in sources if path not in recordings]
    files = scan_files(others, None) if others else []
    if not recordings:
        given = {"--topic": topic, "--every": every if every > 1 else None, "--from": start, "--to": end}
        for option, value in given.items():
            if value is not None:
                raise typer.BadParameter("is for recordings, and there is none", param_hint=option)
    tasks = _scenes(recordings, files, topic, every, start, end, problems)
    n_files = len(files) + len(recordings)
    return tasks, n_files, n_files + _FRAMES * len(recordings)


def _scenes(
    recordings: list[Path],
    files: list[ScanFile],
    topic: str | None,
    every: int,
    start: float | None,
    end: float | None,
    problems: list[tuple[str, str]],
) -> Iterator[_Task]:
    from shapeconcepts.recordings import read_scenes
    from shapeconcepts.scan import ScanError

    used: set[str] = set()
    for file in files:
        folder = file.label or ""
        yield _Task(file, folder, _unused(folder, file.path.stem, used))
    for path in recordings:
        try:
            for scene in read_scenes(path, topic, every, start, end):
                if isinstance(scene, ScanError):
                    problems.append((str(path), str(scene)))
                else:
                    yield _Task(scene, "", _unused("", scene.name.replace("/", "_"), used))
        except ScanError as error:
            problems.append((str(path), str(error)))


def _unused(folder: str, stem: str, used: set[str]) -> str:
    """A stem that no other scene in a folder has, on file systems that know no case either."""
    number, name = 2, stem
    while f"{folder}/{name}".lower() in used:
        name, number = f"{stem}-{number}", number + 1
    used.add(f"{folder}/{name}".lower())
    return name
