"""Compiled kernels in files that are damaged: none is run, none ends a command."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numba
import pytest

from shapeconcepts.kernel_cache import is_sound
from shapeconcepts.kernels import kernel

MODULE = """
from shapeconcepts.kernels import kernel

@kernel
def twice(x):
    return 2 * x
"""
# A process of its own: what is damaged could end it.
USE = "import small_kernels as s; print(s.twice(21), sum(s.twice.stats.cache_hits.values()))"


def use(folder: Path) -> str:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), *sys.path])}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-c", USE]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a module of one kernel, and its compiled code."""
    folder = tmp_path_factory.mktemp("kernels")
    (folder / "small_kernels.py").write_text(MODULE)
    assert use(folder) == "42 0\n"
    assert use(folder) == "42 1\n", "the code is kept"
    return folder


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-40])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    for place in range(0, len(content), 97):
        content[place] ^= 1 << place % 8
    path.write_bytes(content)


def delete(path: Path) -> None:
    path.unlink()


def put_a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("damage", [truncate, empty, flip, delete, put_a_pipe])
def test_damaged_code_is_compiled_anew_and_replaced(
    compiled: Path, suffix: str, damage: Callable[[Path], None]
) -> None:
    if damage is put_a_pipe and not hasattr(os, "mkfifo"):
        pytest.skip("needs pipes with names")
    [path] = compiled.rglob(f"*{suffix}")
    damage(path)
    assert not is_sound(path)
    assert use(compiled) == "42 0\n"
    assert is_sound(path)


def test_flipped_bits_are_noticed(compiled: Path, tmp_path: Path) -> None:
    [path] = compiled.rglob("*.nbi")
    content = path.read_bytes()
    copy = tmp_path / path.name
    for place in range(0, 8 * len(content), 61):
        damaged = bytearray(content)
        damaged[place // 8] ^= 1 << place % 8
        copy.write_bytes(damaged)
        assert not is_sound(copy)
    copy.write_bytes(content)
    assert is_sound(copy)


def test_code_under_another_name_is_not_sound(compiled: Path, tmp_path: Path) -> None:
    [path] = compiled.rglob("*.nbc")
    other = tmp_path / "other.nbc"
    other.write_bytes(path.read_bytes())
    assert not is_sound(other)


def test_code_of_another_signature_is_not_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As two processes leave it that both began the index: each took the first name for its code."""
    (tmp_path / "pair_kernels.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    import pair_kernels  # type: ignore[import-not-found]

    files = pair_kernels.twice._cache._cache_file
    files.save("an index key", "its code")
    assert files.load("an index key") == "its code"
    index = files._load_index()
    files._save_index({"another key": index["an index key"]})
    assert files.load("another key") is None


def test_a_full_disk_is_a_warning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "full_kernels.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    import full_kernels  # type: ignore[import-not-found]

    def full(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(full_kernels.twice._cache._cache_file, "save", full)
    with pytest.warns(UserWarning, match="cannot be kept in .*No space left on device"):
        assert full_kernels.twice(4) == 8


def test_a_kernel_without_the_compiler_is_the_function(monkeypatch: pytest.MonkeyPatch) -> None:
    def thrice(x: int) -> int:
        return 3 * x

    monkeypatch.setattr(numba.config, "DISABLE_JIT", 1)
    assert kernel(thrice) is thrice
