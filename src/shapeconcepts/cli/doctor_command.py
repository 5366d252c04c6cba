"""`shapeconcepts doctor`: whether what the package needs of the machine is in order."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import typer

from shapeconcepts.cli.terminal import busy, print_table, say
from shapeconcepts.version import __version__

_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite", "joblib", "scikit-learn")
_ANOTHER_FOLDER = "let the environment variable NUMBA_CACHE_DIR name a folder"
# In processes of their own, which may crash, and end with this one.
_TIED = "from shapeconcepts.interruption import end_with_parent; end_with_parent({parent})\n"
_COMPILE = "from numba import njit\nassert njit(lambda number: 2 * number)(21) == 42"
_SEGMENT = """
import shapeconcepts as sc
[scan] = sc.datasets.simulate(1, categories=["can"])
assert sc.segment(scan).n_segments > 1
"""


class _Finding(NamedTuple):
    """What was looked at, what was found, and the way out where that is not in order."""

    what: str
    found: str
    way_out: str = ""


def doctor() -> None:
    """Say where compiled kernels and segments are kept, whether they are sound, and whether kernels run.

    Where something is not in order, the way out is said, and the exit code is 1. The first time, it takes as
    long as compiling does, up to a minute.
    """
    with busy("Looking at kernels"):
        findings = [*_versions(), *_kernels(), *_kept(), *_runs()]
    print_table(("what", "found"), [(one.what, one.found) for one in findings], "found")
    ways_out = list(dict.fromkeys(one.way_out for one in findings if one.way_out))
    for way_out in ways_out:
        say(way_out)
    if ways_out:
        raise typer.Exit(1)


def _versions() -> Iterator[_Finding]:
    from importlib.metadata import version

    yield _Finding("shapeconcepts", __version__)
    yield _Finding("python", f"{platform.python_version()}, {sys.executable}")
    for name in _LIBRARIES:
        yield _Finding(name, version(name))


def _kernels() -> Iterator[_Finding]:
    from shapeconcepts.kernel_cache import is_sound, kept_files

    folders = _kernel_folders()
    if not folders:
        yield _Finding(
            "kernels",
            "kept nowhere",
            f"Every process compiles its kernels: {_ANOTHER_FOLDER} that can be written.",
        )
    for folder in folders:
        files = kept_files(folder)
        damaged = [path.name for path in files if not is_sound(path)]
        refusal = _why_not_writable(folder)
        way_out = ""
        if refusal:
            way_out = f"{folder} cannot be written ({refusal}): allow it, or {_ANOTHER_FOLDER}."
        elif damaged:
            way_out = (
                f"{folder}: damaged files are not used, and are replaced when their kernels are needed next; "
                f"they can be deleted: {', '.join(damaged)}"
            )
        found = f"{folder}: {len(files)} files, {len(damaged)} damaged"
        yield _Finding("kernels", f"{found}, {'not ' * bool(refusal)}writable", way_out)


def _kernel_folders() -> list[Path]:
    """Where numba keeps the package's kernels."""
    from importlib import import_module

    import shapeconcepts

    package = Path(shapeconcepts.__file__).parent
    modules = (path.relative_to(package.parent) for path in package.rglob("*_kernels.py"))
    folders = set()
    for path in modules:
        module = import_module(".".join(path.with_suffix("").parts))
        kernels = (one for one in vars(module).values() if hasattr(one, "stats"))
        folders |= {Path(one.stats.cache_path) for one in kernels if one.stats.cache_path}
    return sorted(folders)


def _kept() -> Iterator[_Finding]:
    """Segments, descriptions, and what the explorer showed."""
    from shapeconcepts.io.user_cache_folder import user_cache_folder

    for what in ("segments", "descriptions", "explorer"):
        try:
            yield _cache(what, user_cache_folder() / what)
        except OSError as error:
            yield _Finding(what, f"kept nowhere ({error})")


def _cache(what: str, folder: Path) -> _Finding:
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    refusal = _why_not_writable(folder)
    way_out = f"{folder} cannot be written ({refusal}): allow it, or add --no-cache." if refusal else ""
    found = f"{folder}: {len(sizes)} files, {sum(sizes) / 1e6:.0f} MB"
    return _Finding(what, f"{found}, {'not ' * bool(refusal)}writable", way_out)


def _why_not_writable(folder: Path) -> str:
    """Why nothing can be written to a folder, which may not be there yet."""
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    try:
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".shapeconcepts-"):
            return ""
    except OSError as error:
        return error.strerror or str(error)


def _runs() -> Iterator[_Finding]:
    failure = _failure(_COMPILE)
    yield _Finding(
        "numba compiles",
        failure or "yes",
        "numba does not work here: install it anew (pip install --force-reinstall numba)." if failure else "",
    )
    failure = _failure(_SEGMENT)
    yield _Finding(
        "kernels run",
        failure or "yes",
        f"Kernels do not run: delete the folders of kernels that are named above, or {_ANOTHER_FOLDER}."
        if failure
        else "",
    )


def _failure(program: str) -> str:
    """How a program ends in a process of its own, if not well."""
    command = [sys.executable, "-c", _TIED.format(parent=os.getpid()) + program]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace")
    if done.returncode == 0:
        return ""
    if done.returncode < 0:
        return f"no: ended by signal {-done.returncode}"
    return f"no: {(done.stderr.strip().splitlines() or ['without a word'])[-1]}"
