"""Segments that are kept: found only where they are those of the file, whole and undamaged."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import shapeconcepts
from shapeconcepts import Segmenter
from shapeconcepts.cli.object_reader import ObjectReader
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.segmentation.segment_cache import SegmentCache
from shapeconcepts.segmentation.segmented_object import SegmentedObject
from shapeconcepts.sources import file_objects
from shapeconcepts.sources.collection import find_scan_files

KEY = "ab" * 32


@pytest.fixture
def cache(tmp_path: Path) -> SegmentCache:
    return SegmentCache(tmp_path / "cache", "version")


@pytest.fixture(scope="module")
def segmented() -> SegmentedObject:
    """The smallest object that has everything."""
    [scan] = shapeconcepts.datasets.simulate(1, categories=["ball"])
    return shapeconcepts.segment(scan)


def entry(cache: SegmentCache) -> Path:
    [path] = (path for path in cache.folder.rglob("*") if not path.is_dir())
    return path


def same(one: SegmentedObject, other: SegmentedObject) -> bool:
    return np.array_equal(one.points, other.points) and np.array_equal(
        one.segment_labels, other.segment_labels
    )


def test_what_is_stored_is_found(cache: SegmentCache, segmented: SegmentedObject) -> None:
    assert cache.load(KEY) is None
    cache.store(KEY, [segmented, segmented])
    first, second = cache.load(KEY) or []
    assert same(first, segmented)
    assert same(second, segmented)


def test_flipped_bits_are_noticed(cache: SegmentCache, segmented: SegmentedObject) -> None:
    cache.store(KEY, [segmented])
    path = entry(cache)
    content = path.read_bytes()
    # Everywhere, and closest in the headers at both ends, which name the arrays.
    n_bits = 8 * len(content)
    places = {*range(0, 4000, 61), *range(0, n_bits, 100_003), *range(n_bits - 4000, n_bits, 61)}
    for place in places:
        damaged = bytearray(content)
        damaged[place // 8] ^= 1 << place % 8
        path.write_bytes(damaged)
        assert cache.load(KEY) is None, place


def empty(path: Path) -> None:
    path.write_bytes(b"")


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1])


def lengthen(path: Path) -> None:
    path.write_bytes(path.read_bytes() + b"\0")


def put_a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def link_to_a_device(path: Path) -> None:
    path.unlink()
    path.symlink_to("/dev/zero")


def link_to_itself(path: Path) -> None:
    path.unlink()
    path.symlink_to(path)


def protect(path: Path) -> None:
    path.write_bytes(b"damaged")
    path.chmod(0o400)


@pytest.mark.skipif(os.name != "posix", reason="files of POSIX")
@pytest.mark.parametrize(
    "damage", [empty, truncate, lengthen, put_a_pipe, link_to_a_device, link_to_itself, protect]
)
def test_a_damaged_entry_counts_as_missing_and_is_replaced(
    cache: SegmentCache, segmented: SegmentedObject, damage: Callable[[Path], None]
) -> None:
    cache.store(KEY, [segmented])
    path = entry(cache)
    damage(path)
    assert cache.load(KEY) is None
    cache.store(KEY, [segmented])
    assert same((cache.load(KEY) or [])[0], segmented)
    assert entry(cache) == path
    assert not path.is_symlink()


def test_an_entry_under_another_name_is_not_taken(cache: SegmentCache, segmented: SegmentedObject) -> None:
    cache.store(KEY, [segmented])
    other = KEY[:-1] + "c"
    entry(cache).rename(entry(cache).with_stem(other))
    assert cache.load(other) is None


def test_a_file_that_is_replaced_while_it_is_read_is_not_kept(
    cache: SegmentCache, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ball, box = shapeconcepts.datasets.simulate(1, categories=["ball", "box"])
    path = tmp_path / "scan.pcd"
    write_pcd(path, ball)
    [file] = find_scan_files([path])
    iter_scans = file_objects.iter_scans

    def replaced(*arguments: object, **options: object) -> object:
        write_pcd(path, box)
        return iter_scans(*arguments, **options)

    reader = ObjectReader({}, Segmenter(), "surflet", cache=cache, keep_segmented=True)
    with monkeypatch.context() as patch:
        patch.setattr(file_objects, "iter_scans", replaced)
        [read] = reader(file)
    assert read.reason == ""
    assert not cache.folder.exists(), "whose segments these are is not known"
    write_pcd(path, ball)
    [again] = reader(file)
    assert again.segmented is not None and read.segmented is not None
    assert not same(again.segmented, read.segmented)
    assert same(again.segmented, shapeconcepts.segment(shapeconcepts.read_scan(path)))
    [kept] = reader(file)
    assert kept.segmented is not None and same(kept.segmented, again.segmented)
