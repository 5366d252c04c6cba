"""From files to segmented and described objects, over several processes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from shapeconcepts.descriptors import DescribedObject, Descriptor
    from shapeconcepts.descriptors.description_cache import DescriptionCache
    from shapeconcepts.report.html import ScanPreview
    from shapeconcepts.scan import Scan
    from shapeconcepts.segmentation.segment_cache import SegmentCache
    from shapeconcepts.segmentation.segmented_object import SegmentedObject
    from shapeconcepts.segmentation.segmenter import Segmenter
    from shapeconcepts.sources.collection import ScanFile
    from shapeconcepts.sources.reader import ReadOptions

    Source: TypeAlias = "ScanFile | SimulatedObject | Scan"

SIMULATED_PER_CATEGORY = 66
# A process is worth its start from so many scans on.
_SCANS_WORTH_A_PROCESS = 16


@dataclass(frozen=True)
class SimulatedObject:
    """An object of the simulator, in place of a file."""

    category: str
    index: int

    @property
    def name(self) -> str:
        """As the simulator calls it."""
        return f"{self.category}_{self.index}"

    @property
    def label(self) -> str:
        """Its category."""
        return self.category


class ReadObject(NamedTuple):
    """What became of an object: its description and what else was asked for, or why there is none.

    Where there is a description, but no preview, `drawing_failure` says why. Notices are those of the scan.
    """

    name: str
    described: DescribedObject | None = None
    segmented: SegmentedObject | None = None
    preview: ScanPreview | None = None
    reason: str = ""
    cache_failure: str = ""
    drawing_failure: str = ""
    notices: tuple[str, ...] = ()


@dataclass(frozen=True)
class ObjectReader:
    """Turns a file into the objects in it: one, or several where it is a labelled scene. Takes scans too.

    Attributes
    ----------
    reading : ReadOptions
    segmenter : Segmenter
    descriptor : str or Descriptor
    scenes : bool or None
        Whether point clouds are labelled scenes; None: those whose labels look like it.
    extract : bool
        Whether files are scenes, whose objects are found.
    cache : SegmentCache, optional
    descriptions : DescriptionCache, optional
        Beside it.
    keep_segmented, make_preview : bool
        What to hand back besides descriptions.
    n_occlusions : int
        Imagined ones that come with each description.
    n_views : int or None
        From how many sides meshes are scanned; None: from one.
    """

    reading: ReadOptions
    segmenter: Segmenter
    descriptor: str | Descriptor
    scenes: bool | None = None
    extract: bool = False
    cache: SegmentCache | None = None
    descriptions: DescriptionCache | None = None
    keep_segmented: bool = False
    make_preview: bool = False
    n_occlusions: int = 0
    n_views: int | None = None

    def __call__(self, source: Source) -> list[ReadObject]:
        """Objects of a source; never raises for what is wrong with a scan."""
        from shapeconcepts.scan import ScanError, scan_errors

        try:
            with scan_errors(source.name, "read"):
                key = self._key(source)
                kept = None if key is None or self.cache is None else self.cache.load(key)
                scans = self._scans(source) if kept is None else []
        except ScanError as error:
            return [ReadObject(source.name, reason=str(error))]
        if kept is not None:
            return self._finished(key, [_called(one, source) for one in kept])
        results = [self._segment(scan) for scan in scans]
        failure = self._keep(key, results, source)
        segmented = [one.segmented for one in results if one.segmented is not None]
        is_kept = len(segmented) == len(results) and not failure
        finished = iter(self._finished(key if is_kept else None, segmented))
        return [
            (one if one.segmented is None else next(finished))._replace(cache_failure=failure)
            for one in results
        ]

    def _scans(self, source: Source) -> list[Scan]:
        from shapeconcepts.datasets import simulate_scan
        from shapeconcepts.scan import Scan
        from shapeconcepts.sources.file_objects import objects_of_file

        if isinstance(source, Scan):
            return [source]
        if isinstance(source, SimulatedObject):
            return [simulate_scan(source.category, source.index)]
        if self.extract:
            return self._extracted(source)
        return objects_of_file(source, self.scenes, self.n_views, **self.reading)

    def _extracted(self, file: ScanFile) -> list[Scan]:
        from shapeconcepts.extraction import extract_objects
        from shapeconcepts.scan import ScanError
        from shapeconcepts.sources.collection import mask_of
        from shapeconcepts.sources.file_objects import category_folder
        from shapeconcepts.sources.osd import scene_category
        from shapeconcepts.sources.scene_files import read_scene

        if file.failure:
            raise ScanError(f"{file.path}: {file.failure}")
        reading: ReadOptions = {**self.reading, "mask": mask_of(file, self.reading)}
        found = extract_objects(read_scene(file.path, **reading))
        if not found:
            raise ScanError(f"{file.path}: holds no object that stands on something that can be seen")
        label = category_folder(file) or scene_category(file.path.stem)
        return [replace(one.scan, label=label) for one in found]

    def _segment(self, scan: Scan) -> ReadObject:
        from shapeconcepts.scan import ScanError, scan_errors

        try:
            with scan_errors(scan.name, "segmented"):
                return ReadObject(scan.name, segmented=self.segmenter.segment(scan))
        except ScanError as error:
            return ReadObject(scan.name, reason=str(error))

    def _finished(self, key: str | None, segmented: list[SegmentedObject]) -> list[ReadObject]:
        """Segmented objects described, from the cache if it has them; and what else is asked for."""
        described = None if key is None else self._kept_descriptions(key, segmented)
        results = described or [self._describe(one) for one in segmented]
        if described is None and key is not None:
            self._keep_descriptions(key, results)
        finished = []
        for result, one in zip(results, segmented, strict=True):
            if result.described is None:
                finished.append(result)
                continue
            with_notices = result._replace(
                segmented=one if self.keep_segmented else None, notices=one.notices
            )
            finished.append(self._with_preview(with_notices, one) if self.make_preview else with_notices)
        return finished

    def _describe(self, segmented: SegmentedObject) -> ReadObject:
        from shapeconcepts.descriptors import describe
        from shapeconcepts.motifs.decomposition import MAX_SEGMENTS
        from shapeconcepts.scan import ScanError, scan_errors

        name, count = segmented.name, segmented.n_segments
        try:
            # A model that was learned in Python may cut scans into more than can be composed.
            if count > MAX_SEGMENTS:
                raise ScanError(f"{name}: has {count} segments, expected at most {MAX_SEGMENTS}")
            with scan_errors(name, "described"):
                return ReadObject(name, describe(segmented, self.descriptor, self.n_occlusions))
        except ScanError as error:
            return ReadObject(name, reason=str(error))

    def _kept_descriptions(self, key: str, segmented: list[SegmentedObject]) -> list[ReadObject] | None:
        if self.descriptions is None:
            return None
        kept = self.descriptions.load(self._description_key(self.descriptions, key))
        if kept is None:
            return None
        return [
            ReadObject(one.name, replace(described, name=one.name, label=one.label))
            for one, described in zip(segmented, kept, strict=True)
        ]

    def _keep_descriptions(self, key: str, results: list[ReadObject]) -> None:
        described = [one.described for one in results if one.described is not None]
        if self.descriptions is None or len(described) < len(results):
            return
        # Where segments can be kept, so can these; if not, they are made anew.
        with suppress(OSError):
            self.descriptions.store(self._description_key(self.descriptions, key), described)

    def _description_key(self, descriptions: DescriptionCache, key: str) -> str:
        return descriptions.key(key.encode(), (self.descriptor, self.n_occlusions))

    def _with_preview(self, finished: ReadObject, segmented: SegmentedObject) -> ReadObject:
        from shapeconcepts.report.html import preview
        from shapeconcepts.scan import ScanError, scan_errors

        try:
            with scan_errors(segmented.name, "drawn"):
                return finished._replace(preview=preview(segmented))
        except ScanError as error:
            return finished._replace(drawing_failure=str(error))

    def _keep(self, key: str | None, results: list[ReadObject], source: Source) -> str:
        """Put a source's objects into the cache; why that is not possible, or nothing."""
        segmented = [one.segmented for one in results if one.segmented is not None]
        # What cannot be segmented is not kept: it costs little to find that out again.
        if key is None or self.cache is None or len(segmented) < len(results):
            return ""
        # A file that was replaced since its key was made: these may be the segments of the one or the other.
        if key != self._key(source):
            return ""
        try:
            self.cache.store(key, [_uncalled(one, source) for one in segmented])
        except OSError as error:
            return f"{self.cache.folder}: {error.strerror or error}"
        return ""

    @property
    def _segmentation(self) -> list[tuple[str, Any]]:
        return sorted(self.segmenter.get_params().items())

    def _key(self, source: Source) -> str | None:
        """Name of a source's entry in the cache; None where it cannot be read."""
        from shapeconcepts.io.regular_file import read_regular_file
        from shapeconcepts.scan import Scan, ScanError
        from shapeconcepts.sources.collection import mask_of

        if self.cache is None:
            return None
        if isinstance(source, Scan):
            viewpoint = None if source.viewpoint is None else source.viewpoint.tolist()
            scan = ("scan", viewpoint, source.notices)
            return self.cache.key(source.points.tobytes(), (scan, self._segmentation))
        if isinstance(source, SimulatedObject):
            return self.cache.key(b"", (source, self._segmentation))
        try:
            content = read_regular_file(source.path)
            mask = mask_of(source, self.reading)
            if isinstance(mask, Path):
                content += read_regular_file(mask)
        except ScanError:
            return None
        options = ("intrinsics", "depth_scale", "units", "up")
        reading = tuple(self.reading.get(option) for option in options)
        # The suffix tells how the file is read; a file that was found in a folder may be no scan.
        way = (source.path.suffix.lower(), source.is_found, self.scenes, self.extract, self.n_views)
        parameters = (way, reading, self._segmentation)
        return self.cache.key(content, parameters)


def _uncalled(segmented: SegmentedObject, source: Source) -> SegmentedObject:
    """Without what depends on the place of the file; of an object of a scene its number stays."""
    number = "" if segmented.name == source.name else segmented.name.rpartition("/")[2]
    return replace(segmented, name=number, label=None)


def _called(segmented: SegmentedObject, source: Source) -> SegmentedObject:
    """An object of the cache as it is called now: the file may have been moved."""
    from shapeconcepts.sources.collection import ScanFile
    from shapeconcepts.sources.file_objects import category_folder
    from shapeconcepts.sources.mesh_views import mesh_and_count
    from shapeconcepts.sources.osd import scene_category

    view = f"{source.name}/{segmented.name}"
    if mesh_and_count(view):
        return replace(segmented, name=view, label=source.label)
    if segmented.name == "" or not isinstance(source, ScanFile):
        return replace(segmented, name=source.name, label=source.label)
    stem = source.path.stem
    label = category_folder(source) or scene_category(stem)
    return replace(segmented, name=f"{stem}/{segmented.name}", label=label)


def simulated_objects() -> list[ScanFile | SimulatedObject]:
    """What commands take where the user gives no scans."""
    from shapeconcepts.datasets import CATEGORIES

    return [SimulatedObject(name, index) for name in CATEGORIES for index in range(SIMULATED_PER_CATEGORY)]


def useful_jobs(jobs: int, n_scans: int) -> int:
    """Number of processes; where the user leaves it open, only as many as pay for their start."""
    from joblib import effective_n_jobs

    if jobs > 0:
        return min(jobs, max(n_scans, 1))
    return max(1, min(effective_n_jobs(jobs), n_scans // _SCANS_WORTH_A_PROCESS))


def read_objects(
    sources: Sequence[Source], reader: ObjectReader, jobs: int, *, strict: bool = False
) -> Iterator[list[ReadObject]]:
    """Objects of each source, in order.

    With `strict` nothing more is begun after the first object that cannot be used.
    """
    from shapeconcepts.parallel import map_in_order

    failed = False

    def wanted() -> Iterator[Source]:
        for source in sources:
            if strict and failed:
                return
            yield source

    for objects in map_in_order(reader, wanted(), useful_jobs(jobs, len(sources))):
        failed = failed or any(one.reason for one in objects)
        yield objects
