"""`shapeconcepts explore`: a model in the browser, to be looked at, named and corrected."""

from __future__ import annotations

import errno
import sys
import webbrowser
from threading import Thread
from typing import TYPE_CHECKING, Annotated

import typer

from shapeconcepts.cli.options import (
    DepthScale,
    Intrinsics,
    LearnedScans,
    Mask,
    ModelFile,
    Units,
    Up,
    read_options,
)
from shapeconcepts.cli.terminal import fail, tell
from shapeconcepts.interruption import say_when_interrupted

if TYPE_CHECKING:
    from shapeconcepts.explorer.session import Session
    from shapeconcepts.explorer.telling import Telling

_PACKAGES = {"starlette", "uvicorn"}


def explore(
    model: ModelFile,
    scans: LearnedScans = None,
    port: Annotated[
        int,
        typer.Option(min=0, max=65535, metavar="N", help="Port on this computer.", show_default="a free one"),
    ] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Only say the address.")] = False,
    intrinsics: Intrinsics = None,
    depth_scale: DepthScale = None,
    mask: Mask = None,
    units: Units = "auto",
    up: Up = None,
    no_cache: Annotated[
        bool,
        typer.Option("--no-cache", help="Do not keep what was shown in the user's cache for the next time."),
    ] = False,
) -> None:
    """Look at a model in the browser, name its concepts and correct them, until Ctrl-C.

    Each correction is on the disk before it is shown, in a journal beside the model: MODEL.journal. Only this
    computer is answered, at an address that nobody else knows.
    """
    if not model.is_file():
        fail(f"{model}: there is no such file")
    for place in scans or ():
        if not place.exists():
            fail(f"{place}: there is no such file or folder")
    reading = read_options(intrinsics, depth_scale, mask, units, up)
    try:
        from shapeconcepts.explorer.server import ExplorerServer
        from shapeconcepts.explorer.session import Session
        from shapeconcepts.explorer.telling import Telling
    except ModuleNotFoundError as error:
        if error.name not in _PACKAGES:
            raise
        fail(f"the explorer needs the package {error.name}: pip install 'shapeconcepts[explorer]'")
    session = Session(model, scans or [], reading)
    telling = Telling(session, remember=not no_cache)
    try:
        server = ExplorerServer(telling, port)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            fail(f"port {port} is taken: give another --port, or none for a free one")
        fail(f"cannot listen on port {port}: {error.strerror or error}")
    server.start()
    # At once, whoever reads it: the page is there before the model is read.
    tell(server.address)
    sys.stdout.flush()
    if not no_browser:
        # Some browsers let one wait.
        Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
    _open(session)
    say_when_interrupted("")
    # Beside what keeps the session up: to find out what is alike takes its time.
    Thread(target=_remember, args=(session, telling), daemon=True).start()
    # Until a signal ends the process: each edit is on the disk as soon as it is made.
    while session.wait():
        session.keep_up()


def _remember(session: Session, telling: Telling) -> None:
    while session.wait():
        telling.remember()


def _open(session: Session) -> None:
    from shapeconcepts.model_file import ModelError
    from shapeconcepts.scan import ScanError

    try:
        session.open()
    except ModelError as error:
        fail(str(error) if str(session.path) in str(error) else f"{session.path}: {error}")
    except (ScanError, OSError) as error:
        fail(str(error))
