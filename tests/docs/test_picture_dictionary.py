"""Pictures of dictionaries: tree, words, examples."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from learned_planes import Given, count, plane
from PIL import Image

from pictures import draw_dictionary
from pictures.word_colours import word_colours
from pictures.word_examples import word_examples
from shapeconcepts.descriptors import describe
from shapeconcepts.motifs import SegmentDictionary
from shapeconcepts.report.highlighting import draw_highlighted
from shapeconcepts.segmentation.segmented_object import SegmentedObject


def stripes(n_segments: int, name: str) -> SegmentedObject:
    """Segments in a row, each the neighbour of the next."""
    return plane(n_segments, list(pairwise(range(n_segments))), name)


def trained(n_objects: int, n_levels: int, seed: int = 0) -> tuple:
    rng = np.random.default_rng(seed)
    objects = [stripes(1 + k % 3, f"object_{k}") for k in range(n_objects)]
    descriptor = Given({one.name: rng.dirichlet(np.ones(5), one.n_segments) for one in objects})
    rows = [
        describe(one, descriptor).description.histograms(1 << np.arange(one.n_segments)) for one in objects
    ]
    return SegmentDictionary(n_levels).fit(np.concatenate(rows)), objects, descriptor


def shades(picture: Image.Image, colours: list[tuple[int, int, int]]) -> list[int]:
    """Number of pixels that are a shade of each colour."""
    pixels = np.asarray(picture)
    pixels = pixels[(pixels[..., 0] < 240) | (pixels[..., 1] < 240) | (pixels[..., 2] < 240)] + 1e-3
    lengths = np.sqrt(np.einsum("ij,ij->i", pixels, pixels))
    return [int((pixels @ c > 0.998 * np.linalg.norm(c) * lengths).sum()) for c in np.array(colours)]


def test_every_word_has_its_disc_and_more_levels_make_a_larger_tree(tmp_path: Path) -> None:
    dictionary, _, _ = trained(20, 3)
    heights = []
    for n_levels in (1, 2, 3):
        path = tmp_path / f"{n_levels}.png"
        picture = draw_dictionary(dictionary, path=path, n_levels=n_levels)
        assert Image.open(path).size == picture.size
        for level, colours in enumerate(word_colours(dictionary)):
            for colour in colours:
                # Most of a disc of radius 12; its number covers a part.
                assert (count(picture, colour) > 200) == (level < n_levels)
        heights.append(picture.height)
    assert heights[0] < heights[1] < heights[2]
    assert draw_dictionary(dictionary, n_levels=5).size == draw_dictionary(dictionary, n_levels=3).size


def contains(picture: Image.Image, part: Image.Image) -> bool:
    pixels, wanted = np.asarray(picture), np.asarray(part)
    middle = len(wanted) // 2
    rows = np.lib.stride_tricks.sliding_window_view(pixels, (1, part.width, 3))[:, :, 0, 0]
    places = np.argwhere((rows == wanted[middle]).all(axis=(2, 3)))
    return any(
        np.array_equal(pixels[y - middle : y - middle + part.height, x : x + part.width], wanted)
        for y, x in places
    )


@pytest.mark.parametrize("seed", range(3))
def test_examples_are_shown_in_the_colour_of_their_word(seed: int) -> None:
    dictionary, objects, descriptor = trained(8, 1, seed)
    picture = draw_dictionary(dictionary, objects, descriptor=descriptor, n_examples=2)
    examples = word_examples(dictionary, objects, descriptor, 1, 2)[0]
    for word, colour in enumerate(word_colours(dictionary)[0]):
        for index, segment in examples[word]:
            shown = draw_highlighted(objects[index], {segment: colour}, size=76)
            assert contains(picture, shown)
            assert shades(shown, [colour])[0] > 0.7 * (0.85 * 76) ** 2 / objects[index].n_segments
    assert {segment for of_word in examples for _, segment in of_word} != {0}


def test_examples_are_the_closest_members() -> None:
    dictionary, objects, descriptor = trained(30, 3, seed=5)
    origin = [(index, segment) for index, one in enumerate(objects) for segment in range(one.n_segments)]
    examples = word_examples(dictionary, objects, descriptor, 3, 4)
    for level in range(3):
        for word, centre in enumerate(dictionary.words_[level]):
            distances = {
                origin[row]: np.linalg.norm(
                    np.sqrt(descriptor.histograms[objects[origin[row][0]].name][origin[row][1]])
                    - np.sqrt(centre)
                )
                for row in dictionary.members(level + 1, word).tolist()
            }
            assert examples[level][word] == sorted(distances, key=distances.__getitem__)[:4]


def test_four_levels_with_examples() -> None:
    dictionary, objects, descriptor = trained(40, 4)
    picture = draw_dictionary(dictionary, objects, descriptor=descriptor, n_levels=4, n_examples=1)
    assert 16 * 130 < picture.width < 16 * 160
    for colours in word_colours(dictionary):
        assert min(shades(picture, colours)) > 600


def test_one_segment_gives_one_word_a_level() -> None:
    with pytest.warns(UserWarning, match="1 of 4 words"):
        dictionary = SegmentDictionary(2).fit(np.ones((1, 5)) / 5)
    one = stripes(1, "a name that is much longer than any picture of it " * 5)
    descriptor = Given({one.name: np.ones((1, 5))})
    picture = draw_dictionary(dictionary, [one], descriptor=descriptor)
    colours = word_colours(dictionary)
    assert colours[0] == colours[1]
    assert shades(picture, colours[0])[0] > 2 * 0.8 * (0.9 * 76) ** 2


def hue(colour: tuple[int, int, int]) -> float:
    """Hue in OKLab (Ottosson 2020), degrees."""
    coded = np.array(colour) / 255
    linear = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    to_cones = [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
    cones = np.cbrt(to_cones @ linear)
    a = [1.9779984951, -2.4285922050, 0.4505937099] @ cones
    b = [0.0259040371, 0.7827717662, -0.8086714460] @ cones
    return float(np.degrees(np.arctan2(b, a)))


def test_words_of_a_level_differ() -> None:
    dictionary, _, _ = trained(40, 4)
    for colours in word_colours(dictionary):
        distances = [np.abs(np.subtract(a, b)).sum() for a in colours for b in colours if a is not b]
        assert min(distances) > 25


def test_hues_follow_the_tree() -> None:
    dictionary, _, _ = trained(40, 4)
    colours = word_colours(dictionary)
    for level in range(1, 4):
        for word, parent in enumerate(dictionary.parents_[level]):
            turn = (hue(colours[level][word]) - hue(colours[level - 1][parent]) + 180) % 360 - 180
            first = word == 0 or dictionary.parents_[level][word - 1] != parent
            # A quarter of the parent's part of the circle to either side; colours that no screen has are cut.
            assert turn == pytest.approx((-1 if first else 1) * 90 / 2**level, abs=12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"n_levels": 0}, "n_levels must be between 1 and 5, got 0"),
        ({"n_levels": 6}, "n_levels must be between 1 and 5, got 6"),
        ({"n_examples": 0}, "n_examples must be at least 1, got 0"),
        ({"objects": []}, "with 12 segments, got 0 objects with 0 segments"),
        (
            {"descriptor": Given({f"object_{k}": np.ones((3, 4))[: 1 + k % 3] for k in range(6)})},
            "the 5 bins",
        ),
    ],
)
def test_bad_parameters_are_named(change: dict, message: str) -> None:
    dictionary, objects, descriptor = trained(6, 2)
    with pytest.raises(ValueError, match=message):
        draw_dictionary(dictionary, **{"objects": objects, "descriptor": descriptor, **change})
