"""The model that a command works with, and scans as it wants them."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING

from shapeconcepts.cli.object_reader import ObjectReader
from shapeconcepts.cli.terminal import fail

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel
    from shapeconcepts.sources.reader import ReadOptions


def one_thread() -> AbstractContextManager[object]:
    """Keeps linear algebra to one thread.

    Its matrices are small here, and threads that wait for each other keep processes from their work: on two
    busy cores, learning takes twice as long with them.
    """
    from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

    return threadpool_limits(1)


def read_model(path: Path) -> ShapeConceptModel:
    """A model from its file; ends the command where that is none."""
    from shapeconcepts.model import load_model
    from shapeconcepts.model_file import ModelError

    try:
        return load_model(path)
    except ModelError as error:
        fail(str(error) if str(path) in str(error) else f"{path}: {error}")
    except OSError as error:
        fail(f"{path}: cannot be read ({error.strerror or error})")


def object_reader(
    model: ShapeConceptModel,
    reading: ReadOptions,
    scenes: bool | None,
    *,
    extract: bool = False,
    keep_segmented: bool = False,
    n_occlusions: int = 0,
    make_preview: bool = False,
) -> ObjectReader:
    """Reads scans as a model wants them."""
    return ObjectReader(
        reading=reading,
        segmenter=model.segmenter_,
        descriptor=model.descriptor_,
        scenes=scenes,
        extract=extract,
        keep_segmented=keep_segmented,
        n_occlusions=n_occlusions,
        make_preview=make_preview,
    )
