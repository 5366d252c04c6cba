"""Content that does not fit is refused even under a checksum that is right: kernels do not check bounds."""

import json
import random
import re
from pathlib import Path

import numpy as np
import pytest

from model_file_examples import described_objects, differences, forge, refusal
from shapeconcepts import ModelError, load_model
from shapeconcepts.model_file.layout import LAYOUT


@pytest.fixture(params=["default", "like_the_paper"])
def sound(request):
    return request.getfixturevalue(request.param)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model"


def put(name, position, value):
    return lambda tensors, description: tensors[name].__setitem__(position, value)


def longer(name):
    return lambda tensors, _: tensors.update({name: np.concatenate([tensors[name], tensors[name][-1:]])})


@pytest.mark.parametrize("name", sorted(LAYOUT))
def test_shapes_and_types(sound, path, name):
    assert "misses the tensor" in refusal(forge(sound, path, lambda tensors, _: tensors.pop(name)))
    other = "int32" if LAYOUT[name][0] == "int64" else "int64"
    forge(sound, path, lambda tensors, _: tensors.update({name: tensors[name].astype(other)}))
    assert f"tensor {name} must be {LAYOUT[name][0]}, is {other}" in refusal(path)
    forge(sound, path, lambda tensors, _: tensors.update({name: tensors[name][None, None]}))
    assert "impossible shape" in refusal(path)
    if not nothing_is_in(name, sound):
        refusal(forge(sound, path, longer(name)))
    # Of edges, fewer may be as right.
    if name != "motifs.edges":
        refusal(forge(sound, path, lambda tensors, _: tensors.update({name: tensors[name][:0]})))


@pytest.mark.parametrize("name", sorted(LAYOUT))
def test_extreme_values(sound, path, name):
    if nothing_is_in(name, sound):
        pytest.skip("responses by divergence have no components")
    kind = LAYOUT[name][0]
    if kind.startswith("int"):
        values = [np.iinfo(kind).min, np.iinfo(kind).max, -2]
    else:
        values = [-np.inf, {"float64": -1e300, "float32": -1e30, "float16": -1e4}[kind]]
        # What is not tested has no p-value.
        values += [] if name == "filtration.p_values" else [np.nan]
        values += [] if name == "concepts.deaths" else [np.inf]
    for value in values:
        for position in (0, -1):
            assert f"tensor {name} must" in refusal(forge(sound, path, put(name, position, value)))


def nothing_is_in(name, sound):
    description = load_description(sound)
    return name == "response.whitening" and description["stages"]["response"]["distance"] != "mahalanobis"


def swap_first_columns_of_stimuli(tensors, description):
    tensors["stimuli.columns"][[0, 1]] = tensors["stimuli.columns"][[1, 0]]


def repeat_first_column_of_stimuli(tensors, description):
    tensors["stimuli.columns"][1] = tensors["stimuli.columns"][0]


def lengths_that_overflow(tensors, description):
    # In sum, modulo 2 ** 64, they are right.
    tensors["stimuli.row_lengths"][:4] += 2**62


def cycle(tensors, description):
    # Two edges close a triangle, and so another vertex is left out.
    leaf = np.flatnonzero(np.bincount(tensors["space.edges"].ravel()) == 1)[0]
    at_leaf = np.flatnonzero((tensors["space.edges"] == leaf).any(axis=1))[0]
    tensors["space.edges"][at_leaf] = tensors["space.edges"][at_leaf - 1]


def join_two_vertices(tensors, description):
    vertices = tensors["space.vertices"]
    vertices[vertices == vertices.max()] = 0
    tensors["space.edges"] = tensors["space.edges"][:-1]
    tensors["space.divergences"] = tensors["space.divergences"][:-1]
    tensors["space.edges"][:] = np.array([(0, i + 1) for i in range(len(tensors["space.edges"]))])
    n_edges = len(tensors["space.edges"])
    tensors["filtration.order"] = np.arange(n_edges)
    tensors["filtration.times"] = tensors["filtration.times"][:n_edges]
    tensors["filtration.p_values"] = tensors["filtration.p_values"][:n_edges]


def unused_concept(tensors, description):
    tensors["concepts.labels"][tensors["concepts.labels"] == 1] = 0


def skip_another(tensors, description):
    description["skipped"].append([5, "no reason"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("dictionary.level_sizes", 0, 0), "dictionary.level_sizes must hold numbers from 1"),
        (put("dictionary.level_sizes", 0, 3), "dictionary.level_sizes must sum to"),
        (put("dictionary.parents", 0, 1), "dictionary.parents must hold words of the level above"),
        (put("dictionary.clusters", (0, 0), 2), "dictionary.clusters must hold words of each level"),
        (put("dictionary.words", (0, 0), 1.5), "dictionary.words must hold numbers from 0"),
        (put("motifs.dictionary_levels", 0, 4), "motifs.dictionary_levels must hold numbers from 1 to 3"),
        (put("motifs.motif_levels", 0, 17), "motifs.motif_levels must hold numbers from 1 to 16"),
        (put("motifs.words", (0, -1), -1), "motifs.words must hold rising words"),
        (put("motifs.words", (0, -1), 8), "motifs.words must hold rising words"),
        (put("motifs.words", (0, 0), 5), "motifs.words must hold rising words"),
        (put("motifs.words", slice(None), -1), "motifs.words must hold rising words"),
        (lambda t, d: t["motifs.words"].__setitem__(3, t["motifs.words"][0]), "motifs.words must"),
        (put("motifs.edges", 0, (1, 0)), "motifs.edges must hold rising pairs"),
        (longer("motifs.edges"), "motifs.edges must hold sorted pairs, each once"),
        (longer("dictionary.clusters"), "prototypes.constellations must hold"),
        (lambda t, d: t["space.edges"].__setitem__(slice(2), t["space.edges"][1::-1]), "sorted pairs"),
        (put("prototypes.histograms", (0, 0), 0.9), "prototypes.histograms must hold rows of sum 1 or 0"),
        (put("prototypes.objects", 0, 1), "prototypes.objects must rise from 0 to 38"),
        (put("prototypes.objects", -1, 37), "prototypes.objects must rise from 0 to 38"),
        (put("prototypes.constellations", 0, 0), "prototypes.constellations must hold numbers from 1"),
        (put("prototypes.constellations", 0, 2**16), "prototypes.constellations must hold numbers from 1"),
        (
            lambda t, d: t["prototypes.motifs"].__setitem__(0, t["prototypes.motifs"][0, ::-1]),
            "each dictionary",
        ),
        (put("stimuli.row_lengths", 0, -1), "stimuli.row_lengths must hold numbers from 0 to"),
        (lengths_that_overflow, "stimuli.row_lengths must hold numbers from 0 to"),
        (put("stimuli.row_lengths", 2, 1), "stimuli.row_lengths must sum to"),
        (lambda t, d: d["skipped"].clear(), "prototypes.objects must rise from 0 to 39"),
        (skip_another, "prototypes.objects must hold numbers from 0 to 37"),
        (put("stimuli.columns", 0, -1), "stimuli.columns must hold numbers from 0 to"),
        (
            lambda t, d: t["stimuli.columns"].__setitem__(-1, len(t["stimuli.sources"])),
            "stimuli.columns must hold numbers from 0 to",
        ),
        (swap_first_columns_of_stimuli, "stimuli.columns must hold rising columns in each row"),
        (repeat_first_column_of_stimuli, "stimuli.columns must hold rising columns in each row"),
        (put("stimuli.values", 0, 0.0), "stimuli.values must hold positive numbers"),
        (put("stimuli.values", 0, 1.01), "stimuli.values must hold numbers from 0 to 1"),
        (put("stimuli.values", 0, np.nan), "stimuli.values must hold numbers from 0 to 1"),
        (put("space.vertices", 2, 0), "space.vertices must hold -1 for empty rows"),
        (put("space.vertices", 0, -1), "space.vertices must hold -1 for empty rows"),
        (cycle, "space.edges must be a tree"),
        (join_two_vertices, "space.vertices must give one vertex to equal rows only"),
        (lambda t, d: t.update({"space.edges": t["space.edges"][:, ::-1]}), "the smaller vertex first"),
        (put("space.edges", 0, (0, 0)), "space.edges must be a tree"),
        (put("space.divergences", 0, 1.01), "space.divergences must hold numbers from 0 to 1"),
        (put("concepts.labels", 2, 0), "concepts.labels must hold -1 for empty rows"),
        (unused_concept, "concepts.labels must name all of the"),
        (put("concepts.medoids", 0, 2), "concepts.medoids must hold a member of each concept"),
        (put("concepts.births", 0, 1.01), "concepts.births must hold numbers from 0 to 1"),
        (put("concepts.deaths", 0, 0.0), "concepts.deaths must hold times from births on"),
        (put("filtration.order", 0, 1), "filtration.order must hold every edge of the tree once"),
        (put("filtration.times", 0, 0.0), "filtration.times must hold rising numbers above 0"),
        (put("filtration.times", 1, 0.0), "filtration.times must hold rising numbers above 0"),
        (put("filtration.p_values", 0, 1.01), "filtration.p_values must hold numbers from 0 to 1, or NaN"),
        (lambda t, d: d.update(group_names=5), "group_names must be a list"),
        (
            lambda t, d: d.update(group_names=[["x", 1]]),
            "group_names must hold numbers of groups",
        ),
    ],
)
def test_content_that_does_not_fit(sound, path, change, message):
    assert message in refusal(forge(sound, path, change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t, d: t["stimuli.sources"].__setitem__(0, t["stimuli.sources"][1]), "every column once"),
        (
            lambda t, d: t["stimuli.sources"].__setitem__(0, len(t["motifs.words"])),
            "stimuli.sources must hold numbers from 0 to",
        ),
        (put("response.whitening", (0, 0), 1e31), "response.whitening must hold numbers"),
        (
            lambda t, d: d["stages"]["ensemble"].update(columns="prototypes"),
            "stimuli.sources must hold",
        ),
    ],
)
def test_content_that_does_not_fit_columns_of_motifs(like_the_paper, path, change, message):
    assert message in refusal(forge(like_the_paper, path, change))


def swap_first_sources(tensors, description):
    tensors["stimuli.sources"][:2] = tensors["stimuli.sources"][[1, 0]]


@pytest.mark.parametrize(
    "change", [put("stimuli.sources", 0, 1), put("stimuli.sources", -1, 10**6), swap_first_sources]
)
def test_columns_of_prototypes_are_in_order(default, path, change):
    assert "stimuli.sources must hold" in refusal(forge(default, path, change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.update(granularity=None), "granularity must be a number where stop is 'persistence'"),
        (lambda d: d.update(granularity=0.0), "concepts.labels must name the groups at the granularity"),
        (lambda d: d.update(group_names=[[10**6, "x"]]), "group_names must name groups that are no concepts"),
        (lambda d: d.update(group_names=[[-1, "x"]]), "group_names must name groups that are no concepts"),
    ],
)
def test_granularity_and_names_that_do_not_fit(default, path, change, message):
    assert message in refusal(forge(default, path, lambda _, description: change(description)))


def answers(path: Path) -> list:
    loaded, objects = load_model(path), described_objects(2, seed=3)
    return [loaded.transform(objects), loaded.predict(objects), [loaded.explain(one) for one in objects]]


@pytest.mark.parametrize(
    ("stage", "name", "values"),
    [
        ("ensemble", "columns", ("motifs", "prototypes")),
        ("filtration", "heat", ("divergence", "geodesic")),
        ("filtration", "stop", ("persistence", "annexations")),
        ("response", "distance", ("divergence", "mahalanobis")),
    ],
)
def test_forged_parameters_are_refused_or_harmless(sound, path, stage, name, values):
    for value in values:
        forge(sound, path, lambda _, d, value=value: d["stages"][stage].update({name: value}))
        try:
            found = answers(path)
        except ModelError as error:
            assert value != stages_of(sound)[stage][name]
            assert re.search(r"stimuli.sources|granularity must be a number|heat must|whitening", str(error))
            continue
        assert found[0].shape[0] == len(found[1]) == 8
        loaded = load_model(path)
        loaded.filtration_.groups_at(0.5, 1)
        loaded.save(path)


@pytest.mark.parametrize("value", [None, "x"])
def test_concepts_without_their_time(sound, path, value):
    assert "concept_time must be" in refusal(forge(sound, path, lambda _, d: d.update(concept_time=value)))


NOT_JSON_OF_A_MODEL = [
    *[("scan_names", value) for value in (None, 5, "x", {}, [], ["x"] * 39 + [5])],
    *[("concept_names", value) for value in (None, 5, "x", {}, ["x", 5])],
    *[("scan_labels", value) for value in (None, [5] * 40, [[]] * 40, ["x"] * 39)],
    *[
        ("skipped", value)
        for value in (
            None, {}, [5], [[2]], [["2", "x"]], [[2, 5]], [[True, "x"]], [[-1, "x"]], [[40, "x"]],
            [[2, "x"], [2, "x"]], [[3, "x"], [2, "x"]], [[2.0, "x"]], [[i, ""] for i in range(40)],
        )
    ],
    *[("concept_time", value) for value in (None, -0.1, 1.1, "x", True, [], 10**400)],
    *[("epsilon_max", value) for value in (-0.1, 1.1, "x", True, [], 10**400)],
    *[("largest_divergence", value) for value in (None, 2, "0")],
    *[("stage", value) for value in (None, [], {}, {"descriptor": "fpfh"})],
    *[("more", 1)],
]  # fmt: skip


@pytest.mark.parametrize(("field", "value"), NOT_JSON_OF_A_MODEL)
def test_wrong_types_in_the_description(sound, path, field, value):
    key = "stages" if field == "stage" else field
    forge(sound, path, lambda _, description: description.update({key: value}))
    assert field in refusal(path)


def test_a_missing_field(sound, path):
    assert "misses the field skipped" in refusal(forge(sound, path, lambda _, d: d.pop("skipped")))


def stages_of(path: Path) -> dict[str, dict]:
    """All stages in a file by their place, with their parameters."""
    stages = load_description(path)["stages"]
    return {**stages, "dictionary": stages["ensemble"]["dictionary"]}


def put_parameter(stage: str, name: str, value: object):
    def change(_, description):
        stages = description["stages"]
        place = stages["ensemble"]["dictionary"] if stage == "dictionary" else stages[stage]
        place[name] = value

    return change


@pytest.mark.parametrize("value", [None, "x", [], {}, -1, 1e300, 2**31, 10**400, True, [1]])
def test_wrong_parameters(sound, path, value):
    for stage, parameters in stages_of(sound).items():
        if not isinstance(parameters, dict):
            continue
        for name in parameters:
            may_be_none = name in ("n_neighbours", "granularity") and value is None
            if (name == "leave_own_out" and value is True) or may_be_none:
                continue
            message = refusal(forge(sound, path, put_parameter(stage, name, value)))
            assert name in message or (name == "type" and stage in message)


@pytest.mark.parametrize("stage", ["segmenter", "ensemble", "dictionary", "filtration", "response"])
def test_stages_of_other_kinds(sound, path, stage):
    own = stages_of(sound)[stage]
    another = stages_of(sound)["response" if stage == "filtration" else "filtration"]
    for value in (5, "x", True, [], [None], {}, {**own, "more": 1}, {**own, "type": "Own"}, another):
        where, name = ("ensemble", "dictionary") if stage == "dictionary" else (None, stage)

        def change(_, description, where=where, name=name, value=value):
            stages = description["stages"]
            (stages[where] if where else stages)[name] = value

        assert stage in refusal(forge(sound, path, change))


@pytest.mark.parametrize("value", [None, 1, 7, 2**31 - 1])
def test_any_number_of_neighbours_is_harmless(sound, path, value):
    forge(sound, path, put_parameter("ensemble", "n_neighbours", value))
    loaded = load_model(path)
    assert loaded.transform(described_objects(2, seed=3)).shape == (8, len(loaded.concepts_))
    loaded.save(path)
    assert differences(loaded, load_model(path)) == []


@pytest.mark.parametrize(
    "value",
    [
        "own",
        None,
        5,
        [],
        {"type": "own"},
        {"type": []},
        {"type": "FPFH"},
        {"type": "FPFH", "radius": "0.03"},
        {"type": "FPFH", "radius": -0.03},
        {"type": "FPFH", "radius": 0.03, "more": 1},
        {"type": "Curvature"},
        {"type": "Curvature", "radius": 0},
        {"type": "Curvature", "radius": True},
        {"type": "Curvature", "scale": "metric"},
        {"type": "Surflet", "scale": "x"},
        {"type": "Surflet", "scale": []},
        {"type": "Joint", "descriptors": [], "normal_radius": 0.02},
        {"type": "Joint", "descriptors": [5], "normal_radius": 0.02},
        {"type": "Joint", "descriptors": [{"type": "FPFH", "radius": -1}], "normal_radius": 0.02},
        {"type": "Filtration"},
        {"radius": 0.03},
    ],
)
def test_wrong_descriptors(sound, path, value):
    forge(sound, path, lambda _, description: description["stages"].update(descriptor=value))
    refusal(path)


def load_description(path: Path) -> dict:
    content = path.read_bytes()
    header = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])
    return json.loads(header["__metadata__"]["shapeconcepts"])


def random_edit(source: random.Random, tensors: dict) -> None:
    """Change a few numbers of a tensor or two, many of them to others that occur."""
    for _ in range(source.choice([1, 1, 2])):
        numbers = tensors[source.choice(sorted(name for name in tensors if tensors[name].size))].reshape(-1)
        i, j = source.randrange(len(numbers)), source.randrange(len(numbers))
        how = source.randrange(4)
        if how == 0:
            numbers[i] = numbers[j]
        elif how == 1:
            numbers[[i, j]] = numbers[[j, i]]
        elif how == 2:
            numbers.view(np.uint8)[source.randrange(numbers.nbytes)] ^= 1 << source.randrange(8)
        else:
            numbers[i] += source.choice([-1, 1])


def test_forged_numbers_are_refused_or_harmless(sound, path):
    source = random.Random(1)
    objects = described_objects(1, seed=3)
    n_loaded = 0
    for _ in range(80):
        forge(sound, path, lambda tensors, _: random_edit(source, tensors))
        try:
            loaded = load_model(path)
        except ModelError:
            continue
        n_loaded += 1
        with np.errstate(all="ignore"):
            assert loaded.transform(objects).shape == (4, len(loaded.concepts_))
        assert loaded.predict(objects).max() < len(loaded.concepts_)
        loaded.explain(objects[3])
        loaded.filtration_.groups_at(0.5, 1)
        loaded.filtration_.graph()
        loaded.save(path)
        assert differences(loaded, load_model(path)) == []
    assert 8 < n_loaded < 72
