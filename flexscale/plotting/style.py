"""One look for all figures: what each color and line style means, and how figures are saved.

Meanings are fixed and never carried by color alone: closing is solid and opening dashed; the
native model is blue and the macro model orange; curvature runs through `cividis`, direction
through the cyclic `twilight`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.style
import numpy as np
from matplotlib.figure import Figure

STYLE_FILE = Path(__file__).with_name("flexscale.mplstyle")
COLUMN_WIDTH = 85.0 / 25.4  # inch, one column of the page
PAGE_WIDTH = 178.0 / 25.4  # inch, both columns

NATIVE_COLOR = "#0072B2"
MACRO_COLOR = "#D55E00"
SCALE_COLOR = "#E69F00"
SUBSTRATE_COLOR = "#56B4E9"
CONTACT_COLOR = "#7A0177"
FAILED_COLOR = "#B2182B"
NOTE_COLOR = "#555555"
SIDE_LINESTYLES: dict[str, Any] = {"closing": "-", "opening": (0, (4.0, 1.6))}
MARKERS = ("o", "s", "^", "D", "v", "P", "X")

Color = tuple[float, float, float]


@contextmanager
def flexscale_style() -> Iterator[None]:
    """Apply the style file on top of matplotlib's own defaults, whatever the user has set."""
    with mpl.rc_context(), mpl.style.context(["default", str(STYLE_FILE)]):
        yield


def new_figure(width: float, height: float) -> Figure:
    """Empty figure with constrained layout, known to no global list of open figures.

    Parameters
    ----------
    width, height : inch.
    """
    if "IPython" in sys.modules:
        # Importing pyplot is what teaches a notebook to show a returned Figure as a picture.
        import matplotlib.pyplot  # noqa: F401
    return Figure(figsize=(width, height), layout="constrained")


def curvature_colors(curvatures: Sequence[float] | np.ndarray) -> list[Color]:
    """Colors of `cividis` by rank, dark for small curvature; its palest yellow is left out.

    Rank and not value, so that two close curvatures remain distinguishable.
    """
    values = np.asarray(curvatures, dtype=float)
    rank = np.argsort(np.argsort(values))
    positions = 0.88 * rank / max(len(values) - 1, 1)
    return [_rgb(mpl.colormaps["cividis"](position)) for position in positions]


def direction_color(direction: float) -> Color:
    """Color of a direction (degree, period 180) from the cyclic `twilight`.

    Darkened by a fifth: its pale end, at 0 degree, would vanish on white paper.
    """
    return _rgb(0.8 * np.asarray(mpl.colormaps["twilight"]((direction % 180.0) / 180.0)))


def unit_text(units: str) -> str:
    """Units as read on an axis: ``mm-1`` becomes ``mm⁻¹``, ``degree`` becomes ``°``.

    Parameters
    ----------
    units : as stored in a dataset's `units` attribute; "1" and "" are dimensionless.
    """
    if units in ("", "1"):
        return ""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    words = []
    for word in units.replace("degrees", "degree").split():
        stem = word.rstrip("-0123456789")
        words.append(stem + word[len(stem) :].translate(raised))
    return " ".join(words).replace("degree", "°")


def axis_label(variable: Any) -> str:
    """Long name and units of an xarray variable, as ``bending moment [N]``.

    Parameters
    ----------
    variable : xarray.DataArray with `long_name` and `units` attributes.
    """
    name = str(variable.attrs.get("long_name", variable.name)).strip()
    units = unit_text(str(variable.attrs.get("units", "")))
    return f"{name} [{units}]" if units else name


def moment_label(sweep: Any) -> str:
    """``moment per width [N]``: N mm per mm of the sheet's width, where a long name has no room.

    Parameters
    ----------
    sweep : dataset with the variable `moment`.
    """
    return f"moment per width [{unit_text(str(sweep['moment'].attrs.get('units', 'N')))}]"


def add_note(figure: Figure, lines: Sequence[str]) -> None:
    """Small gray remarks under a figure: how it is to be read and what is missing in it."""
    kept = [line for line in lines if line]
    if kept:
        figure.supxlabel("\n".join(kept), fontsize=6.0, color=NOTE_COLOR)


def _rgb(color: Any) -> Color:
    red, green, blue = (float(channel) for channel in list(color)[:3])
    return red, green, blue
