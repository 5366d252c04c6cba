"""What is raised for a model file that cannot be read, or a model that cannot be written."""

from __future__ import annotations

from shapeconcepts.printable import printable


class ModelError(ValueError):
    """A model cannot be saved, or a file holds none that can be loaded.

    What the message quotes of the file is made printable.
    """

    def __init__(self, message: object) -> None:
        super().__init__(printable(str(message)))


def require(condition: bool, message: str) -> None:
    """Raise a ModelError with the message unless the condition holds."""
    if not condition:
        raise ModelError(message)
