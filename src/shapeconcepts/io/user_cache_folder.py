"""Where what can be made again is kept for a user."""

from __future__ import annotations

from pathlib import Path

from platformdirs import user_cache_path


def user_cache_folder() -> Path:
    """Where the operating system wants a user's caches, with a folder for this package.

    Raises
    ------
    OSError
        If the user has no home folder.
    """
    try:
        folder = user_cache_path("shapeconcepts", appauthor=False, opinion=False)
    except RuntimeError as error:
        raise OSError(str(error)) from None
    # Before platformdirs 4.12, a home that is not known stays "~", and a relative XDG_CACHE_HOME is taken.
    if not folder.is_absolute():
        raise OSError(f"the user's cache folder cannot be told: {folder} is relative")
    return folder
