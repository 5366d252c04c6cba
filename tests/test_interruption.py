"""Commands and their processes that are told to end, or killed."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

SECONDS_TO_END = 5
HEAD = """
import os, sys, time
from pathlib import Path
from shapeconcepts.interruption import *
from shapeconcepts.parallel import map_in_order
end_at_signals()
"""
IN_PROCESSES = """
def work(item):
    Path(f"{item}").touch()
    time.sleep(100)

if __name__ == "__main__":
    list(map_in_order(work, range(8), 2, own_process=True))
"""
WORKING = {
    "python": "Path('0').touch()\nwhile True: pass",
    "waiting": "from threading import Lock\nlock = Lock()\nlock.acquire()\nPath('0').touch()\nlock.acquire()",
    # Compiled code that gives the lock away, and does not look for signals.
    "compiled": """
import hashlib
Path('0').touch()
hashlib.pbkdf2_hmac('sha256', b'', b'', 10**9)""",
    "dropping": """
Path('0').touch()
while True:
    try:
        time.sleep(100)
    except BaseException:
        pass""",
    "writing": """
from shapeconcepts.io import atomic_write
def slow(descriptor):
    Path('0').touch()
    time.sleep(100)
os.fsync = slow
atomic_write.write_atomically(Path('old'), b'new')""",
    "threads": """
def work(item):
    Path(f"{item}").touch()
    time.sleep(100)
list(map_in_order(work, range(8), 2))""",
    "processes": IN_PROCESSES,
}


def start(folder: Path, program: str) -> subprocess.Popen[str]:
    path = folder / "program.py"
    path.write_text(HEAD + program)
    return subprocess.Popen(
        [sys.executable, path],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def wait_until(holds: Callable[[], bool], seconds: float = 60) -> bool:
    deadline = time.monotonic() + seconds
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.02)
    return holds()


def processes_of(session: int) -> list[str]:
    command = ["ps", "-o", "pid=,ppid=,stat=,args=", "-s", str(session)]
    lines = subprocess.run(command, capture_output=True, text=True).stdout.splitlines()
    return [line for line in lines if line.split()[2][0] != "Z"]


def group(process: subprocess.Popen[str], number: int) -> None:
    """As a terminal does it."""
    os.killpg(process.pid, number)


def alone(process: subprocess.Popen[str], number: int) -> None:
    process.send_signal(number)


@pytest.mark.parametrize(
    ("number", "code", "said"),
    [
        (signal.SIGINT, 130, "Interrupted\n"),
        (signal.SIGTERM, 143, "Interrupted\n"),
        (signal.SIGKILL, -9, ""),
    ],
)
@pytest.mark.parametrize(("doing", "send"), [*((doing, alone) for doing in WORKING), ("processes", group)])
def test_a_signal_ends_a_process_and_all_it_started(
    tmp_path: Path,
    doing: str,
    send: Callable[[subprocess.Popen[str], int], None],
    number: int,
    code: int,
    said: str,
) -> None:
    (tmp_path / "old").write_text("old")
    process = start(tmp_path, WORKING[doing])
    assert wait_until((tmp_path / "0").exists), process.communicate(timeout=1)
    send(process, number)
    stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout, stderr) == (code, "", said)
    assert wait_until(lambda: not processes_of(process.pid), SECONDS_TO_END), processes_of(process.pid)
    assert (tmp_path / "old").read_text() == "old"
    if number != signal.SIGKILL:
        assert not list(tmp_path.glob(".shapeconcepts-*"))


@pytest.mark.parametrize("milliseconds", [0, 5, 20, 60])
def test_a_signal_while_processes_start_ends_them_too(tmp_path: Path, milliseconds: int) -> None:
    program = IN_PROCESSES.replace("    list(", "    Path('starts').touch()\n    list(")
    process = start(tmp_path, program)
    assert wait_until((tmp_path / "starts").exists)
    time.sleep(milliseconds / 1000)
    group(process, signal.SIGINT)
    stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout, stderr) == (130, "", "Interrupted\n")
    assert wait_until(lambda: not processes_of(process.pid), SECONDS_TO_END), processes_of(process.pid)


def test_a_signal_waits_for_what_is_not_to_be_left_half_done(tmp_path: Path) -> None:
    program = """
with uninterrupted():
    Path('0').touch()
    while not Path('sent').exists(): pass
    time.sleep(0.1)
    Path('done').touch()
time.sleep(100)"""
    process = start(tmp_path, program)
    assert wait_until((tmp_path / "0").exists)
    process.send_signal(signal.SIGTERM)
    (tmp_path / "sent").touch()
    process.communicate(timeout=60)
    assert process.returncode == 143
    assert (tmp_path / "done").exists()


def test_a_signal_ends_what_hangs_where_nothing_interrupts(tmp_path: Path) -> None:
    process = start(tmp_path, "with uninterrupted():\n    Path('0').touch()\n    time.sleep(100)")
    assert wait_until((tmp_path / "0").exists)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == 143


def test_a_signal_that_is_ignored_stays_ignored(tmp_path: Path) -> None:
    """As that of Ctrl-C where a shell runs a command in its background."""
    program = "import signal, os\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(0.2)\nprint('goes on')"
    ignoring = f"import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n{HEAD}{program}"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", ignoring]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "goes on\n")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_the_command_is_imported(tmp_path: Path, number: int) -> None:
    program = f"""
import importlib.abc, os
class Finder(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "shapeconcepts.cli":
            os.kill(os.getpid(), {number})
            while True:
                time.sleep(0.01)
sys.meta_path.insert(0, Finder())
from shapeconcepts.__main__ import main
main()"""
    process = start(tmp_path, program)
    stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout, stderr) == (128 + number, "", "Interrupted\n")


@pytest.mark.parametrize(
    ("jobs", "number", "send"),
    [
        (1, signal.SIGINT, alone),
        (2, signal.SIGTERM, group),
        (5, signal.SIGINT, group),
        (5, signal.SIGKILL, alone),
    ],
)
def test_learn_keeps_the_old_pair(
    tmp_path: Path, jobs: int, number: int, send: Callable[[subprocess.Popen[str], int], None]
) -> None:
    model, report = tmp_path / "m", tmp_path / "r.html"
    model.write_text("old model")
    report.write_text("old report")
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "shapeconcepts",
            "learn",
            f"--jobs={jobs}",
            "--model",
            model,
            "--report",
            report,
        ],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "XDG_CACHE_HOME": str(tmp_path)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert wait_until(lambda: any(tmp_path.rglob("*.segments")), 300)
    send(process, number)
    stdout, stderr = process.communicate(timeout=60)
    assert stdout == ""
    if number == signal.SIGKILL:
        assert (process.returncode, stderr) == (-number, "")
    else:
        assert process.returncode == 128 + number
        assert stderr == "Interrupted; the segments that were found are kept for the next time\n"
    assert wait_until(lambda: not processes_of(process.pid), SECONDS_TO_END), processes_of(process.pid)
    assert model.read_text() == "old model"
    assert report.read_text() == "old report"
    assert not list(tmp_path.glob(".shapeconcepts-*"))
