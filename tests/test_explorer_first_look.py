"""What the explorer shows of a model before it is read."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import shapeconcepts as sc
from explorer_reader import window_on
from model_file_examples import LIKE_THE_PAPER, fitted_model, forge
from shapeconcepts.explorer.first_look import first_look
from shapeconcepts.explorer.model_document import model_document
from shapeconcepts.explorer.session import Session
from shapeconcepts.explorer.state_document import state_document
from shapeconcepts.explorer.telling import Telling

# What takes its time: nothing of it is there before the model is read.
LATER = ("tree", "treeGroupOfScan", "granularities")
THOUGHT = ("pValues", "doubts", "doubtfulFrom")


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    model = fitted_model()
    model.concepts_[0].name = "the first"
    model.save(tmp_path / "m.safetensors")
    # A name is something that was said.
    (tmp_path / "m.safetensors.journal").unlink(missing_ok=True)
    return tmp_path / "m.safetensors"


@pytest.mark.parametrize("parameters", [{}, LIKE_THE_PAPER])
def test_it_tells_what_the_whole_model_tells(tmp_path: Path, parameters: dict[str, object]) -> None:
    path = tmp_path / "m.safetensors"
    fitted_model(**parameters).save(path)
    model = sc.load_model(path)
    first, state = first_look(path, True, {})
    scans = model.scan_names_, model.scan_labels_, model.skipped_
    whole = model_document(*scans, model.concept_tree_, path.name, True, {})
    whole_state = state_document(model, {}, False)
    assert first.keys() == whole.keys() and state.keys() == whole_state.keys()
    assert {**first, **{name: whole[name] for name in LATER}} == whole
    assert {**state, **{name: whole_state[name] for name in THOUGHT}} == whole_state


def test_scans_that_were_skipped_are_in_no_concept(tmp_path: Path) -> None:
    path = tmp_path / "m.safetensors"
    fitted_model().save(path)
    n = len(sc.load_model(path).scan_names_)
    state = first_look(path, False, {})[1]
    skipped = first_look(path, False, {})[0]["scans"]["skipped"]
    assert len(state["conceptOfScan"]) == n
    assert all(state["conceptOfScan"][row] == -1 for row in skipped)


def test_it_imports_nothing_that_learns(saved: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from shapeconcepts.explorer.first_look import first_look;"
        f"first_look(Path({str(saved)!r}), True, {{}});"
        "print([name for name in ('sklearn', 'scipy', 'numba') if name in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "[]\n"


@pytest.mark.parametrize(
    ("tensor", "value", "said"),
    [("concepts.labels", -2, "numbers from -1 to"), ("concepts.medoids", 10**6, "numbers from 0 to")],
)
def test_numbers_that_lead_nowhere_are_refused(saved: Path, tensor: str, value: int, said: str) -> None:
    def change(tensors: dict, description: dict) -> None:
        tensors[tensor][0] = value

    with pytest.raises(sc.ModelError, match=said) as raised:
        first_look(forge(saved, saved.with_name("forged"), change), True, {})
    assert "forged" in str(raised.value)


@pytest.mark.parametrize("content", [b"", b"no model", bytes(200)])
def test_what_is_no_model_is_refused_by_who_reads_it(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "m.safetensors"
    path.write_bytes(content)
    with pytest.raises(sc.ModelError, match=r"m\.safetensors"):
        first_look(path, True, {})
    assert not Telling(Session(path, (), {}), remember=False).is_there


def test_it_is_told_until_the_model_is_read(saved: Path) -> None:
    session = Session(saved, (), {})
    telling = Telling(session, remember=False)
    assert telling.is_there and telling.n_scans == len(sc.load_model(saved).scan_names_)
    first, state = json.loads(telling.model_json()), json.loads(telling.state_json())
    assert first["modelVersion"] == state["modelVersion"] and not first["tree"]
    session.open()
    whole, later = json.loads(telling.model_json()), json.loads(telling.state_json())
    assert whole["tree"] and whole["modelVersion"] == later["modelVersion"] != first["modelVersion"]
    assert later["version"] > state["version"] and later["pValues"]
    session.close()


def test_what_was_said_is_never_left_out(saved: Path) -> None:
    model = sc.load_model(saved)
    model.rename(model.concepts_[0].key, "said")
    model.write_journal(saved)
    assert not Telling(Session(saved, (), {}), remember=False).is_there


def test_a_page_that_was_there_first_gets_the_rest(browser, saved: Path) -> None:
    session = Session(saved, (), {})
    with window_on(browser, session) as window:
        page, concepts = window.page, window.state()["concepts"]
        assert page.locator("#left .concepts li").count() == len(concepts) > 1
        assert "the first" in page.locator("#left .concepts").inner_text()
        assert page.locator(".tile:not([aria-hidden])").count() > 0
        assert page.locator("#slider input").count() == 0
        session.open()
        page.wait_for_selector("#slider input")
        assert page.locator("#left .concepts li").count() == len(concepts)
        assert window.complaints == []
