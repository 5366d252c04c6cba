"""What there is to say of many scans, in few words: the same advice once."""

from __future__ import annotations

from collections.abc import Iterable

_NAMED = 3


def in_few_words(notices: Iterable[tuple[str, str]], n_scans: int) -> list[str]:
    """A sentence for each different advice, in the order in which they come.

    Parameters
    ----------
    notices : iterable of (name, notice)
        Of scans, see `Scan.notices`; a scan may have several.
    n_scans : int
        How many scans there are.
    """
    found: dict[str, list[str]] = {}
    for name, notice in notices:
        what, _, advice = notice.partition(": ")
        found.setdefault(advice or what, []).append(f"{name} {what}")
    sentences = []
    for advice, scans in found.items():
        examples = "; ".join(scans[:_NAMED]) + ("; ..." if len(scans) > _NAMED else "")
        count = f"{len(scans)} of {n_scans} scans: " if n_scans > 1 else ""
        sentences.append(f"{count}{examples}: {advice}")
    return sentences
