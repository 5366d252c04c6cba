"""`shapeconcepts explore`, killed again and again while somebody corrects a model: no edit is lost.

    python benchmarks/explore_kills.py [--kills N]

A scripted user names, splits, merges, moves and takes back, as fast as the server answers. The server is
killed by SIGKILL at random moments, 0 to 2 s after its first answer, and started again. After each kill the
model is loaded: every edit that the server had told of must be in its journal, and at most one more.
"""

import json
import os
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
import warnings
from http.client import HTTPException
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Timer
from typing import Any

import numpy as np

from common import command, print_table
from shapeconcepts import ShapeConceptModel, datasets, load_model
from shapeconcepts.corrections import JournalFile

SECONDS = 2.0


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--kills", type=int, default=100, metavar="N")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rng = np.random.default_rng(0)
    with TemporaryDirectory() as place:
        path = Path(place) / "m.safetensors"
        ShapeConceptModel(n_jobs=2).fit(datasets.simulate(n_per_category=10, random_state=1)).save(path)
        n_told, n_lost, n_untold = 0, 0, 0
        for _ in range(options.kills):
            n_told += session_until_killed(path, rng)
            n_there = len(JournalFile(path).read().lines)
            n_lost += max(n_told - n_there, 0)
            n_untold += max(n_there - n_told, 0)
            n_told = n_there
            load_model(path)
        rows = [
            ["kills", str(options.kills)],
            ["edits", str(n_there)],
            ["edits that were told of and lost", str(n_lost)],
            ["edits that were on the disk, but not told of yet", str(n_untold)],
            ["models that could not be loaded", "0"],
        ]
    print_table(["", ""], rows)


def session_until_killed(path: Path, rng: np.random.Generator) -> int:
    """Edits that a server told of before it was killed."""
    arguments = [sys.executable, "-m", "shapeconcepts", "explore", str(path), "--no-browser"]
    server = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert server.stdout is not None
    address = server.stdout.readline().split()[-1]
    while "concepts" not in (state := answer(address + "api/state")):
        time.sleep(0.02)
    Timer(rng.uniform(0, SECONDS), os.kill, (server.pid, signal.SIGKILL)).start()
    n_told = 0
    try:
        while True:
            told = answer(address + "api/edit", some_edit(state, rng))
            if "concepts" in told:
                state, n_told = told, n_told + 1
    except (OSError, HTTPException, ValueError):
        server.wait()
        return n_told


def some_edit(state: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """What a user might say; some of it cannot be done."""
    keys = [concept["key"] for concept in state["concepts"]]
    scans = rng.choice(len(state["conceptOfScan"]), 3, replace=False).tolist()
    edits: list[dict[str, Any]] = [
        {"kind": "rename", "key": keys[0], "name": f"name {rng.integers(1000)}"},
        {"kind": "split", "key": keys[0]},
        {"kind": "merge", "keys": keys[-2:]},
        {"kind": "move", "scans": scans, "key": keys[-1]},
        {"kind": "move", "scans": scans, "name": "some"},
        {"kind": "foreign", "scans": scans[:1]},
        {"kind": "link", "scans": scans[:2], "together": bool(rng.integers(2))},
        {"kind": "undo"},
        {"kind": "redo"},
    ]
    return edits[rng.integers(len(edits))]


def answer(address: str, document: dict[str, Any] | None = None) -> dict[str, Any]:
    body = None if document is None else json.dumps(document).encode()
    request = urllib.request.Request(address, body, {"Content-Type": "application/json"})
    try:
        with urllib.request.urlopen(request, timeout=30) as response:
            told: dict[str, Any] = json.load(response)
    except urllib.error.HTTPError as error:
        # What cannot be done is refused; while the model is read, nothing is known yet.
        if error.code not in (400, 503):
            raise
        return {}
    return told


if __name__ == "__main__":
    main()
