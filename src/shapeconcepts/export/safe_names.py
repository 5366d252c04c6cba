"""Names of files and folders that every file system takes, and takes for different ones."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence

# Of the 255 that most file systems take: what is put before and behind names has its place as well.
MOST_BYTES = 180
# Not only these themselves: con.txt leads to the same device of Windows.
_DEVICES = {"con", "prn", "aux", "nul", "conin$", "conout$"} | {
    f"{port}{number}" for port in ("com", "lpt") for number in "0123456789¹²³"
}
# Letters and marks that nobody sees, some of which file systems leave out.
_UNSEEN = re.compile(
    "[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]"
)
_PUNCTUATION = set(" -_.()[]{}+,=@#%&!~^'`$")


def safe_names(names: Sequence[str], taken: Iterable[str] = ()) -> list[str]:
    """Names for files or folders beside each other, in the order of the names that they stand for.

    What a file system may not take is replaced by ``_``: slashes, control characters, what Windows reserves,
    blanks and dots at the ends. Long names are cut. Names that a file system could take for the same, as they
    differ only in case or in how letters with accents are written, get a number.

    Parameters
    ----------
    names : sequence of str
        Any text.
    taken : iterable of str
        Names that are there already.

    Returns
    -------
    list of str
        Of 1 to `MOST_BYTES` bytes each.

    Examples
    --------
    >>> safe_names(["mugs", "Mugs", "a/b", "con", ".."], taken=["none"])
    ['mugs', 'Mugs (2)', 'a_b', 'con_', '_']
    """
    used = {_folded(name) for name in taken}
    safe = []
    for name in names:
        wanted = one = safe_name(name)
        number = 2
        while _folded(one) in used:
            ending = f" ({number})"
            one, number = _cut(wanted, MOST_BYTES - len(ending)) + ending, number + 1
        used.add(_folded(one))
        safe.append(one)
    return safe


def safe_name(name: str) -> str:
    """A name that every file system takes; two names may give the same."""
    text = unicodedata.normalize("NFC", name)
    text = "".join(letter if _is_safe(letter) else "_" for letter in text)
    text = _cut(text.strip(" ").lstrip("."), MOST_BYTES - 1) or "_"
    stem, dot, ending = text.partition(".")
    return f"{stem}_{dot}{ending}" if stem.rstrip(" ").lower() in _DEVICES else text


def _is_safe(letter: str) -> bool:
    is_letter = unicodedata.category(letter)[0] in "LMN" and not _UNSEEN.match(letter)
    return is_letter or letter in _PUNCTUATION


def _cut(text: str, n_bytes: int) -> str:
    """The beginning of a text that has so many bytes at most; Windows drops blanks and dots at the end."""
    return text.encode("utf-8")[:n_bytes].decode("utf-8", "ignore").rstrip(" .")


def _folded(name: str) -> str:
    """What is equal for names that any file system takes for the same."""
    folded = unicodedata.normalize("NFKC", name).casefold()
    return unicodedata.normalize("NFKC", folded)
