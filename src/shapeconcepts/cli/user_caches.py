"""The user's caches of segments and descriptions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from shapeconcepts.cli.terminal import say
from shapeconcepts.interruption import INTERRUPTED, say_when_interrupted

if TYPE_CHECKING:
    from shapeconcepts.descriptors.description_cache import DescriptionCache
    from shapeconcepts.segmentation.segment_cache import SegmentCache


def user_cache() -> SegmentCache | None:
    """The user's cache; None, and a note, where there can be none."""
    from shapeconcepts.segmentation.segment_cache import SegmentCache

    try:
        cache = SegmentCache.of_user()
    except OSError as error:
        say(f"Note: nothing is cached: {error}")
        return None
    say_when_interrupted(f"{INTERRUPTED}; the segments that were found are kept for the next time")
    return cache


def descriptions_beside(segments: SegmentCache | None) -> DescriptionCache | None:
    """The cache of descriptions that belongs to one of segments."""
    from shapeconcepts.descriptors.description_cache import DescriptionCache

    return None if segments is None else DescriptionCache.beside(segments)
