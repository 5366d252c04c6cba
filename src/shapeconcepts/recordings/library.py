"""Asks for rosbags, which comes with the extra `recordings`, before anything needs it."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from shapeconcepts.scan import ScanError


def check_library(path: Path) -> None:
    """Raise ScanError where rosbags is not installed."""
    if find_spec("rosbags") is None:
        raise ScanError(
            f"{path}: is a recording, which is read with rosbags, which is not installed: "
            'pip install "shapeconcepts[recordings]"'
        )
