"""What the evaluation says where its libraries are not installed, and that nothing else needs them."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from shapeconcepts.cli import app
from shapeconcepts.evaluation import evaluate, leiden, plscan, tomato
from shapeconcepts.evaluation.groupings import Grouping
from shapeconcepts.evaluation.libraries import LIBRARIES, check_libraries

REMEDY = "not installed: pip install 'shapeconcepts[evaluation]'"


@pytest.fixture(params=[*LIBRARIES])
def missing(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """A library that seems not to be installed."""
    monkeypatch.setitem(sys.modules, request.param, None)
    return request.param


def test_the_command_says_so_before_any_work(missing: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["evaluate", str(tmp_path / "nowhere"), "--json"])
    assert result.exit_code == 1
    assert result.stdout == ""
    assert result.stderr == f"Error: the evaluation needs {missing}, which is {REMEDY}\n"


def test_all_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("gudhi", "matplotlib"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ModuleNotFoundError, match=f"needs gudhi and matplotlib, which are {REMEDY[:13]}"):
        check_libraries(*LIBRARIES)


@pytest.mark.parametrize(
    ("library", "method"),
    [("gudhi", tomato), ("graspologic_native", leiden), ("fast_hdbscan", plscan)],
)
def test_functions_say_so(
    library: str, method: Callable[..., Grouping], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ModuleNotFoundError, match=f"needs {library}, which is not installed: pip install"):
        evaluate([])
    with pytest.raises(ModuleNotFoundError, match=f"needs {library}, which is not installed: pip install"):
        method(1.0 - np.eye(6), 2)


def test_the_report_says_so() -> None:
    program = "import sys; sys.modules['matplotlib'] = None; import shapeconcepts.evaluation.report"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert result.returncode == 1
    last = result.stderr.splitlines()[-1]
    assert last == f"ModuleNotFoundError: the evaluation needs matplotlib, which is {REMEDY}"
