"""Who is answered: the page itself, and whoever was told its address.

The address holds a token, and its host is this computer's: a page of another origin does not know the one and
is not at the other even where its own name leads here (DNS rebinding).
"""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]

MOST_BYTES = 1_000_000
_HEADERS = {
    b"referrer-policy": b"no-referrer",
    b"x-content-type-options": b"nosniff",
    b"cache-control": b"no-store",
    b"cross-origin-resource-policy": b"same-origin",
    b"cross-origin-opener-policy": b"same-origin",
}


class Guard:
    """Lets an application see only requests that may be answered, without the token in their paths.

    Parameters
    ----------
    application : callable
        As of ASGI.
    token : str
    port : int
    """

    def __init__(self, application: Application, token: str, port: int) -> None:
        self._application = application
        self._prefix = f"/{token}".encode()
        self._hosts = {f"{name}:{port}".encode() for name in ("127.0.0.1", "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._application(scope, receive, send)
            return
        send = _with_headers(send)
        headers = dict(scope["headers"])
        if refusal := self._refusal(scope, headers):
            await _answer(send, refusal)
            return
        inner = {**scope, "path": scope["path"][len(self._prefix) :]}
        if scope["method"] == "POST":
            body = await _body(headers, receive)
            if body is None:
                await _answer(send, 413)
                return
            receive = _replayed(body, receive)
        await self._application(inner, receive, send)

    def _refusal(self, scope: Scope, headers: dict[bytes, bytes]) -> int:
        """Status of a request that is not answered, 0 of one that is."""
        if scope["type"] != "http" or headers.get(b"host", b"").lower() not in self._hosts:
            return 403
        path = scope["path"].encode("utf-8", "surrogateescape")
        known, asked = self._prefix + b"/", path[: len(self._prefix) + 1]
        if not secrets.compare_digest(known, asked):
            return 404
        if scope["method"] in ("GET", "HEAD"):
            return 0
        if scope["method"] != "POST":
            return 405
        origin = headers.get(b"origin")
        if origin is not None and origin not in {b"http://" + host for host in self._hosts}:
            return 403
        kind = headers.get(b"content-type", b"").split(b";")[0].strip().lower()
        return 0 if kind == b"application/json" else 415


async def _body(headers: dict[bytes, bytes], receive: Receive) -> bytes | None:
    """What was sent; None where that is too much, of which no more is read then."""
    length = headers.get(b"content-length", b"0")
    if not length.isdigit() or int(length) > MOST_BYTES:
        return None
    body = b""
    while True:
        message = await receive()
        body += message.get("body", b"")
        if len(body) > MOST_BYTES:
            return None
        if not message.get("more_body", False):
            return body


def _replayed(body: bytes, receive: Receive) -> Receive:
    pending: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]

    async def next_message() -> Message:
        return pending.pop() if pending else await receive()

    return next_message


def _with_headers(send: Send) -> Send:
    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            message = {**message, "headers": [*message.get("headers", []), *_HEADERS.items()]}
        await send(message)

    return send_with_headers


async def _answer(send: Send, status: int) -> None:
    """A refusal says nothing more; what the client still sends is not read."""
    headers = [(b"content-length", b"0"), (b"connection", b"close")]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": b""})
