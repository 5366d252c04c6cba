"""Depth images in recordings."""

import numpy as np
import pytest

from recording_examples import BEGIN, SECOND, Maker, compressed_depth, png, split, write
from shapeconcepts.recordings import read_scenes, topics
from shapeconcepts.recordings.camera import camera_of
from shapeconcepts.recordings.depth_message import compressed_depths, image_depths
from shapeconcepts.scan import ScanError

MILLIMETRES = np.array([[0, 1000, 1500, 2000], [700, 0, 65535, 800], [1, 2, 3, 4]], np.uint16)
METRES = np.array([[np.nan, 1.0, 1.5, 2.0], [0.7, 0.0, np.inf, 0.8], [0.1, -0.2, 0.3, 0.4]], np.float32)


def expected_points(depths):
    rows, columns = np.indices(depths.shape)
    return np.stack([(columns - 1.5) / 500.0 * depths, (rows - 1.0) / 510.0 * depths, depths], axis=-1)


def read_one(tmp_path, storage, image, topic="/camera/depth/image_raw", info_topic=None, **info):
    def messages(maker):
        yield info_topic or "/camera/depth/camera_info", BEGIN, maker.info(**info)
        yield topic, BEGIN + 1, image(maker)

    path = write(tmp_path / "depth", storage, messages)
    return split(read_scenes(path))


@pytest.mark.parametrize("storage", ["bag", "db3", "mcap"])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("row_gap", [0, 6])
@pytest.mark.parametrize(("pixels", "encoding"), [(MILLIMETRES, "16UC1"), (METRES, "32FC1")])
def test_depth_images_become_organised_points(tmp_path, storage, order, row_gap, pixels, encoding):
    given = pixels.astype(pixels.dtype.newbyteorder(order))
    (scene,), errors = read_one(
        tmp_path,
        storage,
        lambda maker: maker.image(given, encoding, row_gap=row_gap, is_bigendian=int(order == ">")),
    )
    assert errors == []
    depths = pixels * 0.001 if encoding == "16UC1" else pixels.astype(np.float64)
    missing = ~(np.isfinite(pixels) & (pixels > 0)) | (pixels == 65535)
    depths[missing] = np.nan
    assert np.array_equal(scene.points, expected_points(depths), equal_nan=True)
    assert np.array_equal(scene.viewpoint, np.zeros(3))
    assert scene.up is None
    assert scene.name == "depth/camera_depth_image_raw/1700000000_000000000"


def test_compressed_depth_in_millimetres(tmp_path):
    (scene,), errors = read_one(
        tmp_path,
        "mcap",
        lambda maker: maker.compressed("16UC1; compressedDepth png", compressed_depth(MILLIMETRES)),
        topic="/camera/depth/image_raw/compressedDepth",
    )
    assert errors == []
    assert scene.points[0, 1, 2] == 1.0
    assert np.isnan(scene.points[0, 0]).all()


def test_compressed_depth_that_was_quantised():
    factor, offset = 100.0, -7.5
    pixels = np.array([[0, 1, 40], [100, 200, 65535]], np.uint16)
    message = Maker(2).compressed("32FC1; compressedDepth png", compressed_depth(pixels, factor, offset))
    depths = compressed_depths(message)
    expected = np.float32(factor) / (pixels.astype(np.float32) - np.float32(offset))
    assert np.isnan(depths[0, 0])
    assert np.array_equal(depths.ravel()[1:], expected.ravel()[1:].astype(np.float64))


@pytest.mark.parametrize("form", ["16UC1; compressedDepth", "; compressedDepth png", "compressedDepth"])
def test_older_names_of_compressed_depth(form):
    assert compressed_depths(Maker(2).compressed(form, compressed_depth(MILLIMETRES)))[0, 1] == 1.0


@pytest.mark.parametrize("form", ["png", "16UC1; png compressed ", "mono16; png compressed"])
def test_plain_png_of_16_bits(form):
    assert compressed_depths(Maker(2).compressed(form, png(MILLIMETRES)))[1, 0] == 700 * 0.001


@pytest.mark.parametrize(
    ("form", "data", "told"),
    [
        ("16UC1; compressedDepth rvl", b"\0" * 40, "of compressed depths, only png is read"),
        ("jpeg", b"\xff\xd8\xff", "holds images of the format 'jpeg', expected depths"),
        ("rgb8; jpeg compressed bgr8", b"\xff\xd8\xff", "holds images of the format 'rgb8', expected"),
        ("png", png(np.zeros((3, 4, 3), np.uint8)), "expected depths: PNG with one channel of 16 bits"),
        ("16UC1; compressedDepth png", b"", "expected depths: PNG"),
        ("16UC1; compressedDepth png", compressed_depth(MILLIMETRES)[:60], "is no image that can be read"),
        ("16UC1; compressedDepth png", compressed_depth(MILLIMETRES)[:30], "is not a PNG image"),
    ],
)
def test_what_is_no_compressed_depth_is_told(form, data, told):
    with pytest.raises(ScanError, match=told):
        compressed_depths(Maker(2).compressed(form, data))


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            {"encoding": "rgb8"},
            "holds images of the encoding 'rgb8', expected depths: 16UC1 or mono16 or 32FC1",
        ),
        ({"step": 7}, "has step 7, expected at least 4 pixels of 2 bytes"),
        ({"step": 0}, "has step 0, expected"),
        ({"height": 4}, "has 24 bytes of data, expected at least 32 for 4 x 4 pixels"),
        ({"width": 2**32 - 1, "height": 2**32 - 1, "step": 2**32 - 1}, "has step 4294967295, expected at"),
        ({"width": 0}, r"holds no pixels \(0 x 3\)"),
    ],
)
def test_what_is_no_depth_image_is_told(changes, told):
    message = Maker(2).image(MILLIMETRES, changes.pop("encoding", "16UC1"), **changes)
    with pytest.raises(ScanError, match=told):
        image_depths(message)


def test_the_camera_of_the_same_frame_where_none_is_in_the_namespace(tmp_path):
    def messages(maker):
        yield "/a/info", BEGIN, maker.info(frame="other", focal=(1.0, 1.0))
        yield "/b/info", BEGIN, maker.info(size=(8, 6), focal=(2.0, 2.0))
        yield "/c/info", BEGIN, maker.info()
        yield "/depths", BEGIN + 1, maker.image(MILLIMETRES, "16UC1")

    path = write(tmp_path / "depth", "mcap", messages)
    assert [topic.camera_info for topic in topics(path) if topic.kind == "depth"] == ["/c/info"]
    (scene,), _ = split(read_scenes(path))
    assert scene.points[0, 3, 0] == 1.5 / 500.0 * 2.0


@pytest.mark.parametrize("storage", ["bag", "db3", "mcap"])
def test_the_newest_camera_until_the_image_counts_or_else_the_first(tmp_path, storage):
    def messages(maker):
        yield "/depths", BEGIN, maker.image(MILLIMETRES, "16UC1", stamp=BEGIN)
        for number in (1, 2):
            later = BEGIN + number * 20 * SECOND
            yield "/camera_info", later, maker.info(focal=(100.0 * number, 100.0))
            yield "/depths", later + 1, maker.image(MILLIMETRES, "16UC1", stamp=later)

    path = write(tmp_path / "depth", storage, messages)
    scenes, _ = split(read_scenes(path))
    assert [1.5 * 2.0 / scene.points[0, 3, 0] for scene in scenes] == pytest.approx([100.0, 100.0, 200.0])
    (last,), _ = split(read_scenes(path, start=39.0 + 1.0, end=41.0))
    assert np.array_equal(last.points, scenes[2].points, equal_nan=True)


def test_depth_images_without_a_camera_are_told(tmp_path):
    path = write(
        tmp_path / "depth",
        "bag",
        lambda maker: [("/depths", BEGIN, maker.image(MILLIMETRES, "16UC1"))],
    )
    with pytest.raises(ScanError, match=r"depth\.bag: the topic /depths has no CameraInfo beside it"):
        next(read_scenes(path))


def test_a_camera_of_another_size_is_told(tmp_path):
    scenes, errors = read_one(tmp_path, "mcap", lambda maker: maker.image(MILLIMETRES, "16UC1"), size=(8, 3))
    assert scenes == []
    assert "is an image of 4 x 3 pixels, its CameraInfo is for 8 x 3" in errors[0]
    assert "/camera/depth/image_raw at 1700000000.000 s: " in errors[0]


@pytest.mark.parametrize("focal", [(0.0, 0.0), (np.nan, 1.0), (-1.0, 1.0)])
def test_a_camera_that_is_not_calibrated_is_told(focal):
    with pytest.raises(ScanError, match="is a CameraInfo that is not calibrated"):
        camera_of(Maker(2).info(focal=focal), False)


def test_binning_and_a_part_of_the_image():
    camera = camera_of(
        Maker(2).info(size=(640, 480), centre=(320.0, 240.0), binning=(2, 2), region=(100, 200, 80, 120)),
        False,
    )
    # RegionOfInterest is x, y, height, width.
    assert camera.size == (60, 40)
    assert camera.focal == (250.0, 255.0)
    assert camera.centre == (110.0, 20.0)


def test_distortion_is_said_once_and_not_of_rectified_images(tmp_path):
    def messages(topic):
        def made(maker):
            yield (
                "/depth/camera_info",
                BEGIN,
                maker.info(distortion=(0.1, 0, 0, 0, 0), projection=[400, 0, 1, 0, 0, 400, 1, 0, 0, 0, 1, 0]),
            )
            for number in range(3):
                yield topic, BEGIN + number, maker.image(MILLIMETRES, "16UC1", stamp=BEGIN + number)

        return made

    raw, _ = split(read_scenes(write(tmp_path / "raw", "mcap", messages("/depth/image_raw"))))
    assert [len(scene.notices) for scene in raw] == [1, 0, 0]
    assert "has a camera with lens distortion (D is not 0): " in raw[0].notices[0]
    rectified, _ = split(read_scenes(write(tmp_path / "rect", "mcap", messages("/depth/image_rect"))))
    assert [scene.notices for scene in rectified] == [()] * 3
    assert rectified[0].points[0, 3, 0] == pytest.approx(2.0 / 400.0 * 2.0)


def test_an_image_without_a_depth_is_told(tmp_path):
    scenes, errors = read_one(tmp_path, "db3", lambda maker: maker.image(MILLIMETRES * 0, "16UC1"))
    assert scenes == []
    assert "holds no point with finite x, y and z" in errors[0]
