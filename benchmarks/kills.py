"""What `learn` leaves behind when it is interrupted or killed at random moments.

    python benchmarks/kills.py [--kills N] [--seed S]

Each `learn` replaces a model and a report. SIGINT, SIGTERM or SIGKILL come at a random moment of the time
that it takes, to the command alone or to its whole group, as a terminal does it, with 1, 2 and 6 jobs
(threads up to 4, processes above); every eighth has to compile its kernels first. Then each file must be the
old or the new one, whole, and both of one age; the exit status 130, 143 or that of SIGKILL; and no process be
left after 5 seconds. `late` are those that had finished before.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from common import command, print_table
from shapeconcepts import datasets, load_model
from shapeconcepts.io.write_pcd import write_pcd

JOBS = (1, 2, 6)
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
SECONDS_TO_END = 5
SECONDS_TO_HANG = 30
COMPILING = 8


def start(folder: Path, jobs: int, cache: Path | None) -> subprocess.Popen[str]:
    outputs = ["--model", folder / "m", "--report", folder / "r.html"]
    kernels = {} if cache is None else {"NUMBA_CACHE_DIR": str(cache)}
    return subprocess.Popen(
        [sys.executable, "-m", "shapeconcepts", "learn", folder / "scans", *outputs, "--jobs", str(jobs)],
        env={**os.environ, "XDG_CACHE_HOME": str(folder), **kernels},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def is_left(session: int) -> bool:
    command = ["ps", "-o", "stat=", "-s", str(session)]
    found = subprocess.run(command, capture_output=True, text=True).stdout.split()
    return any(state[0] != "Z" for state in found)


def kill(folder: Path, jobs: int, number: int, to_group: bool, delay: float, cache: Path | None) -> list[str]:
    """What is wrong after one kill; "late" if it came too late."""
    model, report = folder / "m", folder / "r.html"
    before = model.stat().st_ino, report.stat().st_ino
    process = start(folder, jobs, cache)
    time.sleep(delay)
    late = process.poll() is not None
    if not late:
        (os.killpg if to_group else os.kill)(process.pid, number)
    wrong = []
    try:
        _, said = process.communicate(timeout=SECONDS_TO_HANG)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        return ["hangs"]
    late = late or process.returncode == 0
    # Before Python has begun to run the command, and after it has ended, the system ends it.
    if not late and process.returncode not in (128 + number, -number):
        wrong.append(f"exit status {process.returncode}")
    # It may have said all it had to say before.
    said = said.removesuffix("\n").rpartition("\n")[2]
    if number != signal.SIGKILL and said and not said.startswith(("Interrupted", "Wrote", "Learned")):
        wrong.append(f"says: {said}")
    deadline = time.monotonic() + SECONDS_TO_END
    while is_left(process.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    if is_left(process.pid):
        wrong.append("processes left")
        os.killpg(process.pid, signal.SIGKILL)
    load_model(model)
    if not report.read_text().rstrip().endswith("</html>"):
        wrong.append("report cut short")
    after = model.stat().st_ino, report.stat().st_ino
    if (before[0] == after[0]) != (before[1] == after[1]):
        wrong.append("model and report of two ages")
    left_over = [path for path in folder.iterdir() if path.name.startswith(".shapeconcepts-")]
    for path in left_over:
        path.unlink()
    if left_over and number != signal.SIGKILL:
        wrong.append("half a file left")
    return [*wrong, *["late"] * late]


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--kills", type=int, default=200, metavar="N", help="default: 200")
    parser.add_argument("--seed", type=int, default=0, metavar="S")
    options = parser.parse_args()
    generator = random.Random(options.seed)
    counts: dict[tuple[int, str], Counter[str]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for scan in datasets.simulate(3, categories=["ball", "box", "can"]):
            path = folder / "scans" / str(scan.label) / f"{scan.name}.pcd"
            path.parent.mkdir(parents=True, exist_ok=True)
            write_pcd(path, scan)
        seconds = {}
        for jobs in JOBS:
            for _ in range(2):
                began = time.perf_counter()
                process = start(folder, jobs, None)
                said = process.communicate()[1]
                if process.returncode:
                    parser.error(said)
            seconds[jobs] = time.perf_counter() - began
        for count in range(options.kills):
            jobs, number = generator.choice(JOBS), generator.choice(SIGNALS)
            to_group, delay = generator.random() < 0.5, generator.random() * seconds[jobs]
            with tempfile.TemporaryDirectory() as empty:
                cache = Path(empty) if count % COMPILING == 0 else None
                # Every other one segments its scans again.
                if count % 2:
                    subprocess.run(["rm", "-rf", folder / "shapeconcepts"], check=True)
                wrong = kill(folder, jobs, number, to_group, delay, cache)
            row = counts.setdefault((jobs, signal.Signals(number).name), Counter())
            row["kills"] += 1
            row["late"] += "late" in wrong
            row["wrong"] += any(one != "late" for one in wrong)
            name = signal.Signals(number).name
            whom = "group" if to_group else "alone"
            said = ", ".join(wrong) or "fine"
            print(f"{count + 1}: {name} to {whom}, {jobs} jobs, after {delay:.2f} s: {said}", flush=True)
    print_table(
        ("jobs", "signal", "kills", "late", "wrong"),
        [[*key, row["kills"], row["late"], row["wrong"]] for key, row in sorted(counts.items())],
    )


if __name__ == "__main__":
    main()
