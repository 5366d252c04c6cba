"""Finds the scans that a model was learned from again, by their names, and reads them one at a time."""

from __future__ import annotations

from collections import OrderedDict, defaultdict, deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from threading import Lock
from typing import NamedTuple, Protocol

from shapeconcepts.scan import Scan, ScanError, scan_errors
from shapeconcepts.sources.collection import ScanFile, iter_scans
from shapeconcepts.sources.file_objects import objects_of_file
from shapeconcepts.sources.mesh_views import mesh_and_count, views_of_file
from shapeconcepts.sources.reader import ReadOptions

# Files whose parts are remembered: whoever reads one object of a scene, or view of a mesh, soon reads others.
_FILES_REMEMBERED = 4


class FoundScan(NamedTuple):
    """A scan that was found: its row in the model, and the file that holds it alone, if there is one."""

    row: int
    scan: Scan
    file: Path | None


class UnusableScan(NamedTuple):
    """A scan that was found, but cannot be read: its row in the model, and why."""

    row: int
    reason: str


class TrainingScans(Protocol):
    """Where the scans of a model are."""

    missing: list[int]
    """Rows of the model for which there is none, rising."""

    def read(self) -> Iterator[FoundScan | UnusableScan]:
        """Each that is not missing, once, in the order in which they are found."""
        ...

    def path_of(self, index: int) -> Path | None:
        """The file that holds a scan; None where that is unknown, without reading it."""
        ...

    @property
    def paths(self) -> Iterable[Path]:
        """Files that are read."""
        ...


class _Wanted(NamedTuple):
    """What a file is read for: the scan that it is as a whole, its objects as a scene, views as a mesh."""

    file: ScanFile
    whole: str | None
    scene: bool
    mesh: str | None
    view_counts: tuple[int, ...]


class _Holders(NamedTuple):
    """Files that may hold a scan, and how many of the same name in them come before it."""

    files: list[_Wanted]
    turn: int


class ScansInFiles:
    """Those that lie in files.

    A scan is named as `find_scan_files` names its file; or, where no file has that name, by the end of its
    path. An object of a scene is named after the scene's file, with a number, and a view after its mesh.
    Where scans of a model have the same name, they are taken in the order of the files.

    Parameters
    ----------
    names : sequence of str
        Of the scans of a model.
    wanted : iterable of int
        Rows of those that are looked for.
    files : sequence of ScanFile
        Where they may be.
    reading : ReadOptions
    """

    def __init__(
        self, names: Sequence[str], wanted: Iterable[int], files: Sequence[ScanFile], reading: ReadOptions
    ) -> None:
        self._names, self._rows, self._reading = names, sorted(wanted), reading
        self._wanted = _what_is_wanted({names[row] for row in self._rows}, files)
        places: dict[str, list[_Wanted]] = defaultdict(list)
        scenes: dict[str, list[_Wanted]] = defaultdict(list)
        for one in self._wanted:
            for name in filter(None, (one.whole, one.mesh if one.view_counts else None)):
                places[name].append(one)
            if one.scene:
                scenes[one.file.path.stem].append(one)
        self.missing: list[int] = []
        self._holders: dict[int, _Holders] = {}
        self._remembered: OrderedDict[Path, tuple[list[Scan], dict[str, str]]] = OrderedDict()
        self._lock = Lock()
        seen: dict[str, int] = defaultdict(int)
        for row in self._rows:
            name = names[row]
            view = mesh_and_count(name)
            whole = places.get(name) or (places.get(view[0]) if view else None)
            in_scene = scenes.get(name.rpartition("/")[0], [])
            if whole and seen[name] < len(whole):
                self._holders[row] = _Holders([whole[seen[name]]], 0)
            elif in_scene and not whole:
                # Which one of several holds it is only known when they are read.
                self._holders[row] = _Holders(in_scene, seen[name])
            else:
                self.missing.append(row)
            seen[name] += 1

    @property
    def paths(self) -> Iterable[Path]:
        return [one.file.path for one in self._wanted]

    def path_of(self, index: int) -> Path | None:
        holders = self._holders.get(index)
        return holders.files[0].file.path if holders and len(holders.files) == 1 else None

    def read_one(self, row: int) -> FoundScan | UnusableScan:
        """One scan alone, as `read` gives it; may be called by several threads.

        Raises
        ------
        KeyError
            If it is missing.
        """
        name, (files, turn) = self._names[row], self._holders[row]
        if files[0].whole == name:
            return self._whole(files[0].file, row)
        reasons: dict[str, str] = {}
        same = [scan for one in files for scan in self._parts_remembered(one, reasons) if scan.name == name]
        return FoundScan(row, same[turn], None) if turn < len(same) else self._lacking(row, reasons)

    def read(self) -> Iterator[FoundScan | UnusableScan]:
        pending: dict[str, deque[int]] = defaultdict(deque)
        for row in self._holders:
            pending[self._names[row]].append(row)
        reasons: dict[str, str] = {}
        for one in self._wanted:
            if one.whole is not None and pending[one.whole]:
                row = pending[one.whole].popleft()
                yield self._whole(one.file, row)
            for scan in self._parts(one, reasons):
                if pending[scan.name]:
                    yield FoundScan(pending[scan.name].popleft(), scan, None)
        for row in self._holders:
            if row in pending[self._names[row]]:
                yield self._lacking(row, reasons)

    def _lacking(self, row: int, reasons: dict[str, str]) -> UnusableScan:
        """A part that its file does not hold, or cannot be read from it."""
        name = self._names[row]
        holder = name.rpartition("/")[0]
        lacking = f"{holder}: does not hold {name}, which the model was learned from"
        return UnusableScan(row, reasons.get(holder, lacking))

    def _whole(self, file: ScanFile, row: int) -> FoundScan | UnusableScan:
        try:
            with scan_errors(file.name, "read"):
                [scan] = iter_scans([file], **self._reading)
        except ScanError as error:
            return UnusableScan(row, str(error))
        if isinstance(scan, ScanError):
            return UnusableScan(row, str(scan))
        return FoundScan(row, replace(scan, name=self._names[row]), file.path)

    def _parts_remembered(self, one: _Wanted, reasons: dict[str, str]) -> list[Scan]:
        path = one.file.path
        # Threads that want parts of one file wait for the first of them.
        with self._lock:
            if path not in self._remembered:
                found: dict[str, str] = {}
                self._remembered[path] = list(self._parts(one, found)), found
            self._remembered.move_to_end(path)
            parts, found = self._remembered[path]
            if len(self._remembered) > _FILES_REMEMBERED:
                self._remembered.popitem(last=False)
        reasons |= found
        return parts

    def _parts(self, one: _Wanted, reasons: dict[str, str]) -> Iterator[Scan]:
        """Objects of a scene, and views of a mesh, as they are called in the model."""
        for count in one.view_counts:
            named = one.file._replace(name=str(one.mesh))
            try:
                with scan_errors(named.name, "read"):
                    yield from views_of_file(named, count, **self._reading)
            except ScanError as error:
                reasons[named.name] = str(error)
        if one.scene:
            try:
                with scan_errors(one.file.name, "read"):
                    yield from objects_of_file(one.file, True, **self._reading)
            except ScanError as error:
                reasons[one.file.path.stem] = str(error)


class ScansInMemory:
    """Those that the user has at hand.

    Parameters
    ----------
    names : sequence of str
        Of the scans of a model.
    wanted : iterable of int
        Rows of those that are looked for.
    scans : sequence of Scan
        Where they may be, by their names.
    """

    paths: Iterable[Path] = ()

    def __init__(self, names: Sequence[str], wanted: Iterable[int], scans: Sequence[Scan]) -> None:
        called: dict[str, deque[Scan]] = defaultdict(deque)
        for scan in scans:
            called[scan.name].append(scan)
        self.missing: list[int] = []
        self._found: list[FoundScan] = []
        for row in sorted(wanted):
            if called[names[row]]:
                self._found.append(FoundScan(row, called[names[row]].popleft(), None))
            else:
                self.missing.append(row)

    def read(self) -> Iterator[FoundScan | UnusableScan]:
        return iter(self._found)

    def path_of(self, index: int) -> Path | None:
        return None


def _what_is_wanted(names: set[str], files: Sequence[ScanFile]) -> list[_Wanted]:
    """What each file is read for; those that are not read are left out."""
    counts: dict[str, set[int]] = defaultdict(set)
    for name in names:
        if view := mesh_and_count(name):
            counts[view[0]].add(view[1])
    # An object is called after its scene, with a number.
    scenes = {scene for scene, _, number in (name.rpartition("/") for name in names) if number.isdecimal()}
    meshes = set(counts)
    named = {file.name for file in files}
    found = []
    for file in files:
        whole = _own_name(file, names, named)
        mesh = _own_name(file, meshes, named)
        view_counts = tuple(sorted(counts[mesh])) if mesh else ()
        scene = file.path.stem in scenes
        if whole is not None or scene or view_counts:
            found.append(_Wanted(file, whole, scene, mesh, view_counts))
    return found


def _own_name(file: ScanFile, names: set[str], named: set[str]) -> str | None:
    """The one of some names that a file has: its own, or the longest end of its path that no file has."""
    if file.name in names:
        return file.name
    parts = file.path.parts
    ends = [str(file.path), *("/".join(parts[start:]) for start in range(len(parts)))]
    return next((end for end in ends if end in names and end not in named), None)
