"""Format calculix: a composite shell section that has the sheet's A and D.

CalculiX has no card for A, B and D. It takes layers of anisotropic materials in elements S8R and
S6, which it makes solids of; three have any A and D (`equivalent_layers`). As solids they also have
a stiffness across, which is taken uncoupled (Poisson's ratios 0) and as high as that of the plane,
and shear across, which is taken as good as rigid.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.exchange.abaqus import AXES, card_lines
from flexscale.exchange.equivalent_layers import find_layers
from flexscale.exchange.subject import Subject

#: Shear stiffness across over the largest stiffness of the plane: ten times less, and layers that
#: are twenty times as thick as the sheet shear where it twists; ten times more, and meshes lock.
_SHEAR = 100.0


def write_calculix(subject: Subject, path: Path) -> None:
    """Write two materials, the axes, and a composite section for the elements FLEXSCALE."""
    laminate = subject.require_laminate("A shell section")
    layers = find_layers(laminate.a, laminate.d_free)
    coupling = "is not known" if laminate.b is None else "is left out"
    comments = (
        subject.title(),
        "units mm, N, MPa; for elements S8R or S6 of the set FLEXSCALE, with normals to the side",
        "of the scales; x and y are the pattern's axes",
        "three layers that have A (in-plane stiffness) and D (bending stiffness without in-plane",
        f"force) of the sheet to rounding; the coupling of strain and curvature B {coupling}",
        "stiffness across the layers is a stand-in, and their shear across is as good as rigid:",
        "transverse shear stiffness of the sheet is not computed; stresses in layers mean nothing",
        "the sheet at rest: contact of scales is not in it",
    )
    lines = [f"** {line}" for line in comments]
    for name, stiffness in (("FACE", layers.face_stiffness), ("CORE", layers.core_stiffness)):
        lines += [f"*MATERIAL, NAME=FLEXSCALE_{name}", "*ELASTIC, TYPE=ANISO"]
        lines += card_lines(solid_entries(stiffness))
    lines += [*AXES, "*SHELL SECTION, COMPOSITE, ELSET=FLEXSCALE, ORIENTATION=FLEXSCALE_AXES"]
    for thickness, name in ((layers.face, "FACE"), (layers.core, "CORE"), (layers.face, "FACE")):
        lines.append(f"{thickness:.12e},, FLEXSCALE_{name}, FLEXSCALE_AXES")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def solid_entries(plane: FloatArray) -> FloatArray:
    """(21,) D1111, D1122, D2222, D1133, D2233, D3333, D1112, …, the upper half of the matrix of
    (11, 22, 33, 12, 13, 23) column by column, for a plane stiffness (3, 3) of (11, 22, 12)."""
    across = float(np.linalg.eigvalsh(plane).max())
    solid = np.diag([0.0, 0.0, across, 0.0, _SHEAR * across, _SHEAR * across])
    at = [0, 1, 3]
    solid[np.ix_(at, at)] = plane
    return np.concatenate([solid[: column + 1, column] for column in range(6)])
