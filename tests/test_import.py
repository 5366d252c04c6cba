"""The public surface, and what importing it costs."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import shapeconcepts

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "shapeconcepts"
# The command line imports all its modules for each command: --help, and what is quick, would wait for numba
# and scikit-learn. The explorer's page would, too.
NEED_NO_REASON = ("cli", "explorer")


def test_every_public_name_exists() -> None:
    assert {name: hasattr(shapeconcepts, name) for name in shapeconcepts.__all__} == dict.fromkeys(
        shapeconcepts.__all__, True
    )
    assert set(shapeconcepts.__all__) <= set(dir(shapeconcepts))


def test_packages_are_there_without_an_import() -> None:
    names = [
        "concepts",
        "datasets",
        "descriptors",
        "evaluation",
        "io",
        "motifs",
        "report",
        "simulation",
        "sources",
        "topology",
    ]
    program = f"import shapeconcepts as sc; print([getattr(sc, name).__name__ for name in {names}])"
    assert printed_by(program) == str([f"shapeconcepts.{name}" for name in names])


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
    # scikit-learn imports pandas itself where it is installed.
    foreign = ["matplotlib", "plotly", "open3d"]
    program = (
        "import sys, shapeconcepts as sc; [getattr(sc, name) for name in sc.__all__];"
        f"print([name for name in {foreign} if name in sys.modules])"
    )
    assert printed_by(program) == "[]"


def test_the_version_is_the_same_everywhere() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["version"] == shapeconcepts.__version__
    assert f"\nversion: {shapeconcepts.__version__}\n" in (ROOT / "CITATION.cff").read_text()


def unexplained_imports(source: str) -> list[int]:
    """Lines of imports within functions without a comment above them, or above imports just before them."""
    lines = source.splitlines()
    within = {
        node.lineno: node.end_lineno
        for function in ast.walk(ast.parse(source))
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef)
        for node in ast.walk(function)
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    before = {end: start for start, end in within.items()}
    unexplained = []
    for start in sorted(within):
        first = start
        while first - 1 in before:
            first = before[first - 1]
        if not lines[first - 2].lstrip().startswith("#"):
            unexplained.append(start)
    return unexplained


def test_imports_that_are_unexplained() -> None:
    source = """
import a
def f():
    # It is heavy.
    from b import (
        c,
    )
    import d
    def g():
        import e  # noqa: F401
    if a:
        # Only here.
        import h
"""
    assert unexplained_imports(source) == [10]


def test_imports_within_functions_have_their_reason() -> None:
    found = [
        f"{path.relative_to(PACKAGE)}:{line}"
        for path in sorted(PACKAGE.rglob("*.py"))
        if path.relative_to(PACKAGE).parts[0] not in NEED_NO_REASON
        for line in unexplained_imports(path.read_text())
    ]
    assert found == []


def test_the_explorer_answers_before_anything_heavy_is_imported() -> None:
    """So that its page is there while the model is read."""
    script = (
        "import sys, shapeconcepts.cli, shapeconcepts.explorer.server, shapeconcepts.explorer.telling\n"
        "heavy = {'numpy', 'scipy', 'numba', 'sklearn', 'pandas', 'PIL', 'rich'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
