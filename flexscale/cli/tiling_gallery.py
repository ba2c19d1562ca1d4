"""`flexscale tiling gallery`: all families in one figure."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.patterns.named import named_patterns
from flexscale.plotting.picture_file import require_picture_path, write_picture
from flexscale.plotting.tiling_gallery import GalleryPanel, gallery
from flexscale.tilings import Family, Tiling, families

PARAMETERS = (0.12, -0.09, 0.13, -0.08, 0.11, -0.1)
_HEIGHT = 0.115  # of the curves, in edge lengths
_DECAY = 0.88  # each next class has lower curves, so that no two classes look the same
_N_COLORS = 64  # of the PNG
_REMARKS = (
    "Family and group. Tiles that look alike are shifted copies of each other; striped ones are "
    "mirror images of plain ones. Every edge that may be curved is curved as its class allows, so "
    "that the drawn symmetry is just the group.",
    "Not so in the 12 marked *: all their edges lie on mirrors and stay straight, and only "
    "markings on the tiles would tell them from more symmetric types.",
)
_NAMED_REMARKS = (
    "Name, family and drawn group.",
    "Tiles that look alike are shifted copies of each other; striped ones are mirror images.",
)


def draw_gallery(path: Path, *, replace: bool = False) -> None:
    """Draw all families and print the path of the picture.

    Raises
    ------
    BadInputError : the path cannot be written, or there is a file that may not be replaced.
    """
    _write(
        [
            _panel(f"{_marked(family)} {family.group}", generic_tiling(family))
            for family in families()
        ],
        _REMARKS,
        path,
        replace=replace,
    )


def draw_named_patterns(path: Path, *, replace: bool = False) -> None:
    """Draw the named patterns and print the path of the picture.

    Raises
    ------
    BadInputError : the path cannot be written, or there is a file that may not be replaced.
    """
    panels = []
    for entry in named_patterns():
        tiling = Tiling(entry.family, **entry.shape)
        panels.append(_panel(f"{entry.name}\n{entry.family} {tiling.symmetry().group}", tiling))
    _write(panels, _NAMED_REMARKS, path, n_columns=6, replace=replace)


def _write(
    panels: list[GalleryPanel],
    remarks: tuple[str, ...],
    path: Path,
    n_columns: int = 12,
    *,
    replace: bool = False,
) -> None:
    require_picture_path(path, replace)
    write_picture(gallery(panels, remarks, n_columns), path, n_colors=_N_COLORS, replace=replace)
    sys.stdout.write(f"{path}\n")


def generic_tiling(family: Family) -> Tiling:
    """A member of the family with no more symmetry than its type, where that can be drawn.

    Every class that may be curved is: J edges with a skew bump, U edges with a bump, S edges with
    a wave, all flat at their ends so that narrow corners stay open.
    """
    curved = [item for item in family.curve_kinds().items() if item[1] != "I"]
    edges = {
        letter: _curve(kind) * (1.0, (-1) ** number * _DECAY**number)
        for number, (letter, kind) in enumerate(curved)
    }
    return Tiling(family.name, PARAMETERS[: family.n_parameters], edges)


def _curve(kind: str) -> FloatArray:
    """Points (n, 2) of a standard curve; of S and U edges the first half."""
    if kind == "J":
        t = np.linspace(0.0, 1.0, 25)
        return np.stack([t, _HEIGHT * np.sin(np.pi * t**0.6) ** 2], axis=1)
    t = np.linspace(0.0, 0.5, 13)
    bump = np.sin(np.pi * t)
    wave = bump**2 if kind == "U" else np.sqrt(bump) * np.sin(2.0 * np.pi * t)
    return np.stack([t, _HEIGHT * wave], axis=1)


def _marked(family: Family) -> str:
    return f"{family.name}*" if family.needs_marking else family.name


def _panel(title: str, tiling: Tiling) -> GalleryPanel:
    return GalleryPanel(
        title=title,
        tiles=tiling.tiles,
        mirrored=tuple(aspect.reverses for aspect in tiling.aspects),
        lattice=tiling.lattice,
    )
