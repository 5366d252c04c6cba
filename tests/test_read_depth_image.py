"""Depth images: 16 bit PNG, intrinsics and masks."""

import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from shapeconcepts.scan import ScanError
from shapeconcepts.sources import read_scan


def chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def png_bytes(depth, width=None, height=None, bits=16, colour=0):
    """Written from the PNG specification, without a library."""
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in depth)
    size = struct.pack(">IIBBBBB", width or depth.shape[1], height or depth.shape[0], bits, colour, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", size)
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


def depth_image(shape=(480, 640)):
    depth = np.zeros(shape, dtype=np.uint16)
    depth[10:30, 20:50] = np.random.default_rng(0).integers(500, 60_000, (20, 30))
    depth[12, 22] = 0
    return depth


def slow_points(depth, fx, fy, cx, cy, scale):
    return [
        [(u - cx) * depth[v, u] * scale / fx, (v - cy) * depth[v, u] * scale / fy, depth[v, u] * scale]
        for v in range(depth.shape[0])
        for u in range(depth.shape[1])
        if depth[v, u]
    ]


def write(tmp_path, data, name="scan.png"):
    (tmp_path / name).write_bytes(data)
    return tmp_path / name


def test_kinect_by_default(tmp_path):
    depth = depth_image()
    scan = read_scan(write(tmp_path, png_bytes(depth)))
    np.testing.assert_allclose(scan.points, slow_points(depth, 525, 525, 319.5, 239.5, 0.001), rtol=1e-12)
    np.testing.assert_array_equal(scan.viewpoint, [0, 0, 0])


def test_written_by_pillow(tmp_path):
    depth = depth_image()
    Image.fromarray(depth).save(tmp_path / "scan.png")
    np.testing.assert_array_equal(
        read_scan(tmp_path / "scan.png").points, read_scan(write(tmp_path, png_bytes(depth), "b.png")).points
    )


def test_other_camera(tmp_path):
    depth = depth_image((40, 60))
    path = write(tmp_path, png_bytes(depth))
    scan = read_scan(path, intrinsics=(50.0, 60.0, 30.5, 19.5), depth_scale=0.0002)
    np.testing.assert_allclose(scan.points, slow_points(depth, 50, 60, 30.5, 19.5, 0.0002), rtol=1e-12)
    with pytest.raises(ScanError, match=r"scan\.png: is 60 x 40 pixels; intrinsics"):
        read_scan(path)


@pytest.mark.parametrize("mode", ["1", "L", "P", "I;16"])
def test_mask_image_and_array(tmp_path, mode):
    depth = depth_image()
    mask = np.zeros(depth.shape, dtype=np.uint8)
    mask[5:20, 5:40] = 7
    if mode == "1":
        image = Image.fromarray(mask > 0)
    elif mode == "I;16":
        image = Image.fromarray(mask.astype(np.uint16))
    else:
        image = Image.fromarray(mask)
        if mode == "P":
            image.putpalette([0, 0, 0] * 256)
    assert image.mode == mode
    image.save(tmp_path / "mask.png")
    path = write(tmp_path, png_bytes(depth))
    expected = slow_points(np.where(mask > 0, depth, 0), 525, 525, 319.5, 239.5, 0.001)
    for given in (tmp_path / "mask.png", str(tmp_path / "mask.png"), mask, mask > 0):
        np.testing.assert_allclose(read_scan(path, mask=given).points, expected, rtol=1e-12)


def test_bad_masks(tmp_path):
    path = write(tmp_path, png_bytes(depth_image()))
    Image.fromarray(np.ones((48, 64), dtype=np.uint8)).save(tmp_path / "small.png")
    write(tmp_path, b"\xff\xd8 this is no image", "broken.png")
    cases = [
        (tmp_path / "small.png", r"mask .*small\.png is 64 x 48 pixels, the depth image 640 x 480"),
        (tmp_path / "broken.png", r"broken\.png"),
        (tmp_path / "missing.png", r"missing\.png"),
        (np.ones((48, 64)), r"shape \(480, 640\)"),
        (np.ones((480, 640, 5)), r"shape \(480, 640\), got \(480, 640, 5\)"),
        (np.zeros((480, 640)), "no pixel with a depth in its mask"),
    ]
    for mask, message in cases:
        with pytest.raises(ScanError, match=rf"scan\.png: .*{message}"):
            read_scan(path, mask=mask)


def test_bad_parameters(tmp_path):
    path = write(tmp_path, png_bytes(depth_image()))
    for intrinsics in [(525, 525, 320), (0, 525, 320, 240), (525, -1, 320, 240), (525, np.nan, 320, 240)]:
        with pytest.raises(ValueError, match="intrinsics"):
            read_scan(path, intrinsics=intrinsics)
    for depth_scale in (0, -0.001, np.nan, np.inf):
        with pytest.raises(ValueError, match="depth_scale"):
            read_scan(path, depth_scale=depth_scale)
    with pytest.raises(ValueError, match="mask"):
        read_scan(tmp_path / "scan.pcd", mask=np.ones((480, 640)))


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "P", "1"])
def test_not_a_depth_image(tmp_path, mode):
    Image.new(mode, (640, 480)).save(tmp_path / "scan.png")
    with pytest.raises(ScanError, match="not a depth image"):
        read_scan(tmp_path / "scan.png")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (png_bytes(np.zeros((480, 640))), "no pixel"),
        (png_bytes(depth_image())[:-200], "read"),
        (png_bytes(depth_image())[:30], "not a PNG"),
        (png_bytes(depth_image(), height=481), "intrinsics"),
        (png_bytes(np.zeros((480, 640)), 60_000, 60_000), "60000 x 60000"),
        (png_bytes(np.zeros((480, 640)), 2**31 - 1, 2**31 - 1), "at most"),
        (b"\xff\xd8\xff\xe0\x00\x10JFIF" + bytes(range(256)), "not a PNG"),
        (np.random.default_rng(0).bytes(5000), "not a PNG"),
    ],
)
def test_bad_image(tmp_path, data, message):
    with pytest.raises(ScanError, match=rf"scan\.png: .*{message}"):
        read_scan(write(tmp_path, data))


def test_damaged_header(tmp_path):
    """The checksum tells that the height is not what was written."""
    data = bytearray(png_bytes(depth_image()))
    data[23] -= 1
    with pytest.raises(ScanError, match=r"scan\.png: is no image"):
        read_scan(write(tmp_path, bytes(data)), intrinsics=(525, 525, 320, 240))


@pytest.mark.parametrize(
    ("mode", "channel"), [("LA", 0), *((mode, channel) for mode in ("RGB", "RGBA") for channel in range(3))]
)
def test_mask_in_colour(tmp_path, mode, channel):
    """Any colour is object; opacity says nothing."""
    depth = depth_image()
    mask = np.zeros((*depth.shape, len(mode)), dtype=np.uint8)
    mask[5:20, 5:40, channel] = 3
    if mode != "RGB":
        mask[:, :, -1] = 255
        mask[5:20, 5:40, -1] = 0
    Image.fromarray(mask, mode).save(tmp_path / "mask.png")
    path = write(tmp_path, png_bytes(depth))
    expected = slow_points(np.where(mask[:, :, channel] > 0, depth, 0), 525, 525, 319.5, 239.5, 0.001)
    for given in (tmp_path / "mask.png", mask):
        np.testing.assert_allclose(read_scan(path, mask=given).points, expected, rtol=1e-12)


def test_more_pixels_than_any_camera_has(tmp_path):
    path = write(tmp_path, png_bytes(np.zeros((1, 1)), 4096, 4096))
    with pytest.raises(ScanError, match=r"scan\.png: is 4096 x 4096 pixels, at most 8388608"):
        read_scan(path, intrinsics=(525, 525, 2048, 2048))
