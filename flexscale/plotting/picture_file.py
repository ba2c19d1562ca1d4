"""A figure as one picture file, byte for byte the same for the same data."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from PIL import Image

from flexscale.datasets.staging import require_free, write_atomically
from flexscale.errors import BadInputError, suggest
from flexscale.plotting.style import flexscale_style

#: Ending -> what matplotlib would write into the file about itself and the time.
PICTURE_FORMATS: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
}


def require_picture_path(path: Path, replace: bool = False) -> None:
    """Refuse a path that no picture can be written to.

    Parameters
    ----------
    replace : whether a file that is there may be written over.

    Raises
    ------
    BadInputError : its folder does not exist, its ending is no format of pictures, or there is a
        file of this name.
    """
    ending = path.suffix.removeprefix(".")
    if ending not in PICTURE_FORMATS:
        raise BadInputError(
            f"The name of the picture {path} must end in .png, .svg or .pdf. "
            f"{suggest(ending, PICTURE_FORMATS)}"
        )
    if not path.parent.is_dir():
        raise BadInputError(f"There is no folder {path.parent}: create it, or name another one.")
    require_free([path], replace)


def write_picture(
    figure: Figure, path: Path, *, n_colors: int | None = None, replace: bool = False
) -> None:
    """Write a figure in the format of the path's ending, whole or not at all.

    Parameters
    ----------
    n_colors : of a PNG, at most 256: a palette makes a figure of flat colors a quarter in size.
    replace : whether a file that is there may be written over.

    Raises
    ------
    BadInputError : as `require_picture_path`.
    """
    require_picture_path(path, replace)
    content = picture_bytes(figure, path.suffix.removeprefix("."), n_colors=n_colors)
    write_atomically(path, lambda file: file.write_bytes(content))


def picture_bytes(figure: Figure, ending: str, *, n_colors: int | None = None) -> bytes:
    """Contents of a picture file, in one of the `PICTURE_FORMATS`; `n_colors` as above."""
    content = io.BytesIO()
    with flexscale_style():
        figure.savefig(content, format=ending, metadata=PICTURE_FORMATS[ending])
    if ending == "png" and n_colors is not None:
        content = _with_palette(content, n_colors)
    return content.getvalue()


def _with_palette(png: io.BytesIO, n_colors: int) -> io.BytesIO:
    smaller = io.BytesIO()
    with Image.open(png) as image:
        palette = image.convert("RGB").quantize(n_colors, dither=Image.Dither.NONE)
        palette.save(smaller, format="png", optimize=True, dpi=image.info["dpi"])
    return smaller
