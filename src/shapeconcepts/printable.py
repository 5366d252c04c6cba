"""Text from outside, such as the name of a file, made fit to be shown.

Whoever names a file must not move the cursor, write the clipboard, forge a line or turn text around, and a
name that no encoding holds must not end a command. It is escaped as by Python's `repr`.
"""

from __future__ import annotations

import re

# XML knows no other control characters, no halves of surrogate pairs, and neither U+FFFE nor U+FFFF; it knows
# those from 0x7F to 0x9F, which nobody sees.
_NOT_IN_MARKUP = re.compile("[^\t\n\r -~\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def printable(text: str) -> str:
    """Text on one line of which every character is seen: ``\\x1b``, ``\\n``, ``\\u202e``.

    What is printable stays as it is, a backslash too, so that nothing is escaped twice. A byte of a file's
    name that is not UTF-8 reads ``\\udcff``, with the byte in its last two digits.
    """
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() else _escaped(letter) for letter in text)


def encodable(text: str) -> str:
    """Text that UTF-8 can hold, for files: only what no encoding holds is escaped."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def markup_bytes(markup: str) -> bytes:
    """An HTML page or SVG as a file, well-formed whatever names stand in it."""
    return _NOT_IN_MARKUP.sub(lambda found: _escaped(found[0]), markup).encode("utf-8")


def _escaped(letter: str) -> str:
    return repr(letter)[1:-1]
