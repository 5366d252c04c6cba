"""Damaged files of every format: a scan or a ScanError, nothing else, and bounded memory."""

import io
import struct
import tracemalloc
import warnings

import numpy as np
import pypcd4
import pytest
import trimesh
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from PIL import Image

from shapeconcepts.scan import Scan, ScanError
from shapeconcepts.sources import SCAN_SUFFIXES, read_scan

MEGABYTE = 2**20


def _pcd(encoding):
    stream = io.BytesIO()
    points = np.random.default_rng(0).normal(0, 0.05, (60, 3)).astype(np.float32) + np.float32([0, 0, 1])
    cloud = pypcd4.PointCloud.from_points(
        [*points.T, np.arange(60, dtype=np.uint8)], ("x", "y", "z", "label"), (np.float32,) * 3 + (np.uint8,)
    )
    cloud.save(stream, encoding)
    return stream.getvalue()


def _valid_files():
    points = np.random.default_rng(0).normal(0, 0.05, (60, 3)) + np.array([0, 0, 1])
    box = trimesh.creation.box((0.1, 0.2, 0.1))
    files = {f"{encoding.value}.pcd": _pcd(encoding) for encoding in list(pypcd4.Encoding)[:3]}
    for encoding in ("ascii", "binary"):
        files[f"cloud_{encoding}.ply"] = trimesh.PointCloud(points).export(file_type="ply", encoding=encoding)
        files[f"mesh_{encoding}.ply"] = box.export(file_type="ply", encoding=encoding)
    table = "\n".join(f"{x:.4f} {y:.4f} {z:.4f} {i}" for i, (x, y, z) in enumerate(points))
    files["a.xyz"] = table.encode()
    files["a.txt"] = b"60\n" + table.encode()
    files["a.pts"], files["a.asc"] = files["a.txt"], files["a.xyz"]
    files["a.csv"] = b"x,y,z,label\n" + table.replace(" ", ",").encode()
    for name, save in (("a.npy", np.save), ("stored.npz", np.savez), ("deflated.npz", np.savez_compressed)):
        stream = io.BytesIO()
        if name == "a.npy":
            save(stream, points)
        else:
            save(stream, points=points, viewpoint=np.zeros(3), labels=np.arange(60))
        files[name] = stream.getvalue()
    depth = np.zeros((480, 640), dtype=np.uint16)
    depth[100:120, 100:130] = 900
    stream = io.BytesIO()
    Image.fromarray(depth).save(stream, "PNG")
    files["a.png"] = stream.getvalue()
    for suffix in ("tif", "tiff"):
        stream = io.BytesIO()
        Image.fromarray(depth).save(stream, "TIFF")
        files[f"a.{suffix}"] = stream.getvalue()
    for file_type in ("obj", "off", "stl", "stl_ascii", "glb"):
        data = box.export(file_type=file_type)
        files[f"{file_type}.{file_type[:3]}"] = data.encode() if isinstance(data, str) else data
    return files


VALID = _valid_files()


def test_every_format_is_here(tmp_path):
    assert {name[name.index(".") :] for name in VALID} == set(SCAN_SUFFIXES)
    for name, data in VALID.items():
        (tmp_path / name).write_bytes(data)
        assert len(read_scan(tmp_path / name)) > 0


def check(path, data):
    path.write_bytes(data)
    tracemalloc.start()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = read_scan(path)
    except ScanError as error:
        assert str(error).startswith(str(path))
        result = None
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert result is None or isinstance(result, Scan)
    # A depth image and the simulator's image have their size whatever the file.
    assert peak < 64 * MEGABYTE


# A place in the file (as a share of it, the header being as likely as the rest), and what happens there.
CHANGE = st.tuples(
    st.one_of(st.floats(0, 1), st.floats(0, 0.1)),
    st.sampled_from(["flip", "insert", "delete", "number", "cut"]),
    st.binary(min_size=1, max_size=6),
)
NUMBERS = [
    b"0",
    b"-1",
    b"99999999",
    b"1e999",
    b"nan",
    *(struct.pack("<I", n) for n in (0, 2**31 - 1, 2**32 - 1)),
]


def damaged(data, changes):
    for share, kind, some in changes:
        place = int(share * len(data))
        if kind == "flip":
            data = data[:place] + some + data[place + len(some) :]
        elif kind == "insert":
            data = data[:place] + some + data[place:]
        elif kind == "delete":
            data = data[:place] + data[place + len(some) :]
        elif kind == "number":
            data = data[:place] + NUMBERS[some[0] % len(NUMBERS)] + data[place + 1 + some[0] % 4 :]
        else:
            data = data[:place]
    return data


@pytest.mark.parametrize("name", VALID)
@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(changes=st.lists(CHANGE, min_size=1, max_size=3))
@example(changes=[(0.0, "flip", b"\0")])
def test_damaged_file(name, changes, tmp_path_factory):
    check(tmp_path_factory.getbasetemp() / f"fuzz_{name}", damaged(VALID[name], changes))


@pytest.mark.parametrize("suffix", SCAN_SUFFIXES)
@settings(max_examples=15, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.one_of(st.binary(max_size=2000), st.sampled_from(list(VALID.values()))))
def test_content_of_another_kind(suffix, data, tmp_path_factory):
    check(tmp_path_factory.getbasetemp() / f"fuzz{suffix}", data)
