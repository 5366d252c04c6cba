"""The server of the explorer: what it tells, what it refuses, and that nothing it acknowledged is lost."""

import http.client
import json
import os
import random
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

import shapeconcepts as sc
from shapeconcepts.explorer import previews
from shapeconcepts.explorer.server import ExplorerServer
from shapeconcepts.explorer.session import Session
from shapeconcepts.explorer.telling import Telling
from shapeconcepts.io.write_pcd import write_pcd

# Of a process that runs an explorer; more where somebody asks for more.
N_KILLS = int(os.environ.get("SHAPECONCEPTS_KILLS", "3"))
HOSTILE = '<script>alert(1)</script>\x1b[31m\n"&\u202e'


class Client:
    """Whoever speaks to the server."""

    def __init__(self, address: str) -> None:
        parts = urlsplit(address)
        self.address, self.host, self.port, self.path = address, parts.netloc, parts.port or 0, parts.path

    def ask(
        self, method: str, path: str, body: bytes | None = None, **headers: str
    ) -> tuple[int, dict[str, str], bytes]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, body, {"Host": self.host, **named})
        answer = connection.getresponse()
        found = answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read()
        connection.close()
        return found

    def get(self, path: str) -> Any:
        status, _, body = self.ask("GET", self.path + path)
        assert status == 200, body
        return json.loads(body)

    def post(self, path: str, document: object) -> tuple[int, Any]:
        body = json.dumps(document).encode()
        status, _, answer = self.ask("POST", self.path + path, body, Content_Type="application/json")
        return status, json.loads(answer)

    def edit(self, **document: object) -> dict[str, Any]:
        status, state = self.post("api/edit", document)
        assert status == 200, state
        return state

    def refusal(self, path: str, document: object) -> str:
        status, answer = self.post(path, document)
        assert status == 400
        return str(answer["error"])


@contextmanager
def served(model: Path, *places: Path) -> Iterator[tuple[Client, Session]]:
    session = Session(model, places, {})
    telling = Telling(session, remember=False)
    server = ExplorerServer(telling)
    server.start()

    def keep_up() -> None:
        session.open()
        while session.wait():
            session.keep_up()

    thread = threading.Thread(target=keep_up)
    thread.start()
    try:
        assert session.shown is not None
        yield Client(server.address), session
    finally:
        session.close()
        thread.join()
        server.stop()
        telling.close()


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with scans and a model of them."""
    folder = tmp_path_factory.mktemp("explorer")
    for scan in sc.datasets.simulate(8, categories=("ball", "box", "can")):
        path = folder / "scans" / str(scan.label) / f"{scan.name}.pcd"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_pcd(path, scan)
    (folder / "scans/ball/broken.pcd").write_bytes((folder / "scans/ball/ball_0.pcd").read_bytes())
    sc.ShapeConceptModel(filtration=sc.Filtration(granularity=0.1)).fit(sc.read_scans(folder / "scans")).save(
        folder / "m.safetensors"
    )
    (folder / "scans/ball/broken.pcd").write_bytes(b"no scan")
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    """One for the test alone."""
    return Path(shutil.copytree(made, tmp_path / "own"))


@pytest.fixture
def client(folder: Path) -> Iterator[Client]:
    with served(folder / "m.safetensors", folder / "scans") as (client, _):
        yield client


@pytest.fixture(scope="module")
def reading(made: Path) -> Iterator[Client]:
    """For tests that change nothing."""
    with served(made / "m.safetensors", made / "scans") as (client, _):
        yield client


def until(question: Any, seconds: float = 20.0) -> Any:
    end = time.monotonic() + seconds
    while not (answer := question()):
        assert time.monotonic() < end
        time.sleep(0.05)
    return answer


# What it tells.


def test_the_page_is_one_document_that_fetches_from_here_alone(reading: Client) -> None:
    status, headers, body = reading.ask("GET", reading.path)
    assert status == 200 and body.startswith(b"<!doctype html>")
    policy = headers["content-security-policy"]
    assert "default-src 'none'" in policy and "connect-src 'self'" in policy
    assert "frame-ancestors 'none'" in policy and "unsafe" not in policy
    assert headers["referrer-policy"] == "no-referrer" and headers["x-content-type-options"] == "nosniff"
    assert headers["cache-control"] == "no-store"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    assert not any(name.startswith("access-control") for name in headers)


def test_model_and_state_tell_of_the_same_scans(reading: Client) -> None:
    model, state = reading.get("api/model"), until(lambda: _settled(reading))
    n = len(model["scans"]["names"])
    assert n == 25 == len(state["conceptOfScan"]) == len(state["doubts"]) == len(state["pValues"])
    assert (
        model["title"] == "m.safetensors"
        and model["hasScans"]
        and model["labelNames"] == ["ball", "box", "can"]
    )
    assert len(model["treeGroupOfScan"]) == n and model["layouts"][0][0] == "folders"
    sizes = {one["key"]: one["size"] for one in state["concepts"]}
    assert {key: state["conceptOfScan"].count(key) for key in sizes} == sizes
    assert all(one["medoid"] in range(n) and one["suggested"].endswith("cm") for one in state["concepts"])
    assert state["question"]["kind"] == "name" and not state["canUndo"] and state["journal"] == []


def _settled(client: Client) -> dict[str, Any] | None:
    """The state once all that takes its time is found out."""
    state = client.get("api/state")
    named = all(one["suggested"] for one in state["concepts"])
    return state if state["doubts"] is not None and named else None


def test_previews_are_packed_in_the_order_asked_for(reading: Client) -> None:
    names = reading.get("api/model")["scans"]["names"]
    rows = [names.index("can/can_2.pcd"), names.index("ball/broken.pcd"), names.index("box/box_1.pcd")]
    status, _, body = reading.ask("GET", f"{reading.path}api/previews?rows={','.join(map(str, rows))}")
    assert status == 200
    found, at = [], 0
    while at < len(body):
        row, n, zero, extent, spacing, *sides = struct.unpack_from("<IHHfffff", body, at)
        found.append((row, n))
        assert zero == 0 and (
            n == 0 or (0.01 < extent < 1 and 0 < spacing < extent and sides[0] >= sides[2] > 0)
        )
        at += 28 + 6 * n
    assert [row for row, _ in found] == rows
    assert found[1][1] == 0 and all(100 < n <= 300 for _, n in (found[0], found[2]))


def test_a_scan_tells_why_it_is_where_it_is(reading: Client) -> None:
    names = reading.get("api/model")["scans"]["names"]
    row = names.index("box/box_1.pcd")
    scan = reading.get(f"api/scan?row={row}")
    assert scan["preview"] and scan["segments"] >= 1 and scan["path"].endswith("box/box_1.pcd")
    assert scan["motifs"] and all(0 < one["stimulus"] <= 1 for one in scan["motifs"])
    assert all(one["row"] in range(25) for motif in scan["motifs"] for one in motif["reminds"])
    assert row not in [other for other, _ in scan["nearest"]]
    assert [far for _, far in scan["nearest"]] == sorted(far for _, far in scan["nearest"])
    assert 0 < scan["pValue"] <= 1 and scan["reason"] == ""


def test_a_scan_that_cannot_be_read_has_no_picture_but_a_reason(reading: Client) -> None:
    row = reading.get("api/model")["scans"]["names"].index("ball/broken.pcd")
    scan = reading.get(f"api/scan?row={row}")
    assert scan["preview"] is None and "broken.pcd" in scan["reason"] and scan["nearest"]


def test_without_scans_there_is_all_but_pictures(made: Path, tmp_path: Path) -> None:
    shutil.copy(made / "m.safetensors", tmp_path / "m.safetensors")
    with served(tmp_path / "m.safetensors") as (client, _):
        assert not client.get("api/model")["hasScans"]
        scan = client.get("api/scan?row=3")
        assert scan["preview"] is None and "no folder of scans is given" in scan["reason"] and scan["nearest"]
        assert client.edit(kind="confirm", scans=[3])["canUndo"]


def test_figures_are_those_of_the_report(client: Client) -> None:
    before = client.get("api/figures")
    assert before["filtration"]["edges"] and len(before["scans"]["names"]) == 25
    first = client.get("api/state")["concepts"][0]
    client.edit(kind="rename", key=first["key"], name="first")
    assert "first" in [one["name"] for one in client.get("api/figures")["concepts"]]


# What can be said.


def test_every_edit_changes_the_state_and_stays(folder: Path) -> None:
    with served(folder / "m.safetensors", folder / "scans") as (client, _):
        a, b, *_ = client.get("api/state")["concepts"]
        state = client.edit(kind="rename", key=a["key"], name=HOSTILE)
        assert state["concepts"][0]["name"] == HOSTILE
        state = client.edit(kind="merge", keys=[a["key"], b["key"]], name="both")
        assert state["concepts"][0]["size"] == a["size"] + b["size"]
        state = client.edit(kind="split", key=state["concepts"][0]["key"])
        rows = [row for row, key in enumerate(state["conceptOfScan"]) if key == a["key"]]
        state = client.edit(kind="move", scans=rows[:2], key=None, name="odd")
        odd = next(one for one in state["concepts"] if one["name"] == "odd")
        assert odd["size"] == 2 and odd["nNamed"] == 2
        assert client.edit(kind="foreign", scans=rows[2:3])["foreign"] == rows[2:3]
        assert client.edit(kind="link", scans=[rows[0], rows[3]], together=True)["links"] == [
            [rows[0], rows[3], True]
        ]
        client.edit(kind="confirm", scans=[rows[0]])
        state = client.edit(kind="recut", granularity=0.02)
        assert state["granularity"] == 0.02
        undone = client.edit(kind="undo")
        assert undone["canRedo"] and undone["journal"][-1]["undone"]
        assert client.edit(kind="redo")["conceptOfScan"] == state["conceptOfScan"]
        before = client.get("api/state")
    with served(folder / "m.safetensors") as (client, _):
        after = client.get("api/state")
    for name in ("concepts", "conceptOfScan", "foreign", "journal", "links"):
        strip = [
            {**one, "suggested": "", "doubtful": 0} if isinstance(one, dict) and "medoid" in one else one
            for one in before[name]
        ]
        again = [
            {**one, "suggested": "", "doubtful": 0} if isinstance(one, dict) and "medoid" in one else one
            for one in after[name]
        ]
        assert strip == again


@pytest.mark.parametrize(
    ("document", "reason"),
    [
        ([], "must be an object"),
        ({}, "kind must be one of"),
        ({"kind": "destroy"}, "kind must be one of"),
        ({"kind": ["undo"]}, "kind must be one of"),
        ({"kind": "rename", "name": "a"}, "needs key"),
        ({"kind": "rename", "key": "0", "name": "a"}, "must be the key"),
        ({"kind": "rename", "key": True, "name": "a"}, "must be the key"),
        ({"kind": "rename", "key": 99, "name": "a"}, "must be one of the keys"),
        ({"kind": "rename", "key": 0, "name": "a" * 1001}, "up to 1000"),
        ({"kind": "rename", "key": 0, "name": "a", "path": "/etc"}, "does not take 'path'"),
        ({"kind": "merge", "keys": [0]}, "at least two"),
        ({"kind": "split", "key": 0, "scans": ["../x"]}, "whole numbers"),
        ({"kind": "move", "scans": [10**30], "key": 0}, "rows from 0"),
        ({"kind": "move", "scans": [], "key": 0}, "at least one"),
        ({"kind": "link", "scans": [1], "together": True}, "two"),
        ({"kind": "recut", "granularity": float("nan")}, "granularity"),
        ({"kind": "recut", "granularity": "fine"}, "must be a number"),
        ({"kind": "propagate", "rate": 2}, "rate"),
        ({"kind": "undo"}, "nothing to undo"),
    ],
)
def test_what_cannot_be_said_is_refused_and_changes_nothing(
    reading: Client, document: object, reason: str
) -> None:
    before = reading.get("api/state")["conceptOfScan"]
    assert reason in reading.refusal("api/edit", document)
    state = reading.get("api/state")
    assert state["conceptOfScan"] == before and state["nEdits"] == 0


def test_what_cannot_be_written_is_not_said(folder: Path) -> None:
    with served(folder / "m.safetensors") as (client, _session):
        client.edit(kind="confirm", scans=[0])
        (folder / "m.safetensors.journal").unlink()
        (folder / "m.safetensors.journal").mkdir()
        refusal = client.refusal("api/edit", {"kind": "confirm", "scans": [1]})
        assert "m.safetensors.journal" in refusal
        (folder / "m.safetensors.journal").rmdir()


# Several at a time.


def listening(client: Client) -> tuple[socket.socket, Any]:
    connection = socket.create_connection(("127.0.0.1", client.port), timeout=20)
    connection.sendall(f"GET {client.path}api/events HTTP/1.1\r\nHost: {client.host}\r\n\r\n".encode())
    return connection, connection.makefile("rb")


def test_every_window_is_told_of_an_edit_within_a_second(client: Client) -> None:
    until(lambda: _settled(client))
    ears = [listening(client) for _ in range(2)]
    versions = [_version(file) for _, file in ears]
    start = time.monotonic()
    state = client.edit(kind="confirm", scans=[0])
    for (_, file), before in zip(ears, versions, strict=True):
        assert before < _version(file) <= state["version"]
    assert time.monotonic() - start < 1
    for connection, file in ears:
        file.close()
        connection.close()


def _version(file: Any) -> int:
    while True:
        line = file.readline()
        assert line
        if line.startswith(b"data: "):
            return int(line[6:])


def test_edits_of_two_windows_are_all_there(client: Client) -> None:
    state = client.get("api/state")
    rows = [row for row, key in enumerate(state["conceptOfScan"]) if key >= 0]

    def say(some: list[int]) -> None:
        for row in some:
            client.edit(kind="confirm", scans=[row])

    threads = [threading.Thread(target=say, args=(rows[start::2],)) for start in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    journal = client.get("api/state")["journal"]
    assert [edit["number"] for edit in journal] == list(range(1, len(rows) + 1))


def test_what_another_process_writes_is_taken(folder: Path) -> None:
    path = folder / "m.safetensors"
    with served(path, folder / "scans") as (client, _):
        client.edit(kind="confirm", scans=[0])
        other = sc.load_model(path)
        other.rename(other.concepts_[0], "by another")
        other.write_journal(path)
        until(lambda: client.get("api/state")["concepts"][0]["name"] == "by another")
        # A model that learned on; edits stay.
        other = sc.load_model(path)
        other.partial_fit([sc.datasets.simulate_scan("can", 30)])
        other.save(path)
        until(lambda: len(client.get("api/state")["conceptOfScan"]) == 26)
        state = client.get("api/state")
        assert state["nEdits"] == 2 and state["modelVersion"] == client.get("api/model")["modelVersion"]
        # Half a copy: the one that was read stays, and why is told.
        path.write_bytes(path.read_bytes()[:1000])
        until(lambda: "m.safetensors" in client.get("api/state")["trouble"])
        assert len(client.get("api/state")["conceptOfScan"]) == 26


def test_a_second_explorer_of_a_model_is_refused(folder: Path) -> None:
    path = folder / "m.safetensors"
    with served(path) as (_, _), pytest.raises(sc.ModelError, match="another explorer"):
        Session(path, (), {}).open()
    assert not list(folder.glob(".*.lock"))


def test_the_previews_asked_for_last_are_made_first_and_each_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(previews, "cpu_count", lambda: 1)
    begun, order, may_go_on = threading.Event(), [], threading.Event()

    def made(row: int) -> bytes:
        begun.set()
        assert may_go_on.wait(20)
        order.append(row)
        if row == 7:
            raise RuntimeError("no picture")
        return b"%d" % row

    maker = previews.Previews(lambda row: b"kept" if row == 9 else None, made)
    first = maker.of(0)
    assert begun.wait(20)
    waiting = {row: maker.of(row) for row in (1, 2, 7, 3)}
    assert maker.of(1) is waiting[1] and maker.of(9).result(0) == b"kept"
    may_go_on.set()
    assert [first.result(20), *(waiting[row].result(20) for row in (1, 2, 3))] == [b"0", b"1", b"2", b"3"]
    assert isinstance(waiting[7].exception(20), RuntimeError)
    assert order == [0, 1, 3, 7, 2]
    maker.forget()
    assert maker.of(1).result(20) == b"1" and order.count(1) == 2
    maker.close()


# What is refused.


def test_nobody_without_the_token_is_answered(reading: Client) -> None:
    token = reading.path.strip("/")
    wrong = [
        "/",
        "/api/state",
        f"/{token[:-1]}/",
        f"/{token}x/api/state",
        f"/{token}",
        f"//{token}/",
        "/%00/",
    ]
    for path in [*wrong, f"/{'a' * len(token)}/api/model", f"/{token.upper()}/"]:
        status, _, body = reading.ask("GET", path)
        assert (status, body) == (404, b""), path


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:80", "127.0.0.1", "127.0.0.2:{port}", "[::1]:{port}", ""]
)
def test_another_host_is_refused(reading: Client, host: str) -> None:
    status, _, body = reading.ask("GET", reading.path, Host=host.format(port=reading.port))
    assert (status, body) == (403, b"")


def test_localhost_is_this_host(reading: Client) -> None:
    assert reading.ask("GET", reading.path, Host=f"localhost:{reading.port}")[0] == 200


def test_another_origin_cannot_edit(reading: Client) -> None:
    body, path = b'{"kind": "confirm", "scans": [0]}', f"{reading.path}api/edit"
    kind = {"Content_Type": "application/json"}
    for origin in ("http://evil.example", "null", f"https://127.0.0.1:{reading.port}", "http://127.0.0.1:1"):
        assert reading.ask("POST", path, body, **kind, Origin=origin)[0] == 403
    # What a form of another page can send.
    for other in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data", ""):
        assert reading.ask("POST", path, body, Content_Type=other)[0] == 415
    assert reading.ask("OPTIONS", path, Origin="http://evil.example")[0] == 405
    assert reading.get("api/state")["nEdits"] == 0


def test_its_own_origin_can_edit(client: Client) -> None:
    body = b'{"kind": "confirm", "scans": [0]}'
    own = {"Content_Type": "application/json; charset=utf-8", "Origin": f"http://127.0.0.1:{client.port}"}
    assert client.ask("POST", f"{client.path}api/edit", body, **own)[0] == 200


def test_large_requests_are_refused_before_they_are_read(reading: Client) -> None:
    path = f"{reading.path}api/edit"
    for head, body in (
        (b"Content-Length: 10000000", b"x" * 10_000_000),
        (
            b"Transfer-Encoding: chunked",
            b"".join(b"186A0\r\n" + b"x" * 100_000 + b"\r\n" for _ in range(100)),
        ),
    ):
        with socket.create_connection(("127.0.0.1", reading.port), timeout=20) as connection:
            connection.sendall(
                f"POST {path} HTTP/1.1\r\nHost: {reading.host}\r\nContent-Type: application/json\r\n".encode()
                + head
                + b"\r\n\r\n"
            )
            with suppress(OSError):
                connection.sendall(body)
            try:
                answer = connection.recv(100)
            except ConnectionResetError:
                answer = b"HTTP/1.1 413"
            assert answer.startswith(b"HTTP/1.1 413")
    assert reading.get("api/state")["nEdits"] == 0


@pytest.mark.parametrize(
    "path",
    [
        "api/previews?rows=",
        "api/previews?rows=-1",
        "api/previews?rows=25",
        "api/previews?rows=1e3",
        "api/previews?rows=" + ",".join(["1"] * 65),
        "api/previews?rows=../../etc/passwd",
        "api/previews?rows=%D9%A3",
        "api/scan",
        "api/scan?row=99999999999999999999",
        "api/scan?row=x",
    ],
)
def test_what_is_no_scan_is_refused(reading: Client, path: str) -> None:
    status, _, body = reading.ask("GET", reading.path + path)
    assert status == 400 and json.loads(body)["error"]


@pytest.mark.parametrize(
    "path", ["api/", "api/secret", "../m.safetensors", "%2e%2e/m.safetensors", "static/x", "docs"]
)
def test_there_is_nothing_else(reading: Client, path: str) -> None:
    assert reading.ask("GET", reading.path + path)[0] == 404


def test_bodies_that_are_no_json_are_refused(reading: Client) -> None:
    for body in (b"", b"{", b"\xff\xfe", b"[" * 100_000, b'"undo"'):
        status, _, answer = reading.ask(
            "POST", f"{reading.path}api/edit", body, Content_Type="application/json"
        )
        assert status == 400 and json.loads(answer)["error"]


def test_files_outside_of_the_folder_are_not_read(folder: Path, tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (folder / "scans/can/can_2.pcd").rename(outside / "can_2.pcd")
    (folder / "scans/can/can_2.pcd").symlink_to(outside / "can_2.pcd")
    (folder / "scans/box").rename(outside / "box")
    (folder / "scans/box").symlink_to(outside / "box")
    with served(folder / "m.safetensors", folder / "scans") as (client, _):
        names = client.get("api/model")["scans"]["names"]
        for name in ("can/can_2.pcd", "box/box_1.pcd"):
            scan = client.get(f"api/scan?row={names.index(name)}")
            assert scan["preview"] is None and "out of the folder" in scan["reason"]
        assert client.get(f"api/scan?row={names.index('can/can_3.pcd')}")["preview"]
        # Nor do they leave with a data set.
        _, written = client.post("api/export", {"layout": "folders", "name": "within"})
        assert not [
            path for path in (folder / "within").rglob("*") if path.name in ("can_2.pcd", "box_1.pcd")
        ]
        assert sum("out of the folder" in reason for reason in written["skipped"]) == 9


# What is left.


def test_the_corrected_data_set_and_its_report_are_written_beside_the_model(
    client: Client, folder: Path
) -> None:
    first = client.get("api/state")["concepts"][0]
    client.edit(kind="rename", key=first["key"], name="first")
    status, written = client.post("api/export", {"layout": "folders", "name": "data"})
    assert status == 200 and written["written"] == 24 and written["missing"] == []
    assert len(written["skipped"]) == 1 and "broken" in written["skipped"][0]
    assert (folder / "data" / "first").is_dir() and written["path"] == str(folder / "data")
    status, written = client.post("api/export", {"layout": "csv", "name": "table"})
    assert status == 200 and (folder / "table.csv").read_text().count("\n") == 26
    status, written = client.post("api/report", {"name": "page"})
    assert status == 200 and written["written"] == 24 and (folder / "page.html").stat().st_size > 50_000
    assert "is there already" in client.refusal("api/report", {"name": "page.html"})
    assert "is there already" in client.refusal("api/export", {"layout": "folders", "name": "data"})


@pytest.mark.parametrize(
    "name",
    [
        "",
        ".",
        "..",
        "../x",
        "/tmp/x",
        "a/b",
        "a\\b",
        ".hidden",
        "a\nb",
        "C:x",
        7,
        None,
        "x" * 300,
        "a\u202eb",
    ],
)
def test_names_that_lead_elsewhere_are_refused(reading: Client, name: object) -> None:
    assert "name must" in reading.refusal("api/export", {"layout": "csv", "name": name})
    assert "name must" in reading.refusal("api/report", {"name": name})
    assert "layout must" in reading.refusal("api/export", {"layout": "zip", "name": "x"})


# The command.


def command(*arguments: object, cache: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "shapeconcepts", "explore", *map(str, arguments), "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "XDG_CACHE_HOME": str(cache)},
    )


def first_line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    return process.stdout.readline().strip()


def test_a_signal_ends_the_command_and_edits_stay(folder: Path, tmp_path: Path) -> None:
    process = command(folder / "m.safetensors", "--scans", folder / "scans", cache=tmp_path / "cache")
    client = Client(first_line(process))
    assert client.ask("GET", client.path)[0] == 200
    client.edit(kind="confirm", scans=[0])
    until(lambda: _settled(client))
    client.ask("GET", f"{client.path}api/previews?rows=0,1,2")
    time.sleep(1.2)
    process.send_signal(signal.SIGINT)
    assert process.wait(10) == 130
    assert not list(folder.glob(".*"))
    assert len(sc.load_model(folder / "m.safetensors").journal) == 1

    # What was shown is there before the model is read, and an edit waits for it.
    process = command(folder / "m.safetensors", "--scans", folder / "scans", cache=tmp_path / "cache")
    client = Client(first_line(process))
    state = client.get("api/state")
    assert state["nEdits"] == 1 and state["doubts"] and state["concepts"][0]["suggested"]
    assert len(client.ask("GET", f"{client.path}api/previews?rows=0,1,2")[2]) > 1000
    assert client.edit(kind="undo")["canRedo"]
    process.send_signal(signal.SIGTERM)
    assert process.wait(10) == 143


def test_nothing_that_was_acknowledged_is_lost_by_a_kill(folder: Path, tmp_path: Path) -> None:
    chance = random.Random(0)
    path, acknowledged = folder / "m.safetensors", 0
    for _ in range(N_KILLS):
        process = command(path, cache=tmp_path / "cache")
        client = Client(first_line(process))
        n_before = client.edit(kind="rename", key=0, name="begin")["nEdits"]
        assert n_before >= acknowledged
        said = [n_before]
        killer = threading.Timer(chance.random() * 0.5, process.kill)
        killer.start()
        try:
            while True:
                said.append(client.edit(kind="rename", key=0, name=f"{len(said)}")["nEdits"])
        except (OSError, http.client.HTTPException):
            pass
        process.wait()
        journal = sc.load_model(path).journal
        acknowledged = len(journal)
        # What was being said at the end may be there, too.
        assert said[-1] <= acknowledged <= said[-1] + 1


def test_the_command_says_what_is_wrong(folder: Path, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        process = command(folder / "m.safetensors", "--port", port, cache=tmp_path)
        _, said = process.communicate()
    assert process.returncode == 1 and f"port {port} is taken" in said
    (folder / "none.safetensors").write_bytes(b"no model")
    for arguments, reason in (
        (["nothing.safetensors"], "there is no such file"),
        ([folder / "none.safetensors"], "none.safetensors"),
        ([folder / "m.safetensors", "--scans", folder / "nowhere"], "there is no such file or folder"),
    ):
        process = command(*arguments, cache=tmp_path)
        _, said = process.communicate()
        assert process.returncode == 1 and reason in said and "Traceback" not in said
