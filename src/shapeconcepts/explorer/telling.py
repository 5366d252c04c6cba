"""What is told of a session: documents made once for each version, and others before the model is read."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any

from shapeconcepts.explorer.file_status import file_status
from shapeconcepts.explorer.previews import N_ELEMENTS, Previews, pack
from shapeconcepts.explorer.remembered import Remembered

if TYPE_CHECKING:
    from shapeconcepts.explorer.session import Session


class Telling:
    """Tells of a model what its page shows.

    What was told of the same files the last time is told again at once, while the model is still being read;
    the first time, what its outline tells, unless something was said of it.

    Parameters
    ----------
    session : Session
    remember : bool
        Whether to keep it for the next time, in the user's cache.
    """

    def __init__(self, session: Session, *, remember: bool = True) -> None:
        self.session, self._previews = session, Previews(self._kept_preview, self._packed_preview)
        self._previews_of = session.model_status
        self._made: dict[str, tuple[str, bytes]] = {}
        self._remembered = Remembered(_subject(session)) if remember else None
        self._kept_of = ""
        self._recalled = self._told_before()
        self._recalled_of = self._files if self._recalled else ""
        self._at_first = self._recalled or self._first_look()

    @property
    def is_there(self) -> bool:
        """Whether there is anything to tell."""
        return self.session.is_read or bool(self._at_first)

    @property
    def n_scans(self) -> int:
        """Number of scans of the model."""
        first = None if self.session.is_read else self._at_first.get("n_scans")
        return int(first) if first else len(self.session.shown.scan_names_)

    def model_json(self) -> bytes:
        """What stays the same until the model's file changes."""
        session, status = self.session, self.session.model_status

        def document() -> dict[str, Any]:
            from shapeconcepts.explorer.model_document import model_document

            model, title = session.shown, session.path.name
            scans = model.scan_names_, model.scan_labels_, model.skipped_
            about = model_document(*scans, model.concept_tree_, title, bool(session.places), session.reading)
            return {**about, "modelVersion": status}

        if not session.is_read and self._at_first:
            return self._at_first["model"]
        return self._made_once("model", status, document)

    def state_json(self) -> bytes:
        """What edits change."""
        # What comes while it is made makes a version of its own.
        version = self.session.changes.version
        return b'{"version":%d,%b' % (version, self._state(version)[1:])

    def figures_json(self) -> bytes:
        """What the figures of a report show."""
        from shapeconcepts.report.html.contents import report_contents
        from shapeconcepts.report.html.shown_scans import shown_scans

        version, model = self.session.changes.version, self.session.shown
        previews = [None] * len(model.scan_names_)
        title = self.session.path.name
        return self._made_once(
            "figures",
            str(version),
            lambda: {
                **report_contents(model, previews, (), title, {}),
                "rows": shown_scans(model).scans.tolist(),
            },
        )

    def preview(self, row: int) -> Future[bytes]:
        """The packed preview of a scan, which may still be in the making."""
        if self._previews_of != self.session.model_status:
            self._previews_of = self.session.model_status
            self._previews.forget()
        return self._previews.of(row)

    def scan(self, row: int) -> dict[str, Any]:
        """What there is to say of one scan."""
        from shapeconcepts.explorer.scan_document import scan_document
        from shapeconcepts.scan import ScanError

        reason, segmented = "", None
        try:
            segmented = self.session.segmented(row)
        except ScanError as error:
            reason = str(error)
        return scan_document(self.session.shown, row, segmented, reason, self.session.path_of(row))

    def remember(self) -> None:
        """Keep what is told now for the next time."""
        if self._remembered is None or self._kept_of == self._latest:
            return
        files, latest = self._files, self._latest
        state, model = self._state(self.session.changes.version), self.model_json()
        # Unless something came in between, which is kept the next time.
        if (files, latest) == (self._files, self._latest):
            for name, content in (("model", model), ("state", state), ("n_scans", b"%d" % self.n_scans)):
                self._remembered.keep_document(name, files, content)
            self._kept_of = latest

    def close(self) -> None:
        """Make nothing more."""
        self._previews.close()
        if self._remembered is not None:
            self._remembered.close()

    def _told_before(self) -> dict[str, bytes]:
        """Documents as they were told of these files, or none."""
        if self._remembered is None:
            return {}
        found = {name: self._remembered.document(name, self._files) for name in ("model", "state", "n_scans")}
        return {name: content for name, content in found.items() if content} if all(found.values()) else {}

    def _first_look(self) -> dict[str, bytes]:
        """Documents of the model as it was learned, or none where something was said of it."""
        from shapeconcepts.explorer.first_look import first_look
        from shapeconcepts.model_file.error import ModelError

        session = self.session
        if session.journal_status:
            return {}
        try:
            model, state = first_look(session.path, bool(session.places), session.reading)
        except ModelError:
            # Who reads the model says why.
            return {}
        # Another version than that of the whole model, so that a page asks for it.
        version = f"outline {session.model_status}"
        n_scans = len(model["scans"]["names"])
        return {
            "model": _encoded({**model, "modelVersion": version}),
            "state": _encoded({**state, "modelVersion": version, "trouble": ""}),
            "n_scans": b"%d" % n_scans,
        }

    @property
    def _files(self) -> str:
        return f"{self.session.model_status} {self.session.journal_status}"

    @property
    def _latest(self) -> str:
        return f"{self._files} {self.session.changes.version}"

    def _state(self, version: int) -> bytes:
        session = self.session
        if not session.is_read and self._at_first:
            return self._at_first["state"]
        # It has doubts and names already, which take their time.
        if self._files == self._recalled_of and not session.is_likeness_known:
            return self._recalled["state"]

        def document() -> dict[str, Any]:
            from shapeconcepts.explorer.state_document import state_document

            state = state_document(session.shown, session.suggested, session.is_likeness_known)
            return {**state, "modelVersion": session.model_status, "trouble": session.trouble}

        return self._made_once("state", str(version), document)

    def _kept_preview(self, row: int) -> bytes | None:
        if self._remembered is None:
            return None
        return self._remembered.preview(row, self.session.model_status)

    def _packed_preview(self, row: int) -> bytes:
        of = self.session.model_status
        path = self.session.path_of(row)
        status = "" if path is None else file_status(path)
        packed = self._new_preview(row)
        if self._remembered is not None and path is not None and status and packed is not None:
            self._remembered.keep_preview(row, of, path, status, packed)
        return packed or pack(row, None)

    def _new_preview(self, row: int) -> bytes | None:
        from shapeconcepts.report.html import preview
        from shapeconcepts.scan import ScanError, scan_errors

        try:
            with scan_errors(f"scan {row}", "drawn"):
                return pack(row, preview(self.session.segmented(row), N_ELEMENTS))
        except ScanError:
            # Why there is none is said where the one scan is asked for.
            return None

    def _made_once(self, name: str, version: str, document: Callable[[], Mapping[str, Any]]) -> bytes:
        """A document of a version, made when it is first asked for."""
        made_version, content = self._made.get(name, ("", b""))
        if made_version != version or not content:
            content = _encoded(document())
            self._made[name] = version, content
        return content


def _encoded(document: Mapping[str, Any]) -> bytes:
    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode("ascii")


def _subject(session: Session) -> list[str]:
    """What a model is remembered by."""
    places = [str(place.resolve()) for place in session.places]
    return [str(session.path.resolve()), *places, repr(sorted(session.reading.items()))]
