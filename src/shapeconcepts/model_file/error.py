"""What is raised for a model file that cannot be read, or a model that cannot be written."""


class ModelError(ValueError):
    """A model cannot be saved, or a file holds none that can be loaded."""


def require(condition: bool, message: str) -> None:
    """Raise a ModelError with the message unless the condition holds."""
    if not condition:
        raise ModelError(message)
