"""The explorer's server: it listens on this computer alone, and answers before the model is read."""

from __future__ import annotations

import secrets
import socket
from threading import Thread
from typing import TYPE_CHECKING

import uvicorn

from shapeconcepts.explorer.access import Guard
from shapeconcepts.explorer.application import application

if TYPE_CHECKING:
    from shapeconcepts.explorer.telling import Telling

_HOST = "127.0.0.1"


class ExplorerServer:
    """Serves what there is to tell of a model, in a thread of its own.

    Parameters
    ----------
    telling : Telling
    port : int
        0 for any that is free.

    Attributes
    ----------
    address : str
        What to open; whoever does not know it is refused.

    Raises
    ------
    OSError
        If the port is taken, or is not for this user.
    """

    def __init__(self, telling: Telling, port: int = 0) -> None:
        self._socket = socket.create_server((_HOST, port))
        port = self._socket.getsockname()[1]
        token = secrets.token_urlsafe(16)
        self.address = f"http://{_HOST}:{port}/{token}/"
        config = uvicorn.Config(
            Guard(application(telling), token, port),
            log_config=None,
            access_log=False,
            lifespan="off",
            server_header=False,
            ws="none",
            timeout_graceful_shutdown=1,
        )
        self._server = uvicorn.Server(config)
        self._thread = Thread(target=self._server.run, args=([self._socket],), name="server", daemon=True)

    def start(self) -> None:
        """Answer from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Answer no more."""
        self._server.should_exit = True
        self._thread.join()
        self._socket.close()
