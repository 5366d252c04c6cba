"""Descriptions that are kept: as good as new, and only where they are those of the segments."""

from pathlib import Path

import numpy as np
import pytest

import shapeconcepts
from shapeconcepts import DescribedObject, Segmenter, describe
from shapeconcepts.cli import object_reader
from shapeconcepts.cli.object_reader import ObjectReader
from shapeconcepts.descriptors.description_cache import DescriptionCache
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.segmentation.segment_cache import SegmentCache
from shapeconcepts.sources.collection import ScanFile, find_scan_files

KEY = "cd" * 32


@pytest.fixture
def cache(tmp_path: Path) -> DescriptionCache:
    return DescriptionCache(tmp_path / "descriptions", "version")


@pytest.fixture(scope="module")
def objects() -> list[DescribedObject]:
    scans = shapeconcepts.datasets.simulate(1)
    segmented = [shapeconcepts.segment(scan) for scan in scans]
    return [
        *(describe(one, n_occlusions=2) for one in segmented),
        describe(segmented[0], "fpfh"),
        describe(segmented[1], "surflet", n_occlusions=1),
    ]


def assert_same(one: DescribedObject, other: DescribedObject) -> None:
    for name in ("segment_histograms", "pairs", "pair_histograms"):
        a, b = getattr(one.description, name), getattr(other.description, name)
        assert a.dtype == b.dtype
        np.testing.assert_array_equal(a, b)
    assert one.description.blocks == other.description.blocks
    assert one.segment_edges.dtype == other.segment_edges.dtype
    np.testing.assert_array_equal(one.segment_edges, other.segment_edges)
    assert len(one.occlusions) == len(other.occlusions)
    for (a, a_segments), (b, b_segments) in zip(one.occlusions, other.occlusions, strict=True):
        assert_same(a, b)
        np.testing.assert_array_equal(a_segments, b_segments)


def test_what_is_stored_is_found(cache: DescriptionCache, objects: list[DescribedObject]) -> None:
    assert cache.load(KEY) is None
    cache.store(KEY, objects)
    kept = cache.load(KEY)
    assert kept is not None and len(kept) == len(objects)
    for one, other in zip(objects, kept, strict=True):
        assert_same(one, other)
        assert other.name == "" and other.label is None
    [path] = (path for path in cache.folder.rglob("*") if path.is_file())
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    assert cache.load(KEY) is None


def read_twice(
    file: ScanFile, first: ObjectReader, second: ObjectReader, monkeypatch: pytest.MonkeyPatch
) -> tuple[list[object_reader.ReadObject], list[object_reader.ReadObject], int]:
    """What two readers make of a file, and how often something was described the second time."""
    before = first(file)
    count = 0

    def counted(*arguments: object, **options: object) -> DescribedObject:
        nonlocal count
        count += 1
        return describe(*arguments, **options)  # type: ignore[arg-type]

    with monkeypatch.context() as patch:
        patch.setattr("shapeconcepts.descriptors.describe", counted)
        after = second(file)
    return before, after, count


def test_a_scan_is_described_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    [scan] = shapeconcepts.datasets.simulate(1, categories=["teddy"])
    (tmp_path / "scans" / "can").mkdir(parents=True)
    write_pcd(tmp_path / "scans" / "can" / "1.pcd", scan)
    [file] = find_scan_files(tmp_path / "scans")
    segments = SegmentCache(tmp_path / "cache" / "segments", "version")
    caches = {"cache": segments, "descriptions": DescriptionCache.beside(segments)}
    default = "surflet+fpfh+curvature"
    reader = ObjectReader({}, Segmenter(), default, n_occlusions=2, **caches)
    [before], [after], count = read_twice(file, reader, reader, monkeypatch)
    assert count == 0 and before.described is not None and after.described is not None
    assert_same(before.described, after.described)
    assert (after.described.name, after.described.label) == ("can/1.pcd", "can")
    for other in (
        ObjectReader({}, Segmenter(), default, n_occlusions=1, **caches),
        ObjectReader({}, Segmenter(), "fpfh", n_occlusions=2, **caches),
        ObjectReader({}, Segmenter(min_voxels=30), default, n_occlusions=2, **caches),
    ):
        assert read_twice(file, reader, other, monkeypatch)[2] == 1
    with_preview = ObjectReader({}, Segmenter(), default, n_occlusions=2, make_preview=True, **caches)
    _, [shown], count = read_twice(file, reader, with_preview, monkeypatch)
    assert count == 0 and shown.preview is not None
