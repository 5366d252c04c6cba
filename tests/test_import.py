"""The public surface, and what importing it costs."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import shapeconcepts

ROOT = Path(__file__).resolve().parents[1]


def test_every_public_name_exists() -> None:
    assert {name: hasattr(shapeconcepts, name) for name in shapeconcepts.__all__} == dict.fromkeys(
        shapeconcepts.__all__, True
    )
    assert set(shapeconcepts.__all__) <= set(dir(shapeconcepts))


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'shapeconcepts' has no attribute 'segmentize'"):
        _ = shapeconcepts.segmentize


def printed_by(program: str) -> str:
    command = [sys.executable, "-c", program]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def test_import_leaves_heavy_modules_alone() -> None:
    heavy = ["matplotlib", "plotly", "pandas", "open3d", "trimesh", "numba", "numpy", "scipy", "PIL", "typer"]
    program = f"import sys, shapeconcepts; print([name for name in {heavy} if name in sys.modules])"
    assert printed_by(program) == "[]"


def test_use_leaves_modules_alone_that_are_no_dependencies() -> None:
    foreign = ["matplotlib", "plotly", "pandas", "open3d"]
    program = (
        "import sys, shapeconcepts as sc; [getattr(sc, name) for name in sc.__all__];"
        f"print([name for name in {foreign} if name in sys.modules])"
    )
    assert printed_by(program) == "[]"


def test_the_version_is_the_same_everywhere() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["version"] == shapeconcepts.__version__
    assert f"\nversion: {shapeconcepts.__version__}\n" in (ROOT / "CITATION.cff").read_text()
