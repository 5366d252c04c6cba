"""The libraries that nothing but the evaluation needs: they come with the extra of that name."""

from importlib.util import find_spec

GROUPING_LIBRARIES = ("gudhi", "graspologic_native", "fast_hdbscan")
LIBRARIES = (*GROUPING_LIBRARIES, "matplotlib")


def check_libraries(*names: str) -> None:
    """Complain where libraries are not installed, before any work.

    Raises
    ------
    ModuleNotFoundError
    """
    missing = [name for name in names if find_spec(name) is None]
    if missing:
        raise ModuleNotFoundError(
            f"the evaluation needs {' and '.join(missing)}, which {'is' if len(missing) == 1 else 'are'} not "
            "installed: pip install 'shapeconcepts[evaluation]'",
            name=missing[0],
        )
