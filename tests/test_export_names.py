"""Names of folders and files that stand for any text."""

import os
import unicodedata
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.export import safe_names

RESERVED = ["", ".", "..", "none", "None", "NONE ", "con", "COM1.txt", "nul .", "index.csv", "-rf", "~"]
UNSAFE = ["a/b", "a\\b", "a:b", "\0", "\udcff", "\u202e", "x" * 300, "ä" * 300]
ALIKE = ["é", "e\u0301", "ß", "ss", "SS", "mugs", "Mugs", "mugs (2)"]
NASTY = st.sampled_from([*RESERVED, *UNSAFE, *ALIKE])
ANY_NAMES = st.lists(NASTY | st.text(max_size=20), max_size=12)


@given(ANY_NAMES)
@settings(max_examples=300, deadline=None)
def test_names_are_safe_and_distinct(names: list[str]) -> None:
    safe = safe_names(names, taken=["none"])
    folded = [unicodedata.normalize("NFKD", name.casefold()).casefold() for name in ["none", *safe]]
    assert len(set(folded)) == len(folded)
    for name in safe:
        assert 1 <= len(name.encode("utf-8")) <= 180
        assert name not in (".", "..") and not set(name) & set('/\\:*?"<>|') and name.isprintable()
        assert name[0] != "." and name[-1] not in " ."
        assert name.partition(".")[0].strip().lower() not in ("con", "prn", "aux", "nul", "com1", "lpt9")
    assert safe == safe_names(names, taken=["none"])


@given(ANY_NAMES)
@settings(max_examples=25, deadline=None)
def test_a_file_system_takes_them_all(tmp_path_factory: pytest.TempPathFactory, names: list[str]) -> None:
    folder = tmp_path_factory.mktemp("names")
    for name in safe_names(names):
        (folder / name).mkdir()
    assert len(os.listdir(folder)) == len(names)


def test_what_is_safe_stays_as_it_is(tmp_path: Path) -> None:
    names = ["mugs", "Käse", "茶", "concept3", "हिन्दी", "a b (c)"]
    assert safe_names(names) == names
