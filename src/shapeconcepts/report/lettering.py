"""Text in pictures."""

from __future__ import annotations

from bisect import bisect_left

from PIL import ImageFont

from shapeconcepts.printable import printable

TITLE_COLOUR = (0x26, 0x2B, 0x33)
NOTE_COLOUR = (0x7A, 0x82, 0x8C)

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont


def font_of(size: float) -> Font:
    """Pillow's own font, which is there on every machine."""
    return ImageFont.load_default(size=size)


def shorten(text: str, font: Font, width: float) -> str:
    """One line of at most `width` pixels; the end stays, since that is where names differ."""
    text = printable(" ".join(text.splitlines()))
    if font.getlength(text) <= width:
        return text
    start = bisect_left(range(len(text)), True, key=lambda cut: font.getlength("…" + text[cut:]) <= width)
    return "…" + text[start:]
