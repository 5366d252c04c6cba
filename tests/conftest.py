"""Fixtures shared by all tests."""

import signal
from pathlib import Path

import pytest

from explorer_reader import explored, opened
from model_file_examples import LIKE_THE_PAPER, fitted_model
from report_reader import started_browser
from shapeconcepts import ShapeConceptModel, read_scans
from shapeconcepts.datasets import simulate
from shapeconcepts.io.write_pcd import write_pcd
from shapeconcepts.scan import Scan
from shapeconcepts.sources import reader

# What a shell starts in the background ignores interrupts, and so would the commands that tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)

SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder with the real and simulated scans that lie beside the repository."""
    if not SHARED_DATA.is_dir():
        pytest.skip(f"needs the data folder {SHARED_DATA}, which is absent")
    return SHARED_DATA


@pytest.fixture
def scanned(monkeypatch):
    """The mesh that a reader hands to the simulator."""
    seen = {}

    def scan_mesh(vertices, faces, *, random_state, name):
        seen.update(vertices=vertices, faces=faces, random_state=random_state)
        return Scan(vertices, name=name)

    monkeypatch.setattr(reader, "scan_mesh", scan_mesh)
    return seen


@pytest.fixture(scope="module")
def default(tmp_path_factory):
    """File of a sound model."""
    path = tmp_path_factory.mktemp("sound") / "model"
    fitted_model().save(path)
    return path


@pytest.fixture(scope="module")
def like_the_paper(tmp_path_factory):
    """File of a sound model with motifs as columns."""
    path = tmp_path_factory.mktemp("sound") / "model"
    fitted_model(**LIKE_THE_PAPER).save(path)
    return path


@pytest.fixture(scope="session")
def explored_folder(tmp_path_factory):
    """Folder with `scans` of four categories, and a model of them."""
    folder = tmp_path_factory.mktemp("explorer")
    for scan in simulate(8, categories=("ball", "box", "can", "plate")):
        path = folder / "scans" / str(scan.label) / f"{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    model = ShapeConceptModel().fit(read_scans(folder / "scans"))
    assert len(model.concepts_) >= 3
    model.save(folder / "m.safetensors")
    return folder


@pytest.fixture(scope="session")
def explorer_address(explored_folder):
    """Where an explorer answers."""
    with explored(explored_folder / "m.safetensors", explored_folder / "scans") as address:
        yield address


@pytest.fixture(scope="module")
def browser():
    """A real browser."""
    yield from started_browser()


@pytest.fixture
def window(browser, explorer_address):
    """A page of an explorer, which is as it was when the next test begins."""
    yield from opened(browser, explorer_address)
