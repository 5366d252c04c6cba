"""Point clouds in recordings: equal to the bit in every storage and layout."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from recording_examples import BEGIN, STORAGES, Maker, clouds, split, write
from shapeconcepts.recordings import read_scenes
from shapeconcepts.recordings.point_cloud import cloud_points
from shapeconcepts.scan import ScanError

AXES = ("x", "y", "z")


def values(rng, shape, layout):
    """Random points in a structured layout, some of them not measured."""
    points = np.zeros(shape, layout)
    for axis in AXES:
        points[axis] = rng.normal(size=shape).astype(points[axis].dtype)
        points[axis][rng.random(shape) < 0.2] = np.nan
    if "label" in points.dtype.names:
        points["label"] = rng.integers(0, 100, shape)
    points["x"].flat[0] = points["y"].flat[0] = points["z"].flat[0] = 0.1
    return points


@st.composite
def layouts(draw):
    """A dtype with x, y, z, and others, anywhere."""
    order = draw(st.sampled_from("<>"))
    kinds = {axis: draw(st.sampled_from(("f4", "f8"))) for axis in AXES}
    kinds |= draw(st.sampled_from(({}, {"rgb": "f4"}, {"label": "u2"}, {"label": "i4", "ring": "u1"})))
    names, offsets, end = draw(st.permutations(list(kinds))), [], 0
    for name in names:
        end += draw(st.integers(0, 5))
        offsets.append(end)
        end += int(kinds[name][1])
    formats = [order + kinds[name] for name in names]
    return np.dtype(
        {
            "names": names,
            "formats": formats,
            "offsets": offsets,
            "itemsize": end + draw(st.integers(0, 7)),
        }
    )


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    layout=layouts(),
    shape=st.one_of(st.tuples(st.integers(1, 6)), st.tuples(st.integers(1, 4), st.integers(1, 4))),
    row_gap=st.integers(0, 9),
    seed=st.integers(0, 100),
    storage=st.sampled_from(list(STORAGES)),
)
def test_every_layout_is_read_to_the_bit_from_every_storage(
    tmp_path_factory, layout, shape, row_gap, seed, storage
):
    written = values(np.random.default_rng(seed), shape, layout)
    is_big = layout["x"].byteorder == ">"

    def messages(maker):
        yield "/points", BEGIN, maker.cloud(written, row_gap=row_gap, is_bigendian=is_big)

    path = write(tmp_path_factory.mktemp("layouts") / "one", storage, messages)
    (scene,), errors = split(read_scenes(path))
    assert errors == []
    expected = np.stack([written[axis].astype(np.float64) for axis in AXES], axis=-1)
    # A single row is a cloud without rows.
    expected = expected.reshape(scene.points.shape) if shape[0] == 1 else expected
    assert scene.points.shape == expected.shape
    assert np.array_equal(scene.points, expected, equal_nan=True)
    if "label" in layout.names:
        assert np.array_equal(scene.point_labels.ravel(), written["label"].ravel())
    else:
        assert scene.point_labels is None


@pytest.mark.parametrize("storage", list(STORAGES))
def test_every_storage_gives_all_clouds_in_order(tmp_path, storage):
    path = write(tmp_path / "walk", storage, clouds(30, n_points=1000))
    scenes, errors = split(read_scenes(path))
    assert errors == []
    assert [scene.points[0, 0] for scene in scenes] == list(range(1, 31))
    assert [scene.time for scene in scenes] == pytest.approx(
        [BEGIN / 1e9 + number / 10 for number in range(30)], abs=1e-6
    )
    assert scenes[3].name == "walk/camera_depth_points/1700000000_300000000"
    assert np.array_equal(scenes[0].viewpoint, np.zeros(3))


def test_a_label_that_is_no_whole_number_is_left_out_and_said(tmp_path):
    points = np.ones(3, [("x", "f4"), ("y", "f4"), ("z", "f4"), ("label", "f4")])
    _, labels, notices = cloud_points(Maker(2).cloud(points))
    assert labels is None
    assert notices == ("has a field label that is of no whole type: it is left out",)


@pytest.mark.parametrize("row_step", [0, 7])
def test_the_row_step_of_a_single_row_does_not_count(row_step):
    points, _, _ = cloud_points(Maker(2).cloud(np.ones((4, 3)), row_step=row_step))
    assert points.shape == (4, 3)


FIELDS = [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1)]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"point_step": 0}, "has the field x at bytes 0 to 4 of a point, expected within point_step 0"),
        ({"point_step": 11}, "has the field z at bytes 8 to 12 of a point, expected within point_step 11"),
        ({"fields": FIELDS[:2]}, "has no field z, expected x, y and z, got x y"),
        ({"fields": []}, "has no field x y z, expected x, y and z, got none"),
        ({"fields": [*FIELDS[:2], ("z", 8, 5, 1)]}, "has the field z of type 5, expected float32 or"),
        ({"fields": [*FIELDS[:2], ("z", 8, 99, 1)]}, "has the field z of type 99, expected float32 or"),
        ({"fields": [*FIELDS[:2], ("z", 2**32 - 1, 7, 1)]}, "has the field z at bytes 4294967295 to"),
        ({"fields": [*FIELDS[:2], ("z", 8, 7, 2)]}, "has 2 values in the field z, expected 1"),
        ({"fields": [*FIELDS, ("label", 12, 5, 1)]}, "has the field label at bytes 12 to 16"),
        ({"width": 5}, "has 48 bytes of data, expected at least 52 for 5 x 1 points"),
        ({"width": 2**32 - 1, "height": 2**32 - 1, "row_step": 2**32 - 1}, "has row_step 4294967295, exp"),
        ({"width": 2**32 - 1}, "has 48 bytes of data, expected at least 51539607532"),
        ({"height": 2}, "has 48 bytes of data, expected at least 88 for 4 x 2 points"),
        ({"height": 2, "row_step": 24}, "has row_step 24, expected at least 4 points of 12 bytes"),
        ({"width": 0}, r"holds no points \(0 x 1\)"),
        ({"height": 0}, r"holds no points \(4 x 0\)"),
        ({"data": np.zeros(0, np.uint8)}, "has 0 bytes of data, expected at least 40"),
    ],
)
def test_what_does_not_hold_what_it_says_is_told(changes, told):
    maker = Maker(2)
    fields = changes.pop("fields", FIELDS) if "fields" in changes else FIELDS
    with pytest.raises(ScanError, match=told):
        cloud_points(maker.cloud(np.ones((4, 3)), fields, **changes))
