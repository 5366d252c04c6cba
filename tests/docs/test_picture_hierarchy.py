"""Pictures of motif hierarchies: what is shown, where, in which colour."""

from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from learned_planes import Given, count, plane
from PIL import Image

from pictures import draw_hierarchy
from pictures.hierarchy_excerpt import excerpt_of
from pictures.hierarchy_layout import RING, vertex_places
from pictures.word_colours import word_colours
from shapeconcepts.descriptors import describe
from shapeconcepts.motifs import MotifHierarchyEnsemble, SegmentDictionary
from shapeconcepts.report.canvas import WHITE, blend
from shapeconcepts.segmentation.segmented_object import SegmentedObject

STEP = (0xC2, 0x25, 0x4C)
CENTRES = [(600.0, 800.0 - 200 * level) for level in range(12)]


def learned(
    objects: list[SegmentedObject], descriptor: Given, n_levels: int, columns: str = "prototypes"
) -> MotifHierarchyEnsemble:
    return MotifHierarchyEnsemble(SegmentDictionary(n_levels), columns).fit(
        [describe(one, descriptor) for one in objects]
    )


def random_ensemble(
    seed: int, n_objects: int = 12, columns: str = "prototypes"
) -> tuple[MotifHierarchyEnsemble, list[SegmentedObject], Given]:
    rng = np.random.default_rng(seed)
    objects = []
    for k in range(n_objects):
        n_segments = int(rng.integers(1, 6))
        edges = [pair for pair in combinations(range(n_segments), 2) if rng.random() < 0.6]
        objects.append(plane(n_segments, edges, f"object_{k}"))
    descriptor = Given({one.name: rng.dirichlet(np.ones(4), one.n_segments) for one in objects})
    return learned(objects, descriptor, 2, columns), objects, descriptor


def slow_levels(one: SegmentedObject) -> list[set[frozenset[int]]]:
    """New constellations of each motif level, from the definition."""
    levels = [
        {frozenset([s]) for s in range(one.n_segments)},
        {frozenset(pair) for pair in one.segment_edges.tolist()},
    ]
    while levels[-1]:
        seen = set().union(*levels)
        levels.append({a | b for a, b in combinations(levels[-1], 2) if a & b} - seen)
    return levels[:-1]


def slow_propagation(
    ensemble: MotifHierarchyEnsemble, one: SegmentedObject, descriptor: Given, level: int
) -> tuple[set, set]:
    """Links and steps of an object as pairs of (sorted words)."""
    words = ensemble.dictionary_.transform(descriptor.histograms[one.name])[:, level - 1].tolist()

    def motif(constellation: frozenset[int]) -> tuple[int, ...]:
        return tuple(sorted(words[s] for s in constellation))

    levels = slow_levels(one)
    links = {frozenset([motif({a}), motif({b})]) for a, b in one.segment_edges.tolist()}
    for constellations in levels[1:]:
        links |= {frozenset([motif(a), motif(b)]) for a, b in combinations(constellations, 2) if a & b}
    steps = set()
    for lower, upper in pairwise(levels):
        for a, b in combinations(lower, 2):
            if a | b in upper and (len(a) == 1 or a & b):
                steps |= {(motif(a), motif(a | b)), (motif(b), motif(a | b))}
    return links, steps


@pytest.mark.parametrize("seed", range(8))
def test_links_and_steps_agree_with_the_definition(seed: int) -> None:
    ensemble, objects, descriptor = random_ensemble(seed)
    known = ensemble.hierarchies_
    for level in (1, 2):
        parts = [slow_propagation(ensemble, one, descriptor, level) for one in objects]
        for one, (own_links, own_steps) in zip(objects[:4], parts, strict=False):
            excerpt = excerpt_of(ensemble, one, level, 1000, descriptor=descriptor)
            shown = {vertex for row in excerpt.rows for vertex in row}
            level_of = {known.motif(v): known.motif_levels[v] for v in shown}

            def visible_links(links: set, level_of: dict = level_of) -> set:
                return {
                    link
                    for link in links
                    if all(m in level_of for m in link) and len({level_of[m] for m in link}) == 1
                }

            def visible_steps(steps: set, level_of: dict = level_of) -> set:
                return {(a, b) for a, b in steps if b in level_of and level_of[a] < level_of[b]}

            def motifs(pairs: set) -> list:
                return [(known.motif(a), known.motif(b)) for a, b in pairs]

            assert {frozenset(pair) for pair in motifs(excerpt.own_links)} == visible_links(own_links)
            assert set(motifs(excerpt.own_steps)) == visible_steps(own_steps)
            all_links = set().union(*(links for links, _ in parts))
            all_steps = set().union(*(steps for _, steps in parts))
            assert {frozenset(pair) for pair in motifs(excerpt.links)} == visible_links(all_links)
            assert set(motifs(excerpt.steps)) == visible_steps(all_steps)


@pytest.mark.parametrize("columns", ["prototypes", "motifs"])
@pytest.mark.parametrize("seed", range(3))
def test_stimuli_are_those_of_the_explanation_at_every_level(columns: str, seed: int) -> None:
    ensemble, objects, descriptor = random_ensemble(seed, 20)
    ensemble.set_params(columns=columns, bandwidth=0.3)
    ensemble.fit([describe(one, descriptor) for one in objects])
    known, n_stimuli = ensemble.hierarchies_, 0
    for one in objects[:6]:
        motifs = ensemble.explain(describe(one, descriptor)).motifs
        words = ensemble.dictionary_.transform(descriptor.histograms[one.name])
        for level in (1, 2):
            expected: dict[tuple[int, ...], float] = {}
            for motif in motifs:
                if columns == "prototypes" or motif.dictionary_level == level:
                    key = tuple(sorted(words[list(motif.segments), level - 1].tolist()))
                    expected[key] = max(motif.stimulus, expected.get(key, 0.0))
            excerpt = excerpt_of(ensemble, one, level, 1000, descriptor=descriptor)
            assert {known.motif(v): stimulus for v, stimulus in excerpt.stimulus_of.items()} == expected
            assert excerpt.stimulus_of.keys() <= excerpt.activated
            assert all(known.dictionary_levels[v] == level for v in excerpt.stimulus_of)
            n_stimuli += len(expected)
    assert n_stimuli > 30


def test_activated_vertices_come_first_and_the_rest_is_counted() -> None:
    ensemble, objects, descriptor = random_ensemble(3, 30, columns="motifs")
    known = ensemble.hierarchies_
    for one in objects[:10]:
        excerpt = excerpt_of(ensemble, one, 2, 4, descriptor=descriptor)
        fired = {
            m.vertex: m.stimulus
            for m in ensemble.explain(describe(one, descriptor)).motifs
            if m.dictionary_level == 2
        }
        assert excerpt.stimulus_of == fired
        assert fired.keys() <= excerpt.activated
        assert excerpt.n_unknown == 0  # the object is one of those that were learned
        at_level_2 = known.dictionary_levels == 2
        assert sum(excerpt.n_vertices) + excerpt.n_above == at_level_2.sum()
        assert sum(excerpt.n_activated) == len(excerpt.activated)
        for level, row in enumerate(excerpt.rows):
            assert len(row) == min(4, excerpt.n_vertices[level])
            assert (known.motif_levels[row] == level + 1).all()
            n_own = min(4, excerpt.n_activated[level])
            assert [vertex in excerpt.activated for vertex in row] == [k < n_own for k in range(len(row))]
            assert (np.diff(known.support[row[n_own:]]) <= 0).all()


@pytest.mark.parametrize("n_shown", [1, 5, 18, 30])
def test_vertices_stand_apart_and_the_activated_ones_in_the_middle(n_shown: int) -> None:
    ensemble, objects, descriptor = random_ensemble(7, 60)
    for one in objects[:6]:
        excerpt = excerpt_of(ensemble, one, 2, n_shown, descriptor=descriptor)
        place = vertex_places(excerpt, CENTRES[: len(excerpt.rows)])
        assert place.keys() == {vertex for row in excerpt.rows for vertex in row}
        assert len(set(place.values())) == len(place)
        own = [abs(x - 600) for vertex, (x, _) in place.items() if vertex in excerpt.activated]
        others = [abs(x - 600) for vertex, (x, _) in place.items() if vertex not in excerpt.activated]
        assert not others or max(own) < min(others)
        for (x, y), centre in ((place[v], CENTRES[k]) for k, row in enumerate(excerpt.rows) for v in row):
            assert ((x - centre[0]) / RING[0]) ** 2 + ((y - centre[1]) / RING[1]) ** 2 < 1 + 1e-9


def plates(picture: Image.Image) -> Image.Image:
    """The part of the picture without title, labels and legend."""
    return picture.crop((150, 60, 1086, picture.height))


def two_words() -> tuple[MotifHierarchyEnsemble, dict[str, SegmentedObject], Given]:
    a, b = np.array([0.9, 0.1]), np.array([0.1, 0.9])
    objects = [
        plane(1, [], "a"),
        plane(1, [], "a2"),
        plane(1, [], "b"),
        plane(2, [(0, 1)], "ab"),
        plane(2, [(0, 1)], "ab2"),
        plane(2, [(0, 1)], "bb"),
    ]
    histograms = {"a": [a], "a2": [a], "b": [b], "ab": [a, b], "ab2": [b, a], "bb": [b, b]}
    descriptor = Given({name: np.array(rows) for name, rows in histograms.items()})
    return learned(objects, descriptor, 1), {one.name: one for one in objects}, descriptor


def test_only_what_the_object_activates_is_strong(tmp_path: Path) -> None:
    ensemble, objects, descriptor = two_words()
    [of_a, of_b] = word_colours(ensemble.dictionary_)[0]
    word_a = int(ensemble.dictionary_.transform([[0.9, 0.1]])[0, 0])
    if word_a == 1:
        of_a, of_b = of_b, of_a
    disc = np.pi * 15.5**2

    path = tmp_path / "a.png"
    alone = plates(draw_hierarchy(ensemble, objects["a"], 1, path, descriptor=descriptor))
    assert plates(Image.open(path)) == alone
    assert count(alone, of_a) == pytest.approx(disc, rel=0.15)
    assert count(alone, of_b) == 0
    assert count(alone, STEP) == 0
    # b alone, both slices of (b, b) and half of (a, b), less the white lines.
    assert count(alone, blend(of_b, WHITE, 0.62)) == pytest.approx(2.5 * disc, rel=0.2)

    both = plates(draw_hierarchy(ensemble, objects["ab"], 1, descriptor=descriptor))
    assert count(both, of_a) == pytest.approx(1.5 * disc, rel=0.2)
    assert count(both, of_b) == pytest.approx(1.5 * disc, rel=0.2)
    assert count(both, blend(of_b, WHITE, 0.62)) == pytest.approx(disc, rel=0.2)
    # Two lines, each from one level to the next.
    assert count(both, STEP) > 2 * 100


def test_the_object_has_the_colours_of_its_words() -> None:
    ensemble, objects, descriptor = two_words()
    colours = [np.array(colour) for colour in word_colours(ensemble.dictionary_)[0]]
    picture = draw_hierarchy(ensemble, objects["ab"], 1, descriptor=descriptor)
    y = 56 + 140
    words = ensemble.dictionary_.transform(descriptor.histograms["ab"])[:, 0]
    for x, word in ((1126 + 80, words[0]), (1126 + 200, words[1])):
        pixel = np.array(picture.getpixel((x, y)), float)
        alike = [pixel @ c / np.linalg.norm(pixel) / np.linalg.norm(c) for c in colours]
        assert np.argmax(alike) == word
        assert max(alike) > 0.998


@pytest.mark.filterwarnings("ignore:.*different segment descriptions")
def test_one_object_of_one_segment_and_an_object_without_a_known_motif() -> None:
    one, pair = plane(1, [], "one"), plane(3, [(0, 1), (1, 2)], "unlike " * 60)
    descriptor = Given({"one": np.array([[0.5, 0.5]]), pair.name: np.full((3, 2), 0.5)})
    ensemble = learned([one], descriptor, 2)
    [colour] = word_colours(ensemble.dictionary_)[1]
    for segmented, n_unknown in ((one, 0), (pair, 3)):
        picture = draw_hierarchy(ensemble, segmented, 2, descriptor=descriptor, n_vertices=1)
        assert picture.width == 1434
        assert count(plates(picture), colour) == pytest.approx(np.pi * 15.5**2, rel=0.15)
        assert excerpt_of(ensemble, segmented, 2, 1, descriptor=descriptor).n_unknown == n_unknown

    of_pairs = MotifHierarchyEnsemble(ensemble.dictionary_).fit([describe(pair, descriptor)])
    lost = Given({"lost": np.array([[0.5, 0.5]])})
    assert draw_hierarchy(of_pairs, plane(1, [], "lost"), 1, descriptor=lost).width == 1434


@pytest.mark.parametrize(
    ("level", "n_vertices", "message"),
    [
        (0, 18, "dictionary_level must be between 1 and 1, got 0"),
        (2, 18, "dictionary_level must be between 1 and 1, got 2"),
        (1, 0, "n_vertices must be between 1 and 30, got 0"),
        (1, 31, "n_vertices must be between 1 and 30, got 31"),
    ],
)
def test_bad_parameters_are_named(level: int, n_vertices: int, message: str) -> None:
    ensemble, objects, descriptor = two_words()
    with pytest.raises(ValueError, match=message):
        draw_hierarchy(ensemble, objects["a"], level, descriptor=descriptor, n_vertices=n_vertices)


def test_another_descriptor_is_refused() -> None:
    ensemble, objects, _ = two_words()
    with pytest.raises(ValueError, match=r"3 features.*2 features"):
        draw_hierarchy(ensemble, objects["a"], 1, descriptor=Given({"a": np.ones((1, 3))}))
    with pytest.raises(ValueError, match=r"descriptor must be one of .*, got 'sift'"):
        draw_hierarchy(ensemble, objects["a"], 1, descriptor="sift")


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_stimuli_of_prototypes_are_shown_at_their_motifs(seed: int) -> None:
    ensemble, objects, descriptor = random_ensemble(seed)
    assert ensemble.columns == "prototypes"
    for one in objects[:4]:
        explanation = ensemble.explain(describe(one, descriptor))
        strongest = max(motif.stimulus for motif in explanation.motifs)
        for level in (1, 2):
            excerpt = excerpt_of(ensemble, one, level, 20, descriptor=descriptor)
            assert excerpt.stimulus_of.keys() <= excerpt.activated
            assert max(excerpt.stimulus_of.values()) == pytest.approx(strongest), "its own prototypes"
            for motif in explanation.motifs:
                if motif.dictionary_level == level:
                    assert excerpt.stimulus_of[motif.vertex] >= motif.stimulus - 1e-12
