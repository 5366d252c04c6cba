"""Learning that goes on: scans join or wait, concepts keep names and identities, and files keep it all."""

from __future__ import annotations

import copy
import json
import re

import numpy as np
import pytest
from sklearn.metrics import adjusted_rand_score

from model_file_examples import described_objects, differences, fitted_model, forge, refusal
from shapeconcepts import (
    DescribedObject,
    Filtration,
    Scan,
    ShapeConceptModel,
    datasets,
    describe,
    load_model,
    segment,
)
from shapeconcepts.cli.learning_on import is_new, known_scans
from shapeconcepts.descriptors import Description
from shapeconcepts.descriptors.registry import get_descriptor
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.report.html import write_report
from test_cli_learn import run

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


@pytest.fixture(scope="module")
def simulated():
    scans = datasets.simulate(n_per_category=24, random_state=1, categories=("ball", "plate", "teddy"))
    return [describe(segment(scan), n_occlusions=1) for scan in np.random.default_rng(0).permutation(scans)]


def test_in_parts_is_as_at_once(simulated):
    at_once = ShapeConceptModel().fit(simulated)
    in_parts, one_by_one = ShapeConceptModel(), ShapeConceptModel().fit(simulated[:12])
    for part in np.array_split(np.arange(len(simulated)), 5):
        in_parts.partial_fit([simulated[i] for i in part])
    for one in simulated[12:]:
        one_by_one.partial_fit([one])
    for model in (in_parts, one_by_one):
        assert len(model.labels_) == len(model.scan_names_) == model.stimuli_.shape[0] == len(simulated)
        model.consolidate()
        assert adjusted_rand_score(at_once.labels_, model.labels_) >= 0.9
        assert model.scan_names_ == at_once.scan_names_
        assert [update.n_after for update in model.history_][-1] == len(simulated)


def test_a_scan_joins_its_concept_and_what_is_new_waits(simulated):
    known = [one for one in simulated if one.label != "plate"]
    plates = [one for one in simulated if one.label == "plate"]
    model = ShapeConceptModel().fit(known[:40])
    sizes = [concept.size for concept in model.concepts_]
    expected = int(model.predict(known[40:41], unknown_rate=0.05)[0])
    model.partial_fit(known[40:41])
    assert model.labels_[40] == expected
    assert len(model.labels_) == 41
    if expected >= 0:
        sizes[expected] += 1
        assert 40 in model.concepts_[expected].members
    assert [concept.size for concept in model.concepts_] == sizes
    model.partial_fit(plates[:1])
    assert model.labels_[41] == -1
    assert 41 in model.pool_
    assert model.history_ == ()
    # Answers do not stop for that.
    assert model.recognise(plates[1:3]).p_values.shape == (2,)
    assert model.transform(plates[1:3]).shape == (2, len(model.concepts_))


def test_a_kind_is_born_with_an_identity_of_its_own(simulated):
    known = [one for one in simulated if one.label != "plate"]
    plates = [one for one in simulated if one.label == "plate"]
    model = ShapeConceptModel().fit(known)
    keys = {concept.key for concept in model.concepts_}
    for one in plates[:15]:
        model.partial_fit([one])
    is_plate = np.array([label == "plate" for label in model.scan_labels_])
    born = [concept for concept in model.concepts_ if is_plate[concept.members].mean() > 0.5]
    assert born
    assert born[0].key not in keys
    changes = [change for update in model.history_ for change in update.changes]
    assert ("born", born[0].key) in {(change.kind, change.key) for change in changes}
    # Whoever was there and is no more is accounted for.
    ended = {change.key for change in changes if change.kind in ("merged", "dissolved")}
    assert keys <= {concept.key for concept in model.concepts_} | ended


def test_names_and_identities_live_through_updates_and_files(tmp_path):
    model = fitted_model()
    name_of = {concept.key: concept.name for concept in model.concepts_}
    assert sorted(name_of) == list(range(len(name_of)))
    model.partial_fit(described_objects(8, seed=3)).consolidate()
    for concept in model.concepts_:
        assert concept.name == name_of.get(concept.key, "")
    assert len(model.history_) == 1
    model.save(tmp_path / "model")
    loaded = load_model(tmp_path / "model")
    assert differences(model, loaded) == []
    assert loaded.history_ == model.history_
    more = described_objects(4, seed=4)
    assert differences(model.partial_fit(more).consolidate(), loaded.partial_fit(more).consolidate()) == []


def test_saving_looks_at_all_scans_first(tmp_path):
    model = fitted_model()
    model.partial_fit(described_objects(1, seed=3)[:2])
    assert len(model.filtration_.labels_) < len(model.labels_)
    model.save(tmp_path / "model")
    assert len(load_model(tmp_path / "model").labels_) == len(model.filtration_.labels_) == 42


def test_a_scan_that_cannot_be_described_is_skipped():
    model = fitted_model()
    with pytest.warns(UserWarning, match="1 of 2 scans are skipped"):
        model.partial_fit([Scan(np.full((5, 3), np.nan), name="bad"), described_objects(1)[0]])
    assert 40 in model.skipped_
    model.consolidate()
    assert model.labels_[40] == -1
    assert len(model.labels_) == 42


def test_the_first_call_is_fit():
    objects = described_objects(6)
    first, fitted = ShapeConceptModel().partial_fit(objects), ShapeConceptModel().fit(objects)
    np.testing.assert_array_equal(first.labels_, fitted.labels_)
    assert first.history_ == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda _, d: d.update(concept_keys=[0] * len(d["concept_keys"])), "concept_keys"),
        (lambda _, d: d.update(n_identities=1), "concept_keys"),
        (lambda _, d: d.update(n_identities="3"), "n_identities"),
        (lambda _, d: d.update(history={}), "history must be a list"),
        (lambda _, d: d.update(history=[[1, 2, []]]), "history must hold updates"),
        (lambda _, d: d["history"][0].__setitem__(0, 99), "history must tell"),
        (lambda _, d: d["history"][0].__setitem__(2, [["gone", 0, [], 1, 1]]), "history must hold changes"),
        (lambda _, d: d["history"][0].__setitem__(2, [["born", 999, [], 1, 1]]), "history must hold changes"),
        (lambda _, d: d["history"][0].__setitem__(3, [[999, 0, 0]]), "history must hold scans"),
        (lambda _, d: d["history"][0].__setitem__(3, [[0, "0", 0]]), "history must hold scans"),
        (lambda _, d: d["history"][0].__setitem__(3, [[0, -2, 0]]), "history must hold scans"),
    ],
)
def test_forged_identities(tmp_path, change, message):
    model = fitted_model()
    model.partial_fit(described_objects(8, seed=3)).save(tmp_path / "sound")
    assert message in refusal(forge(tmp_path / "sound", tmp_path / "forged", change))


@pytest.mark.parametrize("forged", [(1 << 9) | 1, (1 << 7) | (1 << 12)])
def test_forged_constellations(tmp_path, forged):
    fitted_model().save(tmp_path / "sound")

    def change(tensors, _):
        constellations = tensors["prototypes.constellations"]
        constellations[np.flatnonzero(constellations == 3)[0]] = forged

    assert "prototypes.constellations" in refusal(forge(tmp_path / "sound", tmp_path / "forged", change))


def write_scans(folder, n_per_category, seed, categories=("ball", "teddy")):
    for scan in datasets.simulate(n_per_category, categories=categories, random_state=seed):
        path = folder / str(scan.label) / f"{seed}_{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    return folder


def test_learn_update(tmp_path):
    old, new = write_scans(tmp_path / "old", 10, 1), write_scans(tmp_path / "new", 4, 2)
    model, report = tmp_path / "m.safetensors", tmp_path / "report.html"
    assert run("learn", old, "--model", model).exit_code == 0
    assert run("info", model, "--name", "0=first").exit_code == 0
    result = run("learn", "--update", model, new, "--report", report, "--json")
    assert result.exit_code == 0, result.output
    assert "8 scans joined 20" in result.stderr
    assert json.loads(result.stdout)["n_scans"] == 28
    learned = load_model(model)
    assert len(learned.labels_) == 28
    assert "first" in [concept.name for concept in learned.concepts_]
    assert report.exists()
    # Scans that are known count once, and are shown.
    newest = write_scans(tmp_path / "newest", 1, 4)
    for path in [*old.rglob("*.pcd"), *newest.rglob("*.pcd")]:
        target = tmp_path / "all" / path.relative_to(path.parents[1])
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(path.read_bytes())
    options = ("--model", tmp_path / "shown", "--report", report)
    assert "20 of 22 scans" in run("learn", "--update", model, tmp_path / "all", *options).stderr
    embedded = re.search(r'id="contents">(.*?)</script>', report.read_text("utf-8"), re.S)
    assert embedded
    previews = json.loads(embedded[1])["scans"]["previews"]
    assert [one is not None for one in previews] == [True] * 20 + [False] * 8 + [True] * 2
    # The same again is nothing new; and another file can be written to.
    again = run("learn", "--update", model, new)
    assert again.exit_code == 1
    assert "none of the scans is new" in " ".join(again.stderr.split())
    newer = write_scans(tmp_path / "newer", 2, 3)
    assert run("learn", "--update", model, newer, new, "--model", tmp_path / "other").exit_code == 0
    assert len(load_model(tmp_path / "other").labels_) == 32
    assert len(load_model(model).labels_) == 28


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--update", "m", "scans", "--preset", "paper"), "is for a new model"),
        (("--update", "m", "scans", "--levels", "3"), "is for a new model"),
        (("--update", "m"), "needs new scans"),
        (("scans",), "say where to write the model"),
    ],
)
def test_update_options_that_do_not_fit(tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    write_scans(tmp_path / "scans", 1, 1)
    (tmp_path / "m").write_bytes(b"")
    result = run("learn", *arguments)
    assert result.exit_code == 2
    assert message in " ".join(result.output.replace("│", " ").split())


def test_other_cuts_and_copies_do_not_see_scans_that_come_later():
    model = fitted_model()
    other = model.at_granularity(0.9)
    other.partial_fit(described_objects(1, seed=3)[:3])
    for one in (model, copy.copy(model)):
        assert max(concept.members.max() for concept in one.concepts_) < len(one.labels_) == 40


def test_cuts_of_one_tree_share_no_identities_of_different_groups(tmp_path):
    model = fitted_model()
    groups: dict[int, bytes] = {}
    for granularity in (0.02, 0.99, 0.02, 0.3):
        cut = model.at_granularity(granularity)
        for concept in cut.concepts_:
            assert groups.setdefault(concept.key, concept.members.tobytes()) == concept.members.tobytes()
        cut.save(tmp_path / "cut")
        load_model(tmp_path / "cut")


def test_names_of_other_groups_are_carried_over():
    model = fitted_model()
    for group in range(len(model.concept_tree_.parents)):
        [concept] = model.filtration_._concepts_of([group])
        concept.name = concept.name or f"group of {concept.size}"
    before = {name for _, name in model.filtration_._group_names()}
    assert before
    model.partial_fit(described_objects(2, seed=3)).consolidate()
    after = {name for _, name in model.filtration_._group_names()}
    assert after and after <= before


def test_what_looks_at_all_scans_does_so_with_scans_that_wait(tmp_path):
    for look in (
        lambda model: model.transform_tree(),
        lambda model: write_report(tmp_path / "r.html", model, [None] * len(model.labels_)),
        lambda model: model.concepts_at(0.2),
        lambda model: model.at_granularity(0.2),
    ):
        model = fitted_model()
        model.partial_fit(described_objects(1, seed=3)[:2])
        look(model)
        assert len(model.filtration_.labels_) == 42


def test_an_update_that_fails_leaves_the_model_as_it_was(monkeypatch):
    model = fitted_model()

    def fail(*_):
        raise MemoryError

    with monkeypatch.context() as patched:
        patched.setattr(Filtration, "fit", fail)
        with pytest.raises(MemoryError):
            model.partial_fit(described_objects(8, seed=3))
    assert len(model.labels_) == model.stimuli_.shape[0] == len(model.scan_names_) == 40
    assert len(model.partial_fit(described_objects(8, seed=3)).labels_) == 72


def test_stages_of_ones_own_are_refused_before_anything_joins():
    class OwnFiltration(Filtration):
        pass

    class OwnEnsemble:
        def fit(self, X):
            return self

    model = fitted_model()
    model.filtration_.__class__ = OwnFiltration
    model.partial_fit(described_objects(1, seed=3)[:1])
    model.ensemble_ = OwnEnsemble()
    with pytest.raises(ValueError, match="learning on needs a MotifHierarchyEnsemble"):
        model.partial_fit(described_objects(1, seed=3)[:1])
    assert len(model.labels_) == 41


def test_later_kinds_find_room_however_many_prototypes_there_are():
    objects = described_objects(10)
    kinds = [[one for i, one in enumerate(objects) if i % 4 == kind] for kind in range(4)]
    model = ShapeConceptModel().set_params(ensemble__max_columns=8).fit([*kinds[0], *kinds[1]])
    n = len(model.ensemble_.columns_)
    model.partial_fit([*kinds[2], *kinds[3]]).consolidate()
    assert len(model.ensemble_.columns_) > n


def test_where_all_are_far_apart_more_than_a_sample_is_kept(tmp_path):
    model = ShapeConceptModel(descriptor="distance").set_params(ensemble__max_columns=8)
    n_bins = get_descriptor("distance").n_bins
    padded = [
        DescribedObject(Description(np.eye(n_bins)[[number]]), name=str(number))
        for number in range(min(12, n_bins))
    ]
    model.fit(padded).save(tmp_path / "model")
    assert not model.ensemble_.hierarchies_.is_thinned
    names = model.ensemble_.get_feature_names_out().tolist()
    loaded = load_model(tmp_path / "model").partial_fit(padded[:3]).consolidate()
    assert loaded.ensemble_.get_feature_names_out()[: len(names)].tolist() == names


def test_the_same_scan_twice_is_new_once():
    model = fitted_model()
    known, [new] = known_scans(model), described_objects(1, seed=5)[:1]
    assert [is_new(new, known), is_new(new, known)] == [True, False]
    assert not is_new(described_objects(10)[3], known)


def test_a_model_that_was_learned_anew_keeps_identities_and_names(simulated, tmp_path):
    named = [
        DescribedObject(one.description, one.segment_edges, f"scan{i}", one.label, one.occlusions)
        for i, one in enumerate(simulated)
    ]
    earlier = ShapeConceptModel().fit(named[:50])
    for concept in earlier.concepts_:
        concept.name = f"kind {concept.key}"
    anew = ShapeConceptModel().fit([*named[50:], *named[:50]]).take_identities(earlier)
    at = anew.labels_[len(named) - 50 :]
    for concept in earlier.concepts_:
        inside = at[concept.members]
        most = np.bincount(inside[inside >= 0]).argmax()
        if (inside == most).mean() > 0.5 and (
            earlier.labels_[at == most] == earlier.labels_[concept.members[0]]
        ).mean() > 0.5:
            assert anew.concepts_[most].key == concept.key
            assert anew.concepts_[most].name == concept.name
    keys = [concept.key for concept in anew.concepts_]
    assert len(set(keys)) == len(keys)
    assert anew.n_identities_ > max(keys)
    assert anew.history_[-1].n_before == 50
    assert anew.history_[-1].n_after == len(named)
    anew.save(tmp_path / "anew")
    assert [one.key for one in load_model(tmp_path / "anew").concepts_] == keys
    with pytest.raises(ValueError, match="earlier must be a model of some of the same scans"):
        anew.take_identities(ShapeConceptModel().fit(simulated))


def test_learning_anew_on_the_command_line_keeps_names(tmp_path):
    for number, scan in enumerate(datasets.simulate(8, categories=("ball", "box"))):
        write_pcd(tmp_path / f"{scan.label}_{number}.pcd", scan)
    files, old, new = sorted(tmp_path.glob("*.pcd")), tmp_path / "old", tmp_path / "new"
    assert run("learn", *files[:4], *files[8:12], "--model", old, "--no-cache").exit_code == 0
    assert run("info", old, "--name", "0=first").exit_code == 0
    done = run("learn", *files, "--model", new, "--identities-of", old, "--no-cache")
    assert done.exit_code == 0, done.output
    assert "first (key 0)" in done.output
    assert [one.name for one in load_model(new).concepts_ if one.key == 0] == ["first"]
    done = run("learn", files[5], "--update", old, "--identities-of", old)
    assert done.exit_code == 2
    assert "is for a new model" in done.output
