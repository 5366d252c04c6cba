"""Notices of many scans in few words."""

from shapeconcepts.sources.notices import in_few_words


def test_the_same_advice_is_given_once():
    notices = [
        *[(f"{i}.ply", "is seen from all sides: give a mesh") for i in range(5)],
        ("a.xyz", "is 80 m across: in which units"),
        ("b.xyz", "is 90 m across: in which units"),
        ("c.xyz", "has no colon"),
    ]
    assert in_few_words(notices, 20) == [
        "5 of 20 scans: 0.ply, 1.ply, 2.ply, ...: is seen from all sides: give a mesh",
        "2 of 20 scans: a.xyz is 80 m across; b.xyz is 90 m across: in which units",
        "1 of 20 scans: c.xyz has no colon",
    ]
    assert in_few_words(notices[5:6], 1) == ["a.xyz is 80 m across: in which units"]
    assert in_few_words([], 3) == []
