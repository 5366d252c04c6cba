"""Pictures as files."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from shapeconcepts.cli.terminal import check_writable, say

if TYPE_CHECKING:
    from PIL.Image import Image


def check_picture_path(path: Path, option: str) -> None:
    """Complain before the work is done, not after."""
    from PIL import Image

    formats = Image.registered_extensions()
    if formats.get(path.suffix.lower()) not in Image.SAVE:
        raise typer.BadParameter(
            f"{path} must end in .png, .jpg or another picture format", param_hint=option
        )
    check_writable(path, option)


def save_picture(draw: Callable[[], Image], path: Path) -> bool:
    """Whether a picture could be drawn and written; the user is told either way."""
    from PIL import Image

    from shapeconcepts.io.atomic_write import write_atomically

    content = BytesIO()
    try:
        draw().save(content, Image.registered_extensions()[path.suffix.lower()])
        write_atomically(path, content.getvalue())
    except (OSError, ValueError) as error:  # some formats hold no picture of this size or kind
        say(f"Error: cannot write {path}: {getattr(error, 'strerror', None) or error}")
        return False
    except MemoryError:
        say(f"Error: cannot write {path}: the picture needs more memory than there is")
        return False
    say(f"Wrote {path}")
    return True
