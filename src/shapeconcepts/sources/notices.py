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
    found: dict[str, list[tuple[str, str]]] = {}
    for name, notice in notices:
        # What was found may quote something that has a colon itself.
        what, colon, advice = notice.rpartition(": ")
        if not colon:
            what, advice = advice, ""
        found.setdefault(advice, []).append((name, what))
    sentences = []
    for advice, scans in found.items():
        count = f"{len(scans)} of {n_scans} scans: " if n_scans > 1 else ""
        sentences.append(f"{count}{_examples(scans)}" + (f": {advice}" if advice else ""))
    return sentences


def _examples(scans: list[tuple[str, str]]) -> str:
    """The first scans with what each is; once where it is the same."""
    first, more = scans[:_NAMED], len(scans) > _NAMED
    if len({what for _, what in scans}) > 1:
        return "; ".join(f"{name} {what}" for name, what in first) + "; ..." * more
    colon = ":" if len(scans) > 1 else ""
    return ", ".join(name for name, _ in first) + ", ..." * more + f"{colon} {first[0][1]}"
