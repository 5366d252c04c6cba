"""Text from outside that is made fit to be shown, and the errors and pages that hold it."""

import pickle
from xml.etree import ElementTree

import pytest

from shapeconcepts.model_file import ModelError
from shapeconcepts.printable import encodable, markup_bytes, printable
from shapeconcepts.report.lettering import font_of, shorten
from shapeconcepts.scan import ScanError, ScanWarning


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("scans/Käse 茶 🫖.pcd", "scans/Käse 茶 🫖.pcd"),
        ("[red]a[/] \\x1b %s {}", "[red]a[/] \\x1b %s {}"),
        ("a\nb\r\tc", "a\\nb\\r\\tc"),
        ("\x1b]52;c;aGk=\x07", "\\x1b]52;c;aGk=\\x07"),
        ("\x00\x7f\x85\x9b31m", "\\x00\\x7f\\x85\\x9b31m"),
        ("dcp\u202egnp", "dcp\\u202egnp"),
        ("a\u200bb\u2066c\u2028d\ufeff", "a\\u200bb\\u2066c\\u2028d\\ufeff"),
        ("\udcff", "\\udcff"),
        ("\U000e0041", "\\U000e0041"),
    ],
)
def test_everything_is_seen(text: str, shown: str) -> None:
    assert printable(text) == shown
    assert printable(shown) == shown


def test_every_character_can_be_printed() -> None:
    for number in [*range(0x3000), *range(0xD7F0, 0xE010), *range(0xFE00, 0x10000), 0x10FFFF]:
        assert printable(chr(number)).isprintable()
        encodable(chr(number)).encode()


def test_only_what_no_encoding_holds_is_escaped_in_data() -> None:
    assert encodable("\x1b é\udcff") == "\x1b é\\udcff"


def test_markup_is_well_formed() -> None:
    letters = "".join(map(chr, [*range(0x100), 0xD800, 0xDCFF, 0xFFFE, 0xFFFF, 0x1F600]))
    text = letters.replace("&", "").replace("<", "")
    shown = ElementTree.fromstring(markup_bytes(f"<svg>{text}</svg>")).text
    assert shown is not None
    assert all(letter.isprintable() or letter in "\t\n\xa0\xad" for letter in shown)
    assert "\\x00\\x01" in shown and "\\x1b" in shown and "\\x9b" in shown
    assert shown.endswith("\\ud800\\udcff\\ufffe\\uffff😀")


@pytest.mark.parametrize("kind", [ScanError, ScanWarning, ModelError])
def test_messages_are_printable(kind: type[Exception]) -> None:
    error = kind("a\x1b[2J\n\udcff.pcd: is empty")
    assert str(error) == "a\\x1b[2J\\n\\udcff.pcd: is empty"
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_text_in_pictures() -> None:
    assert shorten("a\x1b\udcff", font_of(12), 500) == "a\\x1b\\udcff"
