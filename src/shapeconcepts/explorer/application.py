"""What the server answers to each request."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from shapeconcepts.explorer.page import explorer_page

if TYPE_CHECKING:
    from shapeconcepts.explorer.session import Session

_MOST_ROWS = 64


def application(session: Session) -> Starlette:
    """The application of a session; who may ask is looked at before, see `Guard`."""

    async def page(request: Request) -> Response:
        content, policy = explorer_page()
        return Response(content, media_type="text/html", headers={"content-security-policy": policy})

    async def model(request: Request) -> Response:
        return _json(await run_in_threadpool(session.model_json)) if session.is_ready else _reading(session)

    async def state(request: Request) -> Response:
        return _json(await run_in_threadpool(session.state_json)) if session.is_ready else _reading(session)

    async def events(request: Request) -> Response:
        return StreamingResponse(session.changes.events(), media_type="text/event-stream")

    async def previews(request: Request) -> Response:
        if not session.is_ready:
            return _reading(session)
        rows = _rows(request.query_params.get("rows", ""), session.n_scans)
        if rows is None or len(rows) > _MOST_ROWS:
            return _refused(f"rows must be up to {_MOST_ROWS} numbers of scans")
        made = [asyncio.wrap_future(session.previews.of(row)) for row in rows]
        return Response(b"".join(await asyncio.gather(*made)), media_type="application/octet-stream")

    async def scan(request: Request) -> Response:
        if not session.is_ready:
            return _reading(session)
        rows = _rows(request.query_params.get("row", ""), session.n_scans)
        if rows is None or len(rows) != 1:
            return _refused("row must be the number of a scan")
        return JSONResponse(await run_in_threadpool(session.scan, rows[0]))

    async def edit(request: Request) -> Response:
        return _refused("edits are not there yet", 501)

    return Starlette(
        routes=[
            Route("/", page),
            Route("/api/model", model),
            Route("/api/state", state),
            Route("/api/events", events),
            Route("/api/previews", previews),
            Route("/api/scan", scan),
            Route("/api/edit", edit, methods=["POST"]),
        ]
    )


def _json(content: bytes) -> Response:
    return Response(content, media_type="application/json")


def _reading(session: Session) -> Response:
    return JSONResponse({"status": "reading"}, 503)


def _refused(reason: str, status: int = 400) -> Response:
    return JSONResponse({"error": reason}, status)


def _rows(text: str, n_scans: int) -> list[int] | None:
    """Numbers of scans, separated by commas; None where there is anything else."""
    parts = text.split(",")
    if not all(part.isascii() and part.isdecimal() and len(part) < 10 for part in parts):
        return None
    rows = [int(part) for part in parts]
    return rows if all(row < n_scans for row in rows) else None
