"""What the server answers to each request."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from typing import TYPE_CHECKING, Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from shapeconcepts.explorer.edits import edit_of
from shapeconcepts.explorer.page import explorer_page

if TYPE_CHECKING:
    from shapeconcepts.explorer.telling import Telling

_MOST_ROWS = 64
_Answer = Callable[["Telling", Request], Awaitable[Response]]


def application(telling: Telling) -> Starlette:
    """The application of a session; who may ask is looked at before, see `Guard`."""

    def route(path: str, answer: _Answer, method: str = "GET") -> Route:
        async def endpoint(request: Request) -> Response:
            try:
                return await answer(telling, request)
            except ValueError as error:
                return JSONResponse({"error": str(error)}, 400)

        return Route(path, endpoint, methods=[method])

    return Starlette(
        routes=[
            route("/", _page),
            route("/api/events", _events),
            route("/api/model", _model),
            route("/api/state", _state),
            route("/api/previews", _previews),
            route("/api/scan", _scan),
            route("/api/figures", _figures),
            route("/api/edit", _edit, "POST"),
            route("/api/export", _export, "POST"),
            route("/api/report", _report, "POST"),
        ]
    )


async def _page(telling: Telling, request: Request) -> Response:
    content, policy = explorer_page()
    return Response(content, media_type="text/html", headers={"content-security-policy": policy})


async def _events(telling: Telling, request: Request) -> Response:
    return StreamingResponse(telling.session.changes.events(), media_type="text/event-stream")


async def _model(telling: Telling, request: Request) -> Response:
    return await _once_there(telling, telling.model_json)


async def _state(telling: Telling, request: Request) -> Response:
    return await _once_there(telling, telling.state_json)


async def _once_there(telling: Telling, document: Callable[[], bytes]) -> Response:
    """What the page asks for first, until it is there."""
    if not telling.is_there:
        return JSONResponse({"status": "reading"}, 503)
    return _json(await run_in_threadpool(document))


async def _figures(telling: Telling, request: Request) -> Response:
    return _json(await run_in_threadpool(telling.figures_json))


async def _previews(telling: Telling, request: Request) -> Response:
    if not telling.is_there:
        return JSONResponse({"status": "reading"}, 503)
    rows = _rows(telling, request.query_params.get("rows", ""))
    if len(rows) > _MOST_ROWS:
        raise ValueError(f"rows must be up to {_MOST_ROWS}, got {len(rows)}")
    made = [asyncio.wrap_future(telling.preview(row)) for row in rows]
    return Response(b"".join(await asyncio.gather(*made)), media_type="application/octet-stream")


async def _scan(telling: Telling, request: Request) -> Response:
    text = request.query_params.get("row", "")
    return JSONResponse(await run_in_threadpool(lambda: telling.scan(*_rows(telling, text)[:1])))


async def _edit(telling: Telling, request: Request) -> Response:
    edit = edit_of(_document(await request.body()))

    def state_after() -> bytes:
        telling.session.edit(edit)
        return telling.state_json()

    return _json(await run_in_threadpool(state_after))


async def _export(telling: Telling, request: Request) -> Response:
    given = _document(await request.body())

    def written() -> dict[str, Any]:
        from shapeconcepts.explorer.leaving import write_export

        return write_export(telling.session, given.get("layout"), given.get("name"))

    return JSONResponse(await run_in_threadpool(written))


async def _report(telling: Telling, request: Request) -> Response:
    given = _document(await request.body())

    def written() -> dict[str, Any]:
        from shapeconcepts.explorer.leaving import write_report_of

        return write_report_of(telling.session, given.get("name"))

    return JSONResponse(await run_in_threadpool(written))


def _json(content: bytes) -> Response:
    return Response(content, media_type="application/json")


def _document(body: bytes) -> Mapping[str, Any]:
    try:
        document = json.loads(body)
    except (ValueError, RecursionError):
        raise ValueError("what was sent is not valid JSON") from None
    if not isinstance(document, dict):
        raise ValueError("what was sent must be an object")
    return document


def _rows(telling: Telling, text: str) -> list[int]:
    """Numbers of scans, separated by commas."""
    parts = text.split(",")
    n_scans = telling.n_scans
    if not all(
        part.isascii() and part.isdecimal() and len(part) < 10 and int(part) < n_scans for part in parts
    ):
        raise ValueError(f"must be numbers of scans from 0 to {n_scans - 1}, got {text!r:.40}")
    return [int(part) for part in parts]
