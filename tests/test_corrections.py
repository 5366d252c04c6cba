"""What a user says of a model's concepts: applied at once, undone, kept by files, updates and refits."""

from __future__ import annotations

import copy
import json
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from model_file_examples import described_objects, fitted_model
from shapeconcepts import ModelError, ShapeConceptModel, load_model
from shapeconcepts.corrections import JournalFile
from shapeconcepts.corrections.edit import Edit
from shapeconcepts.corrections.journal import Journal

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


@pytest.fixture(scope="module")
def fitted():
    return fitted_model()


@pytest.fixture
def model(fitted):
    return copy.deepcopy(fitted)


def state_of(model):
    """What the user sees of the concepts."""
    return (
        model.labels_.tolist(),
        [(one.key, one.name, one.members.tolist(), one.medoid) for one in model.concepts_],
        model.foreign_.tolist(),
        model.certain_.tolist(),
        model.links,
    )


def members(model, key):
    return next(one.members.tolist() for one in model.concepts_ if one.key == key)


def undo_all(model):
    while model._journal.last_done:
        model.undo()


def redo_all(model):
    while model._journal.last_undone:
        model.redo()


def test_without_edits_the_concepts_are_the_learned_ones_themselves(model):
    assert model.journal == model.links == ()
    assert all(a is b for a, b in zip(model.concepts_, model.filtration_.concepts_, strict=True))


def test_a_name_is_said_and_taken_back(model):
    key = model.concepts_[0].key
    edit = model.rename(model.concepts_[0], "mug")
    assert (edit.number, edit.kind, edit.text) == (1, "rename", "“concept of kind 0” is called “mug”")
    assert model.concepts_[0].name == "mug" and model.filtration_.concepts_[0].name == "concept of kind 0"
    assert model.get_feature_names_out()[0] == "mug"
    assert model.undo().is_undone and model.concepts_[0].name == "concept of kind 0"
    model.redo()
    model.rename(key, "")
    assert model.concepts_[0].name == "" and [edit.is_undone for edit in model.journal] == [False, False]


def test_merged_concepts_are_one_in_labels_and_responses(model):
    a, b = model.concepts_[3].key, model.concepts_[1].key
    both = sorted(members(model, a) + members(model, b))
    before = model.transform(described_objects(2, seed=5))
    edit = model.merge([a, b], "things")
    # The larger one keeps its key.
    assert edit.keys == (a, b) and members(model, b) == both
    assert model.concepts_[0].name == "things" and len(model.concepts_) == 3
    assert set(model.labels_[both].tolist()) == {0}
    after = model.transform(described_objects(2, seed=5))
    assert after.shape == (before.shape[0], 3)
    assert (model.predict(described_objects(2, seed=5))[[1, 3]] == model.labels_[[1, 3]]).all()
    model.undo()
    np.testing.assert_array_equal(model.transform(described_objects(2, seed=5)), before)


def test_some_scans_become_a_concept_and_go_back(model):
    one = model.concepts_[0]
    some = one.members[:4].tolist()
    edit = model.split(one, some)
    [new] = edit.made
    assert new == model.n_identities_ - 1 == 4
    assert members(model, new) == some and members(model, one.key) == one.members[4:].tolist()
    model.merge([one.key, new])
    assert members(model, one.key) == one.members.tolist()


def test_a_concept_falls_into_parts_along_the_tree(model):
    a, b = model.concepts_[0], model.concepts_[1]
    model.merge([a, b])
    edit = model.split(a.key if a.size >= b.size else b.key)
    parts = {tuple(members(model, key)) for key in (edit.keys[0], *edit.made)}
    # What was merged is what the tree holds apart.
    assert parts == {tuple(a.members.tolist()), tuple(b.members.tolist())}


def test_scans_are_moved_by_row_or_name_to_a_concept_or_a_new_one(model):
    target = model.concepts_[1].key
    model.move([0, "object 4"], target)
    assert {0, 4} <= set(members(model, target)) and model.certain_.tolist() == [0, 4]
    edit = model.move([0, 8, 9], name="odd ones")
    assert members(model, edit.made[0]) == [0, 8, 9] and 0 not in members(model, target)
    assert next(one for one in model.concepts_ if one.key == edit.made[0]).name == "odd ones"
    # A concept without any scan is gone, and is back when it gets one.
    model.move([0, 8, 9], target)
    assert edit.made[0] not in [one.key for one in model.concepts_]
    model.undo()
    assert members(model, edit.made[0]) == [0, 8, 9]


def test_foreign_scans_are_in_no_concept(model):
    model.mark_foreign([0, 5])
    assert model.foreign_.tolist() == [0, 5] and (model.labels_[[0, 5]] == -1).all()
    model.move([5], model.concepts_[0])
    assert model.foreign_.tolist() == [0]


def test_links_hold_and_are_told_of_when_they_no_longer_do(model):
    keys = [one.key for one in model.concepts_]
    first, second = members(model, keys[0])[0], members(model, keys[1])[0]
    model.link(first, second)
    assert second in members(model, keys[0])
    # What is linked with it comes along.
    third = members(model, keys[2])[0]
    model.link(third, first)
    assert {first, second, third} <= set(members(model, keys[2]))
    model.move([second], keys[1])
    assert [bool(edit.unfit) for edit in model.journal] == [True, False, False]
    assert "moved since" in model.journal[0].unfit
    undo_all(model)
    inside = members(model, keys[0])
    model.link(inside[0], inside[1], together=False)
    assert model.labels_[inside[0]] != model.labels_[inside[1]]
    assert model.links[0].together is False and model.journal[0].unfit == ""


def test_the_cut_changes_and_what_was_said_of_scans_stays(model):
    coarse = float(model.concept_tree_.granularities[0]) / 2
    model.mark_foreign([1])
    learned = model.granularity_
    edit = model.recut(coarse)
    assert len(model.concepts_) < 4 and model.foreign_.tolist() == [1]
    assert edit.granularity == coarse == model.granularity_
    with pytest.raises(ValueError, match="already"):
        model.recut(coarse)
    before = state_of(model)
    model.undo()
    assert model.granularity_ == learned
    model.redo()
    assert state_of(model) == before and edit.text.endswith(f"at granularity {coarse:.3g}")


def test_propagation_puts_only_what_is_sure(model):
    model.rename(model.concepts_[0], "a")
    for one in model.concepts_[1:]:
        model.rename(one, "")
    # Others are unlike it: none of them is put there.
    with pytest.raises(ValueError, match="none of 29 scans in no named concept is sure enough"):
        model.propagate()
    own = members(model, model.concepts_[0].key)
    one = own[3]
    lonely = model.move([one])
    model.undo()
    model.split(model.concepts_[0], [one])
    edit = model.propagate()
    assert one in members(model, model.concepts_[0].key) and edit.kind == "propagate"
    assert lonely.made == (4,)


def test_questions_ask_for_names_first_and_end(model):
    for one in list(model.concepts_):
        model.rename(one, "")
    for _ in range(4):
        question = model.next_question()
        assert question.kind == "name" and len(question.scans) <= 24
        assert set(question.scans.tolist()) <= set(members(model, question.key))
        assert question.decides == len(members(model, question.key))
        model.rename(question.key, f"kind {question.key}")
    assert model.next_question() is None
    # One that is put among others is asked for, until it is confirmed.
    stranger = members(model, model.concepts_[1].key)[0]
    model.split(model.concepts_[1], [stranger])
    model.merge([model.concepts_[0], model.concepts_[-1]], "kind 0")
    question = model.next_question()
    assert question.kind == "check" and question.scans[0] == stranger
    model.confirm(question.scans)
    assert model.next_question() is None


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda m: m.rename(99, "x"), "concept must be one of the keys 0, 1, 2, 3, got 99"),
        (lambda m: m.rename(True, "x"), "got True"),
        (lambda m: m.rename(0, 5), "name must be a str, got 5"),
        (lambda m: m.merge([0, 0]), "at least two, got 1"),
        (lambda m: m.split(0, [0]), "object 0 is not in “concept of kind 0”"),
        (lambda m: m.split(0, m.concepts_[0].members), "nothing would be left"),
        (lambda m: m.move([], 0), "at least one, got none"),
        (lambda m: m.move([40], 0), "rows from 0 to 39, got 40"),
        (lambda m: m.move([-1], 0), "rows from 0 to 39, got -1"),
        (lambda m: m.move([1.5], 0), "got 1.5"),
        (lambda m: m.move("object 1", 0), "as a list, got 'object 1'"),
        (lambda m: m.move(["nobody"], 0), "no scan has the name 'nobody'"),
        (lambda m: m.move([2], 0), "could not be used"),
        (lambda m: m.move([1], 0, name="x"), "name is for a new concept"),
        (lambda m: m.link(1, 1), "must be two scans"),
        (lambda m: m.undo(), "nothing to undo"),
        (lambda m: m.redo(), "nothing to do again"),
        (lambda m: m.recut(2), "granularity"),
        (lambda m: m.propagate(-1), "rate"),
    ],
)
def test_what_cannot_be_done_says_why_and_changes_nothing(model, wrong, message):
    before = state_of(model)
    with pytest.raises(ValueError) as error:
        wrong(model)
    assert message in str(error.value)
    assert state_of(model) == before and model.journal == ()


EDITS = st.tuples(st.integers(0, 8), st.integers(0, 39), st.integers(0, 39), st.integers(0, 3))


def say(model, kind, a, b, c):
    """Some edit; one that cannot be made is left out."""
    concepts = model.concepts_
    some, other = concepts[a % len(concepts)], concepts[b % len(concepts)]
    try:
        (
            lambda: model.rename(some, f"name {b}"),
            lambda: model.merge([some, other]),
            lambda: model.split(some),
            lambda: model.split(some, some.members[: 1 + b % some.size]),
            lambda: model.move([a, b], other),
            lambda: model.move([a, b], name=f"new {c}"),
            lambda: model.mark_foreign([a]),
            lambda: model.link(a, b, together=bool(c % 2)),
            lambda: model.recut(c / 8),
        )[kind]()
    except ValueError:
        return


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(edits=st.lists(EDITS, max_size=12), n_undone=st.integers(0, 12))
def test_any_edits_are_undone_done_again_and_kept_by_a_file(fitted, tmp_path, edits, n_undone):
    model = copy.deepcopy(fitted)
    learned = state_of(model)
    states = [learned]
    for one in edits:
        say(model, *one)
        if len(model.journal) == len(states):
            states.append(state_of(model))
        # Every scan is in one concept at most, and the concepts hold what the labels say.
        for number, concept in enumerate(model.concepts_):
            assert concept.members.tolist() == np.flatnonzero(model.labels_ == number).tolist()
            assert concept.medoid in concept.members
        assert len({concept.key for concept in model.concepts_}) == len(model.concepts_)
        assert model.labels_[2] == -1
    n_undone = min(n_undone, len(model.journal))
    for _ in range(n_undone):
        model.undo()
    assert state_of(model) == states[len(states) - 1 - n_undone]
    path = tmp_path / "model"
    JournalFile(path).path.unlink(missing_ok=True)
    model.save(path)
    loaded = load_model(path)
    assert state_of(loaded) == state_of(model) and loaded.journal == model.journal
    redo_all(loaded)
    assert state_of(loaded) == states[-1]
    undo_all(loaded)
    assert state_of(loaded) == learned


def test_a_loaded_model_answers_like_the_corrected_one(model, tmp_path):
    model.merge([model.concepts_[0], model.concepts_[1]], "both")
    model.move([3], model.concepts_[0])
    model.save(tmp_path / "m")
    new = described_objects(3, seed=9)
    for ours, theirs in zip(model.recognise(new), load_model(tmp_path / "m").recognise(new), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_names_set_by_hand_are_kept_whatever_the_concept(model, tmp_path):
    model.merge([model.concepts_[0], model.concepts_[1]])
    for number, concept in enumerate(model.concepts_):
        concept.name = f"by hand {number}"
    model.save(tmp_path / "m")
    assert [one.name for one in load_model(tmp_path / "m").concepts_] == [f"by hand {i}" for i in range(3)]


def test_edits_outlive_updates(tmp_path):
    objects = described_objects(20, seed=3)
    model = ShapeConceptModel(descriptor="distance").set_params(ensemble__dictionary__n_levels=3)
    model.fit(objects[:40])
    first, second = model.concepts_[0], model.concepts_[1]
    kinds = {int(first.members[0]) % 4, int(second.members[0]) % 4}
    model.merge([first, second], "both")
    moved = int(model.concepts_[-1].members[0])
    model.move([moved], model.concepts_[0])
    model.partial_fit(objects[40:])
    model.consolidate()
    both = next(one for one in model.concepts_ if one.name == "both")
    # The new scans of both kinds are there, too, and the one that was moved.
    of_kinds = [i for i in range(80) if i % 4 in kinds and i != moved]
    assert len(set(of_kinds) & set(both.members.tolist())) >= 0.9 * len(of_kinds)
    assert moved in both.members and all(not edit.unfit for edit in model.journal)
    assert model.history_[-1].n_after == 80 and len(model.labels_) == 80
    undo_all(model)
    assert "both" not in [one.name for one in model.concepts_]


def test_scans_that_come_later_follow_the_part_they_are_like():
    objects = described_objects(20, seed=3)
    model = ShapeConceptModel(descriptor="distance").set_params(ensemble__dictionary__n_levels=3)
    model.fit(objects[:40])
    coarse = float(model.concept_tree_.granularities[0]) / 2
    coarse_model = model.at_granularity(coarse)
    largest = coarse_model.concepts_[0]
    edit = coarse_model.split(largest)
    coarse_model.partial_fit(objects[40:])
    coarse_model.consolidate()
    for key in (largest.key, *edit.made):
        labels = {i % 4 for i in members(coarse_model, key)}
        assert max(members(coarse_model, key)) >= 40
        others = {i % 4 for i in range(80) if i not in members(coarse_model, key)}
        assert labels and not labels & others


def test_edits_outlive_a_refit_and_say_what_no_longer_fits(model):
    objects = described_objects(10)
    gone = "object 0"
    model.move([gone], name="alone")
    model.merge([model.concepts_[0], model.concepts_[1]], "both")
    refitted = ShapeConceptModel(descriptor="distance").set_params(ensemble__dictionary__n_levels=3)
    refitted.fit([one for one in reversed(objects) if one.name != gone])
    refitted.take_identities(model)
    assert "both" in [one.name for one in refitted.concepts_]
    told = {edit.kind: edit.unfit for edit in refitted.journal}
    assert told["merge"] == "" and "1 of its 1 scans are no longer there" in told["move"]
    assert "there is no longer a concept with the key 4, which it calls 'alone'" in told["move"]


def test_a_key_that_was_given_twice_means_two_concepts(model, tmp_path):
    # One process splits a concept while another one learns a new one, each with the next key.
    model.split(model.concepts_[0], model.concepts_[0].members[:3])
    other = model.filtration_.concepts_[3]
    own = members(model, 4)
    other.key = 4
    model._correct()
    assert len({one.key for one in model.concepts_}) == 5
    assert members(model, 4) == other.members.tolist() and members(model, 5) == own


def test_the_journal_lies_beside_the_model_and_grows_by_lines(model, tmp_path):
    path = tmp_path / "m"
    model.save(path)
    assert not JournalFile(path).path.exists()
    model.rename(0, "one\u2028\x1b]0;\udcff")
    model.write_journal(path)
    first = JournalFile(path).path.read_bytes()
    model.rename(0, "two")
    model.write_journal(path)
    second = JournalFile(path).path.read_bytes()
    assert second.startswith(first) and second.count(b"\n") == 3
    assert [edit.names[0][1] for edit in load_model(path).journal] == ["one\u2028\x1b]0;\udcff", "two"]
    # What is said to another process since stays there.
    model.undo()
    other = load_model(path)
    model.write_journal(path)
    other.write_journal(path)
    assert JournalFile(path).path.read_bytes().count(b"\n") == 4


def test_a_line_that_was_not_finished_never_was(model, tmp_path):
    path = tmp_path / "m"
    model.rename(0, "one")
    model.rename(1, "two")
    model.save(path)
    whole = JournalFile(path).path.read_bytes()
    start = whole.index(b"\n", whole.index(b"\n") + 1) + 1
    for end in range(start, len(whole)):
        JournalFile(path).path.write_bytes(whole[:end])
        again = load_model(path)
        assert [edit.number for edit in again.journal] == [1]
    again.rename(2, "three")
    again.write_journal(path)
    assert [edit.names for edit in load_model(path).journal] == [((0, "one"),), ((2, "three"),)]


def test_edits_of_two_processes_do_not_get_mixed_up(model, tmp_path):
    path = tmp_path / "m"
    model.rename(0, "one")
    model.save(path)
    first, second = load_model(path), load_model(path)
    first.rename(0, "first")
    second.rename(0, "second")
    first.write_journal(path)
    with pytest.raises(ModelError, match="holds edits that this model does not know"):
        second.write_journal(path)
    assert load_model(path).concepts_[0].name == "first"


def test_a_journal_of_another_model_is_set_aside_and_said(model, fitted, tmp_path):
    path = tmp_path / "m"
    model.rename(0, "one")
    model.save(path)
    other = copy.deepcopy(fitted)
    with pytest.warns(UserWarning, match="was of another model"):
        other.save(path)
    assert load_model(path).journal == ()
    assert (tmp_path / "m.journal.1").read_bytes().count(b"\n") == 2


def test_one_explorer_at_a_time(tmp_path):
    first, second = JournalFile(tmp_path / "m"), JournalFile(tmp_path / "m")
    with first.held(), pytest.raises(ModelError, match="held by another explorer"), second.held():
        pass
    with JournalFile(tmp_path / "m").held():
        pass
    assert list(tmp_path.iterdir()) == []


FORGED = [
    b"",
    b"\n",
    b"{}\n",
    b"not json\n",
    b'{"shapeconcepts_journal": 2, "identity": "a"}\n',
    b'{"shapeconcepts_journal": 1}\n',
]
HEADER = b'{"shapeconcepts_journal": 1, "identity": "a"}\n'
FORGED_LINES = [
    "[]",
    "[" * 100_000,
    '{"number":2,"kind":"rename","text":""}',
    '{"number":1,"kind":"destroy","text":""}',
    '{"number":true,"kind":"rename","text":""}',
    '{"number":1,"kind":"rename","text":5}',
    '{"number":1,"kind":"rename","text":"","keys":[-1]}',
    '{"number":1,"kind":"rename","text":"","keys":[99999999999999999999]}',
    '{"number":1,"kind":"move","text":"","groups":[[0,["a"],1]]}',
    '{"number":1,"kind":"move","text":"","groups":[[-2,["a"]]]}',
    '{"number":1,"kind":"move","text":"","groups":[[0,[5]]]}',
    '{"number":1,"kind":"move","text":"","groups":[[0,[["a",-1]]]]}',
    '{"number":1,"kind":"rename","text":"","names":[[0,0]]}',
    '{"number":1,"kind":"link","text":"","linked":[["a","b"]]}',
    '{"number":1,"kind":"undo","text":"","of":7}',
    '{"number":1,"kind":"redo","text":"","of":1}',
    '{"number":1,"kind":"rename","text":"","is_undone":true}',
    '{"number":1,"kind":"rename","text":"","more":true}',
]


@pytest.mark.parametrize("content", [*FORGED, *(HEADER + line.encode() + b"\n" for line in FORGED_LINES)])
def test_a_forged_journal_is_refused_with_its_name(default, content):
    path = JournalFile(default).path
    path.write_bytes(content)
    try:
        with pytest.raises(ModelError, match=r"model\.journal"):
            load_model(default)
    finally:
        path.unlink()


def test_a_journal_that_is_no_file_is_refused(default):
    path = JournalFile(default).path
    path.mkdir()
    try:
        with pytest.raises(ModelError, match="is not a regular file"):
            load_model(default)
    finally:
        path.rmdir()


@settings(max_examples=50, deadline=None)
@given(data=st.data())
def test_lines_hold_edits_whole(data):
    text = st.text(st.characters(), max_size=5)
    reference = text | st.tuples(text, st.integers(0, 5))
    key = st.integers(0, 2**31 - 1)
    edit = Edit(
        data.draw(st.integers(1, 99)),
        data.draw(st.sampled_from(["rename", "merge", "move", "link"])),
        data.draw(text),
        tuple(data.draw(st.lists(key, max_size=3))),
        tuple(data.draw(st.lists(st.tuples(key, st.lists(reference, max_size=3).map(tuple)), max_size=3))),
        tuple(data.draw(st.lists(key, max_size=3))),
        data.draw(key),
        tuple(data.draw(st.lists(st.tuples(key, text), max_size=3))),
        tuple(data.draw(st.lists(st.tuples(reference, reference, st.booleans()), max_size=3))),
        data.draw(st.integers(0, 99)),
        data.draw(st.floats(0, 1)),
    )
    line = edit.to_line()
    assert line.isascii() and "\n" not in line and Edit.from_line(line) == edit
    json.loads(line)


def test_undo_and_redo_go_in_order():
    def edits(*kinds):
        return tuple(Edit(i + 1, kind, "", of=of) for i, (kind, of) in enumerate(kinds))

    journal = Journal(
        "a", edits(("rename", 0), ("move", 0), ("undo", 2), ("undo", 1), ("redo", 1), ("merge", 0))
    )
    assert [edit.number for edit in journal.in_force] == [1, 6]
    assert [(edit.number, edit.is_undone) for edit in journal.edits] == [(1, False), (2, True), (6, False)]
    # Something new was said since.
    assert journal.last_undone is None and journal.last_done.number == 6
    for wrong in ((("undo", 1),), (("rename", 0), ("redo", 1)), (("rename", 0), ("move", 0), ("undo", 1))):
        with pytest.raises(ModelError):
            Journal("a", edits(*wrong))


def test_a_model_without_concepts_can_be_given_some():
    rng = np.random.default_rng(0)
    objects = described_objects(1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = ShapeConceptModel(descriptor="distance").set_params(ensemble__dictionary__n_levels=1)
        model.fit(objects)
    undo_all(model)
    for _ in range(3):
        model.move(rng.choice(4, 2, replace=False), name="made")
    assert sum(one.size for one in model.concepts_) >= 2


def test_a_few_scans_of_a_mixture_tell_the_others_apart(model):
    a, b = model.concepts_[0], model.concepts_[3]
    mixture = model.merge([a, b], "mixed").groups[0][0]
    model.rename(mixture, "")
    for one, name in ((a, "a"), (b, "b")):
        model.move(one.members[:3], name=name)
    edit = model.propagate()
    found = {one.name: set(one.members.tolist()) for one in model.concepts_}
    assert found["a"] <= set(a.members.tolist()) and found["b"] <= set(b.members.tolist())
    assert len(found["a"]) + len(found["b"]) >= 0.8 * (a.size + b.size) and edit.keys == ()
    # What the user wants apart is not put together, however sure it is.
    model.undo()
    one = next(i for i in sorted(found["a"]) if i not in model.certain_)
    model.link(a.members[0], one, together=False)
    model.propagate()
    assert model.labels_[one] != model.labels_[a.members[0]]
