"""Pictures of explanations: constellations, stimuli, prototypes."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from shapeconcepts.descriptors import Description, describe
from shapeconcepts.motifs import (
    Explanation,
    FiredMotif,
    MotifHierarchyEnsemble,
    SegmentDictionary,
    SimilarPrototype,
)
from shapeconcepts.report import draw_explanation
from shapeconcepts.report.canvas import Canvas
from shapeconcepts.segmentation.segmented_object import SegmentedObject

VOXEL = 0.005
ORANGE, BLUE = (0xE0, 0x86, 0x34), (0x35, 0x68, 0xDB)
GREY = (0xD5, 0xD7, 0xDB)
ROW, TITLE, THUMB = 168, 84, 128
PROTOTYPES = 24 + THUMB + 16 + 250 + 16


@dataclass(frozen=True)
class Given:
    """A descriptor whose histograms are given for each object by name."""

    histograms: dict[str, np.ndarray]

    def describe(self, segmented: SegmentedObject) -> Description:
        return Description(self.histograms[segmented.name])


def halves(name: str) -> SegmentedObject:
    """A plane that faces the camera: segment 0 is its left half."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(12) - 5.5, np.arange(12) - 5.5))
    labels = (x > 0).astype(np.int32)
    return SegmentedObject(
        points=np.stack([x * VOXEL, y * VOXEL, np.ones(144)], axis=1),
        normals=np.tile([0.0, 0.0, -1.0], (144, 1)),
        patch_labels=labels,
        segment_labels=labels,
        segment_edges=np.array([[0, 1]], np.int32),
        n_segments=2,
        point_to_voxel=np.arange(144, dtype=np.int32),
        voxel_size=VOXEL,
        viewpoint=np.zeros(3),
        name=name,
    )


def fired(segments: tuple[int, ...], stimulus: float, level: int = 1, n_closest: int = 2) -> FiredMotif:
    return FiredMotif(
        column=0,
        vertex=0,
        name=f"d{level} m{len(segments)} " + " ".join(f"w{s}" for s in segments),
        dictionary_level=level,
        motif_level=len(segments),
        words=segments,
        stimulus=stimulus,
        segments=segments,
        n_prototypes=9,
        closest=tuple(SimilarPrototype(k, f"seen_{k}", segments, 0.01 * k) for k in range(n_closest)),
    )


def explained(*motifs: FiredMotif) -> Explanation:
    return Explanation(motifs=motifs, n_constellations=3, n_unknown=(0, 1))


def share_of(picture: Image.Image, box: tuple[int, int, int, int], colour: tuple[int, int, int]) -> float:
    """Share of a part of the picture that is a shade of a colour; white is no shade."""
    pixels = np.asarray(picture.crop(box)).astype(float) + 1e-3
    direction = np.array(colour) / np.linalg.norm(colour)
    alike = pixels @ direction > 0.9985 * np.linalg.norm(pixels, axis=2)
    return float((alike & (pixels.min(axis=2) < 250)).mean())


def halves_of_thumb(left: float, top: float, size: int) -> list[tuple[int, int, int, int]]:
    """The inner parts of the left and right half of the plane."""
    x, y, edge = int(left), int(top), round(0.1 * size)
    middle = size // 2
    return [
        (x + edge, y + edge, x + middle - 6, y + size - edge),
        (x + middle + 6, y + edge, x + size - edge, y + size - edge),
    ]


SEEN = [halves(f"seen_{k}") for k in range(5)]


def test_each_row_shows_its_constellation_and_its_prototypes(tmp_path: Path) -> None:
    explanation = explained(fired((0,), 0.9), fired((1,), 0.5), fired((0, 1), 0.2))
    path = tmp_path / "why.png"
    picture = draw_explanation(explanation, halves("mug"), SEEN, path)
    assert Image.open(path).size == picture.size == (PROTOTYPES + 5 * 144 + 24, TITLE + 3 * ROW + 24)
    for row, segments in enumerate([{0}, {1}, {0, 1}]):
        top = TITLE + row * ROW
        for segment, box in enumerate(halves_of_thumb(24, top + 18, THUMB)):
            assert share_of(picture, box, ORANGE) == (1 if segment in segments else 0)
            assert share_of(picture, box, GREY) == (0 if segment in segments else 1)
        for position in range(2):
            thumb = halves_of_thumb(PROTOTYPES + position * 144 + 7, top + 8, THUMB - 14)
            for segment, box in enumerate(thumb):
                assert share_of(picture, box, BLUE) == (1 if segment in segments else 0)
        third = (PROTOTYPES + 2 * 144, top + 4, picture.width, top + ROW - 4)
        assert set(np.asarray(picture.crop(third)).ravel()) == {255}


def test_bars_are_as_long_as_the_stimuli() -> None:
    stimuli = [1.0, 0.75, 0.4]
    motifs = [fired(s, a) for s, a in zip([(0,), (1,), (0, 1)], stimuli, strict=True)]
    picture = np.asarray(draw_explanation(explained(*motifs), halves("mug"), SEEN))
    lengths = []
    for row in range(3):
        line = picture[TITLE + row * ROW + 30, 24 + THUMB + 16 + 60 : PROTOTYPES - 10]
        lengths.append((line == ORANGE).all(axis=1).sum())
    np.testing.assert_allclose(np.array(lengths) / lengths[0], stimuli, atol=0.02)


def test_a_constellation_has_one_row_and_rows_are_limited() -> None:
    motifs = [fired((0,), 0.9, 2), fired((0,), 0.8, 1), fired((1,), 0.7, 2), fired((0, 1), 0.6, 1)]
    for n_motifs, n_rows in ((1, 1), (2, 2), (6, 3)):
        picture = draw_explanation(explained(*motifs), halves("mug"), SEEN, n_motifs=n_motifs)
        assert picture.height == TITLE + n_rows * ROW + 24
    box = halves_of_thumb(24, TITLE + ROW + 18, THUMB)[1]
    assert share_of(picture, box, ORANGE) == 1


def test_training_objects_may_be_missing() -> None:
    explanation = explained(fired((0,), 0.9))
    full = draw_explanation(explanation, halves("mug"), SEEN)
    for missing in (None, [], SEEN[:1]):
        picture = draw_explanation(explanation, halves("mug"), missing)
        assert picture.size == full.size
        thumbs = [halves_of_thumb(PROTOTYPES + k * 144 + 7, TITLE + 8, THUMB - 14)[0] for k in range(2)]
        assert [share_of(picture, box, BLUE) for box in thumbs] == [1 if missing else 0, 0]
        names = (PROTOTYPES, TITLE + THUMB - 5, picture.width, TITLE + ROW - 4)
        assert picture.crop(names) == full.crop(names)


def test_nothing_fired_is_said() -> None:
    unknown = Explanation(motifs=(), n_constellations=3, n_unknown=(3, 3))
    unlike = Explanation(motifs=(), n_constellations=3, n_unknown=(1, 3))
    pictures = [draw_explanation(one, halves("mug"), SEEN) for one in (unknown, unlike)]
    assert pictures[0].size == pictures[1].size
    assert pictures[0] != pictures[1]
    for picture in pictures:
        for box in halves_of_thumb(24, TITLE, THUMB):
            assert share_of(picture, box, GREY) == 1
        words = np.asarray(picture.crop((24 + THUMB + 16, TITLE, 600, TITLE + THUMB)))
        assert (words < 128).any()


def words_of(explanation: Explanation, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What a picture says."""
    said: list[str] = []
    original = Canvas.text

    def noted(self: Canvas, at: tuple[float, float], text: str, *rest: object, **options: object) -> float:
        said.append(text)
        return original(self, at, text, *rest, **options)

    monkeypatch.setattr(Canvas, "text", noted)
    draw_explanation(explanation, halves("mug"))
    monkeypatch.undo()
    return said


def test_words_of_motifs_and_of_single_prototypes(monkeypatch: pytest.MonkeyPatch) -> None:
    motifs = [fired((0,), 0.9, 2), fired((0,), 0.8, 1)]
    said = words_of(explained(*motifs), monkeypatch)
    assert "2 motifs fired, by 1 of its 3 constellations" in said
    assert "dictionary level 2, motif level 1" in said and "also at dictionary level 1" in said

    without_words = replace(fired((1,), 0.5), words=(), dictionary_level=0, name="d0", vertex=-1)
    by_prototypes = replace(explained(fired((0, 1), 0.9, 2), without_words), columns="prototypes")
    said = words_of(by_prototypes, monkeypatch)
    assert "2 of its 3 constellations remind of training objects" in said
    assert "shared at dictionary level 2" in said and "reminds of 9 prototypes" in said
    assert "no words in common" in said
    assert not any("fired" in text or "level 0" in text or text == "d0" for text in said)

    said = words_of(replace(explained(), columns="prototypes"), monkeypatch)
    assert "None of its constellations is near enough to one of the training objects." in said


def test_a_real_explanation_with_long_and_empty_names() -> None:
    histograms = np.array([[0.8, 0.2, 0.0], [0.1, 0.3, 0.6]])
    names = ["folder/" * 60 + "scan.pcd", "", "line\nbreak"]
    objects = [halves(name) for name in names]
    descriptor = Given({name: histograms + 0.01 * k for k, name in enumerate(names)})
    described = [describe(one, descriptor) for one in objects]
    ensemble = MotifHierarchyEnsemble(SegmentDictionary(1)).fit(described)
    for one in objects:
        picture = draw_explanation(ensemble.explain(describe(one, descriptor)), one, objects)
        assert picture.height == TITLE + 3 * ROW + 24
        assert (np.asarray(picture)[:, -20:] == 255).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"n_motifs": 0}, "n_motifs must be at least 1, got 0"),
        ({"n_prototypes": 6}, "n_prototypes must be between 0 and 5, got 6"),
        ({"training_objects": SEEN[::-1]}, r"training_objects\[0\] must be 'seen_0'.*got 'seen_4'"),
        ({"training_objects": [replace(SEEN[0], n_segments=1)]}, r"training_objects\[0\] must be 'seen_0'"),
        ({"segmented": replace(halves("mug"), n_segments=1)}, "with at least 2 segments, got 1"),
    ],
)
def test_bad_parameters_are_named(change: dict, message: str) -> None:
    arguments = {"segmented": halves("mug"), "training_objects": SEEN}
    with pytest.raises(ValueError, match=message):
        draw_explanation(explained(fired((0, 1), 0.5)), **{**arguments, **change})
