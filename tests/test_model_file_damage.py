"""A file that is no model, or a damaged one, raises a ModelError that says so, and nothing else."""

import json
import pickle
import random
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save_file

from model_file_examples import fitted_model, forge, refusal
from shapeconcepts.model_file.layout import FORMAT


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    path = tmp_path_factory.mktemp("sound") / "model"
    fitted_model().save(path)
    return path


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model"


def with_header(sound: Path, path: Path, change) -> Path:
    """Change the header as a JSON object, or as bytes."""
    content = sound.read_bytes()
    end = 8 + int.from_bytes(content[:8], "little")
    header = json.loads(content[8:end])
    changed = change(header)
    text = changed if isinstance(changed, bytes) else json.dumps(header).encode()
    path.write_bytes(len(text).to_bytes(8, "little") + text + content[end:])
    return path


# Places


def test_a_missing_file(path):
    assert "there is no such file" in refusal(path)


def test_a_folder(tmp_path):
    assert "is a folder" in refusal(tmp_path)


def test_a_path_below_a_file(sound):
    refusal(sound / "more")


# The container


def test_an_empty_file(path):
    path.touch()
    assert "is empty" in refusal(path)


def test_every_truncation(sound, path):
    content = sound.read_bytes()
    lengths = random.Random(0).sample(range(len(content)), 40)
    for length in (1, 7, 8, 9, len(content) - 1, *lengths):
        path.write_bytes(content[:length])
        refusal(path)


def test_a_tail(sound, path):
    path.write_bytes(sound.read_bytes() + b"\0")
    assert "truncated or has a tail" in refusal(path)


@pytest.mark.parametrize("length", [0, 1, 2**31, 2**63, 2**64 - 1])
def test_an_absurd_length_of_the_header(sound, path, length):
    path.write_bytes(length.to_bytes(8, "little") + sound.read_bytes()[8:])
    assert f"got a length of {length}" in refusal(path)


def test_foreign_files(path):
    for content in (b"ply\nformat ascii 1.0\n" * 99, b"\x89PNG\r\n\x1a\n" + bytes(99), bytes(10_000)):
        path.write_bytes(content)
        assert "is no model file" in refusal(path)
    save_file({"weight": np.zeros((2, 3), np.float32)}, path)
    assert "no model of shapeconcepts" in refusal(path)
    save_file({"weight": np.zeros((2, 3), np.float32)}, path, {"format": "pt"})
    assert "no model of shapeconcepts" in refusal(path)


class Bomb:
    def __reduce__(self):
        return pytest.fail, ("a pickle was run",)


def test_a_pickle_is_not_run(path):
    path.write_bytes(pickle.dumps(Bomb()))
    assert "is no model file" in refusal(path)


@pytest.mark.parametrize(
    "text",
    [
        b"null",
        b"[]",
        b'{"a": NaN}',
        b"{" * 50,
        b'{"a":' * 200_000 + b"0" + b"}" * 200_000,
        b"[" * 200_000,
        b'{"a": 1, "a": 1}',
        b'{"a": ' + b"9" * 10_000 + b"}",
        b'{"\xff": 1}',
        b'{"__metadata__": {"shapeconcepts": "{}"}}',
        b'{"__metadata__": {"shapeconcepts": "[]"}}',
        b'{"__metadata__": {"shapeconcepts": "{\\"format\\": 1, \\"format\\": 1}"}}',
        b'{"__metadata__": {"shapeconcepts": 5}}',
        b'{"__metadata__": {"shapeconcepts": "{}", "more": ""}}',
        b'{"__metadata__": 5}',
    ],
)
def test_nonsense_in_the_header(sound, path, text):
    with_header(sound, path, lambda header: text)
    refusal(path)


def test_a_key_that_occurs_twice(sound, path):
    def twice(header):
        return json.dumps(header).replace("{", '{"space.edges": [], ', 1).encode()

    assert "a key occurs twice" in refusal(with_header(sound, path, twice))


def test_every_depth_of_nesting(sound, path):
    # At some of them JSON can still be parsed, but no longer be written or shown.
    for depth in range(100, 1100, 13):

        def nest(header, depth=depth):
            text = header["__metadata__"]["shapeconcepts"]
            nested = "[" * depth + "]" * depth
            header["__metadata__"]["shapeconcepts"] = text.replace(
                '"skipped": ', f'"more": {nested}, "skipped": '
            )

        message = refusal(with_header(sound, path, nest))
        assert "checksum" in message or "recursion" in message or "nested too deep" in message


@pytest.mark.parametrize(
    "entry",
    [
        5,
        {},
        {"dtype": "F64"},
        {"dtype": "F64", "shape": [1], "data_offsets": [0, 8], "more": 0},
        {"dtype": "F16", "shape": [0], "data_offsets": [0, 0]},
        {"dtype": ["F64"], "shape": [0], "data_offsets": [0, 0]},
        {"dtype": "F64", "shape": 1, "data_offsets": [0, 8]},
        {"dtype": "F64", "shape": [True], "data_offsets": [0, 8]},
        {"dtype": "F64", "shape": [1.0], "data_offsets": [0, 8]},
        {"dtype": "F64", "shape": [-1], "data_offsets": [8, 0]},
        {"dtype": "F64", "shape": [0, 10**18], "data_offsets": [0, 0]},
        {"dtype": "F64", "shape": [2**32, 2**32], "data_offsets": [0, 0]},
        {"dtype": "F64", "shape": [1, 1, 1], "data_offsets": [0, 8]},
        {"dtype": "F64", "shape": [1], "data_offsets": [0, 10**12]},
        {"dtype": "F64", "shape": [10**12], "data_offsets": [0, 8 * 10**12]},
        {"dtype": "F64", "shape": [1], "data_offsets": [-8, 0]},
        {"dtype": "F64", "shape": [1], "data_offsets": [8]},
        {"dtype": "F64", "shape": [1], "data_offsets": [0, 8]},
    ],
)
def test_impossible_entries_of_the_header(sound, path, entry):
    for name in ("response.mean", "one more"):
        with_header(sound, path, lambda header, name=name: header.__setitem__(name, entry))
        assert name in refusal(path) or "overlap" in refusal(path)


def test_overlapping_tensors(sound, path):
    def overlap(header):
        header["space.vertices"]["data_offsets"] = header["concepts.labels"]["data_offsets"]

    assert "overlap or leave a gap" in refusal(with_header(sound, path, overlap))


def test_declared_sizes_take_no_memory(sound, path):
    def huge(header):
        header["space.divergences"] = {
            "dtype": "F64",
            "shape": [10**11],
            "data_offsets": [0, 8 * 10**11],
        }

    with_header(sound, path, huge)
    size = path.stat().st_size
    path.write_bytes(path.read_bytes() + bytes(size))
    tracemalloc.start()
    refusal(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5 * size


def test_a_newer_file(sound, path):
    def newer(tensors, description):
        description.update(format=FORMAT + 1, written_by="shapeconcepts 7.5")
        description["more"] = 1

    message = refusal(forge(sound, path, newer))
    assert f"format {FORMAT + 1}" in message and f"reads format {FORMAT}" in message
    assert "shapeconcepts 7.5, which is newer" in message


def test_an_older_file(sound, path):
    """Such a file has other tensors and fields; what it has does not matter."""

    def older(tensors, description):
        description.update(format=FORMAT - 1, written_by="shapeconcepts 0.1.0")
        tensors["stimuli.motifs"] = tensors.pop("stimuli.sources")
        del description["concept_time"]

    message = refusal(forge(sound, path, older))
    assert f"has format {FORMAT - 1}, written by shapeconcepts 0.1.0, an older version" in message
    assert f"reads format {FORMAT}; learn the model again" in message


@pytest.mark.parametrize("version", [0, -1, True, "1", None, 1.0, 10**30])
def test_an_impossible_format(sound, path, version):
    assert "has format" in refusal(
        forge(sound, path, lambda _, description: description.update(format=version))
    )


def test_flipped_bits(sound, path):
    content = sound.read_bytes()
    source = random.Random(0)
    header_end = 8 + int.from_bytes(content[:8], "little")
    # All of the first bytes, many of the header, some of the numbers.
    positions = [*range(12), *source.sample(range(header_end), 120)]
    positions += source.sample(range(header_end, len(content)), 120)
    for position in positions:
        flipped = bytearray(content)
        flipped[position] ^= 1 << source.randrange(8)
        path.write_bytes(flipped)
        refusal(path)
