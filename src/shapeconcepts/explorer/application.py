"""What the server answers to each request."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from shapeconcepts.explorer.edits import edit_of
from shapeconcepts.explorer.page import explorer_page

if TYPE_CHECKING:
    from shapeconcepts.explorer.session import Session

_MOST_ROWS = 64
_Answer = Callable[["Session", Request], Awaitable[Response]]


def application(session: Session) -> Starlette:
    """The application of a session; who may ask is looked at before, see `Guard`."""

    def route(path: str, answer: _Answer, method: str = "GET") -> Route:
        async def endpoint(request: Request) -> Response:
            if not session.is_ready and path not in _AT_ONCE:
                return JSONResponse({"status": "reading"}, 503)
            try:
                return await answer(session, request)
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


# Before the model is read.
_AT_ONCE = ("/", "/api/events")


async def _page(session: Session, request: Request) -> Response:
    content, policy = explorer_page()
    return Response(content, media_type="text/html", headers={"content-security-policy": policy})


async def _events(session: Session, request: Request) -> Response:
    return StreamingResponse(session.changes.events(), media_type="text/event-stream")


async def _model(session: Session, request: Request) -> Response:
    return _json(await run_in_threadpool(session.model_json))


async def _state(session: Session, request: Request) -> Response:
    return _json(await run_in_threadpool(session.state_json))


async def _figures(session: Session, request: Request) -> Response:
    return _json(await run_in_threadpool(session.figures_json))


async def _previews(session: Session, request: Request) -> Response:
    rows = _rows(session, request.query_params.get("rows", ""))
    if len(rows) > _MOST_ROWS:
        raise ValueError(f"rows must be up to {_MOST_ROWS}, got {len(rows)}")
    made = [asyncio.wrap_future(session.previews.of(row)) for row in rows]
    return Response(b"".join(await asyncio.gather(*made)), media_type="application/octet-stream")


async def _scan(session: Session, request: Request) -> Response:
    rows = _rows(session, request.query_params.get("row", ""))
    if len(rows) != 1:
        raise ValueError(f"row must be one, got {len(rows)}")
    return JSONResponse(await run_in_threadpool(session.scan, rows[0]))


async def _edit(session: Session, request: Request) -> Response:
    return _json(await run_in_threadpool(session.edit, edit_of(_document(await request.body()))))


async def _export(session: Session, request: Request) -> Response:
    from shapeconcepts.explorer.leaving import write_export

    given = _document(await request.body())
    work = partial(write_export, session, given.get("layout"), given.get("name"))
    return JSONResponse(await run_in_threadpool(work))


async def _report(session: Session, request: Request) -> Response:
    from shapeconcepts.explorer.leaving import write_report_of

    given = _document(await request.body())
    return JSONResponse(await run_in_threadpool(write_report_of, session, given.get("name")))


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


def _rows(session: Session, text: str) -> list[int]:
    """Numbers of scans, separated by commas."""
    parts = text.split(",")
    n_scans = len(session.shown.scan_names_)
    if not all(
        part.isascii() and part.isdecimal() and len(part) < 10 and int(part) < n_scans for part in parts
    ):
        raise ValueError(f"must be numbers of scans from 0 to {n_scans - 1}, got {text!r:.40}")
    return [int(part) for part in parts]
