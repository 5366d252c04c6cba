"""The sample of very many scans that a report shows, and that what it counts are all of them."""

import warnings
from collections import Counter

import networkx
import numpy as np
import pytest

from report_models import WITHOUT_CONCEPTS, ball, grouped_stimuli, model_of
from report_reader import Reader
from shapeconcepts import Filtration, ShapeConceptModel
from shapeconcepts.report.html import class_counts, preview, shown_scans, write_report
from shapeconcepts.report.html.contents import report_contents

WAYS = [("divergence", "persistence"), ("divergence", "annexations"), ("geodesic", "annexations")]


def many_scans(**parameters: str) -> ShapeConceptModel:
    """Concepts of very different size among 400 scans; some equal, skipped, alone or without a place."""
    rows, labels = grouped_stimuli(1000, 5)
    kept = np.sort(
        np.concatenate([np.arange(g, 1000, 5)[:size] for g, size in enumerate((200, 100, 60, 24, 9))])
    )
    rows, labels = rows[kept], [labels[i] for i in kept]
    rows, labels = np.vstack([rows, rows[:3], np.zeros((4, 30))]), [*labels, *labels[:3], *[None] * 4]
    # Stimuli that nothing else has.
    rows = np.hstack([rows, np.zeros((400, 6))])
    rows[range(20, 80, 10)] = np.eye(36)[30:]
    return model_of(rows, labels, skipped={398: "too small", 399: "too far"}, **parameters)


def show(monkeypatch: pytest.MonkeyPatch, n_most: int, least: int = 4) -> None:
    monkeypatch.setattr("shapeconcepts.report.html.shown_scans.MOST_SHOWN", n_most)
    monkeypatch.setattr("shapeconcepts.report.html.shown_scans.LEAST_MEMBERS", least)


def meeting_times(n: int, edges: np.ndarray, times: np.ndarray, of: list[int]) -> np.ndarray:
    """When each two of some vertices of a tree are in one class: the latest edge of the path."""
    tree = networkx.Graph()
    tree.add_nodes_from(range(n))
    tree.add_weighted_edges_from((a, b, t) for (a, b), t in zip(edges.tolist(), times.tolist(), strict=True))
    assert networkx.is_tree(tree)
    met = np.zeros((len(of), len(of)))
    for row, start in enumerate(of):
        latest = {start: 0.0}
        for a, b in networkx.bfs_edges(tree, start):
            latest[b] = max(latest[a], tree[a][b]["weight"])
        met[row] = [latest[other] for other in of]
    return met


@pytest.mark.parametrize(("heat", "stop"), WAYS)
@pytest.mark.parametrize("n_most", [12, 60, 399])
def test_those_shown_meet_when_they_meet_among_all(monkeypatch, heat, stop, n_most):
    model = many_scans(heat=heat, stop=stop)
    show(monkeypatch, n_most)
    shown, filtration = shown_scans.shown_scans(model), model.filtration_
    n_vertices = len(filtration.space_.multiplicities_)
    is_between = shown_scans.between_concepts(filtration)
    # On the page, what is between concepts enters after all else or never.
    late = np.where(is_between, 1.0, 0.0)
    among_all = meeting_times(
        n_vertices, filtration.edges_, filtration.times_ + late, shown.vertices.tolist()
    )
    u = len(shown.vertices)
    here = meeting_times(u, shown.edges, shown.times + np.where(shown.is_between, 1.0, 0.0), list(range(u)))
    assert np.array_equal(here, among_all)
    assert np.all(np.diff(shown.times) >= 0)
    assert np.array_equal(
        np.append(shown.vertices, -1)[shown.vertex_of_scan], filtration.space_.vertices_[shown.scans]
    )


@pytest.mark.parametrize(("heat", "stop"), WAYS)
def test_the_tree_is_a_contraction(monkeypatch, heat, stop):
    model = many_scans(heat=heat, stop=stop)
    show(monkeypatch, 50)
    shown, filtration = shown_scans.shown_scans(model), model.filtration_
    is_between = shown_scans.between_concepts(filtration)
    _, goes_with = shown_scans._contracted(filtration, is_between, shown.vertices)
    tree = networkx.Graph(filtration.edges_.tolist())
    cells = [set(np.flatnonzero(goes_with == i).tolist()) for i in range(len(shown.vertices))]
    for cell, vertex in zip(cells, shown.vertices.tolist(), strict=True):
        assert cell & set(shown.vertices.tolist()) == {vertex}
        assert networkx.is_connected(tree.subgraph(cell))
    contracted = networkx.quotient_graph(tree, cells, relabel=True)
    assert sorted(sorted(edge) for edge in contracted.edges) == sorted(shown.edges.tolist())
    sizes = filtration.space_.multiplicities_
    assert shown.stands_for.tolist() == [int(sizes[sorted(cell)].sum()) for cell in cells]


def test_each_concept_has_its_share_and_its_medoid(monkeypatch):
    model = many_scans()
    show(monkeypatch, 160, least=10)
    shown = shown_scans.shown_scans(model).scans
    assert np.all(np.diff(shown) > 0) and not set(shown) & set(model.skipped_)
    usable = 400 - len(model.skipped_)
    assert 150 <= len(shown) <= 160
    sizes, members = Counter(model.labels_.tolist()), Counter(model.labels_[shown].tolist())
    assert len(model.concepts_) == 5
    for number, concept in enumerate(model.concepts_):
        assert concept.medoid in shown
        assert members[number] >= min(10, sizes[number])
        assert members[number] <= max(10, np.ceil(160 * sizes[number] / usable))
    assert members[0] / members[1] == pytest.approx(sizes[0] / sizes[1], rel=0.1)
    # Those without a place, and those alone, count for themselves.
    is_placed = model.filtration_.space_.vertices_[shown] >= 0
    assert (~is_placed).sum() >= 1 and ((model.labels_[shown] < 0) & is_placed).sum() >= 1


def test_of_more_concepts_than_can_have_64_each_has_its_share():
    strata, drawn = np.repeat(np.arange(-1, 29), 10), np.random.default_rng(0).permutation(300)
    chosen = shown_scans._smallest_draws(strata, drawn, 100)
    assert np.bincount(strata[chosen] + 1).tolist() == [3] * 30
    for stratum in range(-1, 29):
        smallest = np.sort(drawn[strata == stratum])[:3]
        assert np.array_equal(np.sort(drawn[chosen][strata[chosen] == stratum]), smallest)
    # Even fewer than one of each: then it is one.
    chosen = shown_scans._smallest_draws(strata, drawn, 10)
    assert np.bincount(strata[chosen] + 1).tolist() == [1] * 30


def test_the_sample_follows_from_the_scans_and_not_from_their_order(monkeypatch):
    rows, labels = grouped_stimuli(300, 4)
    show(monkeypatch, 80)
    names = [f"{i}" for i in range(300)]
    order = np.random.default_rng(1).permutation(300)
    one = model_of(rows, labels, names)
    other = model_of(rows[order], [labels[i] for i in order], [names[i] for i in order])
    chosen = [{m.scan_names_[i] for i in shown_scans.shown_scans(m).scans} for m in (one, other)]
    assert chosen[0] == chosen[1] and 60 < len(chosen[0]) <= 80


def test_what_a_scan_draws_does_not_depend_on_how_many_there_are():
    rows = grouped_stimuli(300, 4)[0]
    drawn = []
    for n in (200, 300):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            space = Filtration().fit(rows[:n]).space_
        drawn.append(shown_scans._draws_of_scans(space, np.arange(n)))
    assert np.array_equal(drawn[0], drawn[1][:200])
    assert len(np.unique(drawn[1])) > 295


def test_equal_scans_are_not_taken_all_or_none(monkeypatch):
    rows, labels = grouped_stimuli(600, 2)
    rows[200:400:2] = rows[0]
    model = model_of(rows, labels)
    show(monkeypatch, 120)
    own = model.labels_ == model.labels_[0]
    shown = shown_scans.shown_scans(model).scans
    is_copy = (rows == rows[0]).all(axis=1)
    expected = 0.2 * (own & is_copy).sum()
    assert abs(is_copy[shown].sum() - expected) < 4 * np.sqrt(expected)


@pytest.mark.parametrize(("heat", "stop"), WAYS)
def test_what_is_counted_are_all_scans(monkeypatch, heat, stop):
    model = many_scans(heat=heat, stop=stop)
    previews = [preview(ball(seed=i), 10) for i in range(8)] * 50
    whole = report_contents(model, previews, [], "", {})
    show(monkeypatch, 60)
    part = report_contents(model, previews, [], "", {})
    assert len(whole["scans"]["names"]) == 400 and 40 < len(part["scans"]["names"]) <= 60
    assert len(part["concepts"]) == len(whole["concepts"]) > 1
    for of_part, of_whole in zip(part["concepts"], whole["concepts"], strict=True):
        assert {k: v for k, v in of_part.items() if k != "members"} == {
            k: v for k, v in of_whole.items() if k != "members"
        }
        assert of_whole["size"] == len(of_whole["members"]) > len(of_part["members"])
        # In the same order, the medoid first.
        names = [whole["scans"]["names"][i] for i in of_whole["members"]]
        own_names = [part["scans"]["names"][i] for i in of_part["members"]]
        assert own_names == [name for name in names if name in set(own_names)]
        assert own_names[0] == names[0]
    for key in ("counts", "groups", "labels", "skipped"):
        assert part[key] == whole[key]
    for key in ("axisEnds", "stepEnds", "stepCounts", "classCounts", "conceptTime", "nBetween", "minSize"):
        assert part["filtration"][key] == whole["filtration"][key]
    assert part["counts"]["scans"] == 400 and len(part["skipped"]) == 2 and part["scans"]["skipped"] == []
    assert part["counts"]["mute"] == 2
    counts = part["counts"]
    assert counts["inConcepts"] + counts["loners"] + counts["mute"] == 398
    # What is told of a scan or a vertex is what is told of it among all.
    where = [whole["scans"]["names"].index(name) for name in part["scans"]["names"]]
    for key in ("labels", "previews", "extents", "sides"):
        assert part["scans"][key] == [whole["scans"][key][i] for i in where]
    for key in ("heat", "joins", "equal"):
        for vertex, i in zip(part["scans"]["vertices"], where, strict=True):
            if vertex >= 0:
                old = whole["scans"]["vertices"][i]
                assert part["filtration"][key][vertex] == whole["filtration"][key][old]


@pytest.mark.parametrize("kind", WITHOUT_CONCEPTS)
def test_models_without_concepts(monkeypatch, kind):
    show(monkeypatch, 1)
    n = len(WITHOUT_CONCEPTS[kind])
    contents = report_contents(model_of(WITHOUT_CONCEPTS[kind]), [None] * n, [], "", {})
    assert len(contents["scans"]["names"]) == 1 and contents["counts"]["scans"] == n


@pytest.mark.parametrize(("heat", "stop"), WAYS)
def test_classes_at_all_times(monkeypatch, heat, stop):
    model = many_scans(heat=heat, stop=stop)
    monkeypatch.setattr(class_counts, "_STEPS", 20)
    show(monkeypatch, 30)
    filtration = report_contents(model, [None] * 400, [], "", {})["filtration"]
    told = filtration["classCounts"]
    assert len(told["times"]) <= 23
    is_between = shown_scans.between_concepts(model.filtration_)
    sizes = model.filtration_.space_.multiplicities_
    scale = class_counts.TimeScale(filtration["axisEnds"] and tuple(filtration["axisEnds"]))
    for time in [*scale.times(np.arange(21) / 20)[1:], filtration["conceptTime"]]:
        enters = ~is_between & (model.filtration_.times_ <= time)
        graph = networkx.Graph()
        graph.add_nodes_from(range(len(sizes)))
        graph.add_edges_from(model.filtration_.edges_[enters].tolist())
        classes = [int(sizes[list(one)].sum()) for one in networkx.connected_components(graph)]
        row = int(np.searchsorted(told["times"], time, side="right")) - 1
        groups = sum(size >= filtration["minSize"] for size in classes)
        assert told["classes"][row] == len(classes) and told["groups"][row] == groups
        assert told["largest"][row] == max(classes)


def test_the_page_says_so(browser, tmp_path, monkeypatch):
    model = many_scans()
    show(monkeypatch, 120)
    n_shown = len(shown_scans.shown_scans(model).scans)
    write_report(tmp_path / "r.html", model, [preview(ball(), 50)] * 400)
    reader = Reader(browser, tmp_path / "r.html")
    page = reader.page
    assert f"Shown are {n_shown} of 398 scans, drawn in proportion" in page.locator("#sample").inner_text()
    facts = [fact.split() for fact in page.locator(".fact").all_inner_texts()]
    in_concepts = int((model.labels_ >= 0).sum())
    assert [int(fact[0]) for fact in facts] == [400, 5, in_concepts, 398 - in_concepts, 2]
    largest = model.concepts_[0]
    card = page.locator("article", has_text=f"of {largest.size} shown")
    assert card.locator("dd").first.text_content() == str(largest.size)
    n_own = int((model.labels_[shown_scans.shown_scans(model).scans] == 0).sum())
    assert card.locator("p", has_text="shown").text_content() == f"{n_own} of {largest.size} shown"
    page.evaluate("document.querySelectorAll('.more').forEach(button => button.click())")
    assert page.locator("#concepts canvas.scan, #outside canvas.scan").count() == n_shown
    slider, said = page.locator("input[type=range]"), page.locator("output")
    slider.fill("0")
    reader.settle()
    n_places = len(model.filtration_.space_.multiplicities_)
    assert f"{n_places} classes" in said.inner_text()
    slider.fill("1")
    reader.settle()
    assert f"the largest has {largest.size}" in said.inner_text()
    assert reader.complaints == []


def test_a_page_that_shows_all_says_nothing(browser, tmp_path):
    rows, labels = grouped_stimuli(60, 4)
    write_report(tmp_path / "r.html", model_of(rows, labels), [None] * 60)
    reader = Reader(browser, tmp_path / "r.html")
    assert reader.page.locator("#sample").count() == 0
    assert "shown" not in reader.page.locator("main").inner_text()
