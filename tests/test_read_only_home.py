"""The package where nothing can be kept: installed without permission to write, for a user without a home."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import shapeconcepts
from shapeconcepts.io.write_pcd import write_pcd

# What is read must be the copy, not the package that is tested otherwise.
SEGMENT = """
import sys
import shapeconcepts
assert shapeconcepts.__file__.startswith(sys.argv[1]), shapeconcepts.__file__
del sys.argv[1]
from shapeconcepts.cli import main
main()
"""


def bound_by_permissions() -> list[str]:
    """What to put before a command so that it cannot write where permissions forbid it, which root can."""
    if os.name != "posix":
        pytest.skip("needs permissions as on Unix")
    if os.geteuid() != 0:
        return []
    without = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", "--"]
    try:
        subprocess.run([*without, "true"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as error:
        pytest.skip(f"root may write everywhere, and nothing takes that away here: {error}")
    return without


@pytest.fixture
def read_only(tmp_path: Path):
    """A folder with a copy of the package, without permission to write."""
    folder = tmp_path / "read only"
    package = Path(shapeconcepts.__file__).parent
    shutil.copytree(package, folder / package.name, ignore=shutil.ignore_patterns("__pycache__"))
    everything = [folder, *folder.rglob("*")]
    for path in everything:
        path.chmod(path.stat().st_mode & ~0o222)
    yield folder
    # Folders come before what is in them.
    for path in everything:
        path.chmod(path.stat().st_mode | 0o200)


def test_segment_works_and_warns_once(read_only: Path, tmp_path: Path) -> None:
    before = bound_by_permissions()
    [scan] = shapeconcepts.datasets.simulate(1, categories=["can"])
    write_pcd(tmp_path / "can.pcd", scan)
    caches = ("XDG_CACHE_HOME", "NUMBA_CACHE_DIR", "PYTHONPYCACHEPREFIX")
    environment = {name: value for name, value in os.environ.items() if name not in caches}
    result = subprocess.run(
        [*before, sys.executable, "-c", SEGMENT, str(read_only), "segment", "can.pcd"],
        cwd=tmp_path,
        env={**environment, "PYTHONPATH": str(read_only), "HOME": str(read_only / "no home")},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert result.returncode == 0, result.stderr
    assert "can.pcd" in result.stdout
    assert result.stderr.count("Warning: ") == 1
    # The second line is the source line that warnings come with.
    warning, _ = result.stderr.splitlines()
    assert "UserWarning: compiled code can be kept nowhere" in warning
    assert "NUMBA_CACHE_DIR" in warning
    assert not [path for path in read_only.rglob("*") if path.name in ("__pycache__", "no home")]
