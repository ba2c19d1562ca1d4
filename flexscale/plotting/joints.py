"""Laws of joints: forces per length along four lines of poses, and states of the solid on them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.arrays import BoolArray, FloatArray
from flexscale.checks import DATASET, checked
from flexscale.plotting.selection import require_variables, subject
from flexscale.plotting.style import (
    MACRO_COLOR,
    NATIVE_COLOR,
    PAGE_WIDTH,
    add_note,
    flexscale_style,
    new_figure,
)

_NEEDED = (
    *("exponents", "coefficients", "lowest", "highest", "state_poses", "state_forces", "held_out"),
    *("touching_slope", "substrate_thickness", "substrate_young_modulus"),
)
#: What is drawn against what: place of the force in the pose, and the words of both axes.
_PANELS = (
    (0, "opening u [mm]", "force of u [N mm⁻¹]"),
    (1, "shift w [mm]", "force of w [N mm⁻¹]"),
    (2, "slide s [mm]", "force of s [N mm⁻¹]"),
    (3, "turn φ, closing [°]", "moment of φ [N]"),
)
_SLIDES = 1.0  # thicknesses that are drawn of the slide, in which the law is linear


@checked(joint=DATASET)
def joint(joint: xr.Dataset) -> Figure:
    """Forces of a joint against opening, shift, slide and turn: law, and states held out.

    Parameters
    ----------
    joint : dataset of kind joint.
    """
    require_variables(joint, _NEEDED, "A figure of a joint", "joint")
    thickness = float(joint["substrate_thickness"])
    modulus = float(joint["substrate_young_modulus"])
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.6 * PAGE_WIDTH)
        figure.suptitle(f"{subject(joint)}: joint".lstrip(": "))
        for axes, (place, across, up) in zip(np.ravel(figure.subplots(2, 2)), _PANELS, strict=True):
            scale = np.rad2deg(1.0) if place == 3 else thickness
            unit = modulus * thickness * (thickness if place == 3 else 1.0)
            line = _line(joint, place)
            forces = _forces(joint, line)[:, place]
            axes.plot(scale * line[:, place], unit * forces, color=MACRO_COLOR, label="law")
            poses, solved = _states(joint, place)
            axes.plot(scale * poses, unit * solved, "o", color=NATIVE_COLOR, label="solid")
            axes.set_xlabel(across)
            axes.set_ylabel(up)
            axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
        figure.axes[0].legend()
        add_note(figure, [_touching_note(joint), "s: the law is exact in it, no states are solved"])
    return figure


def _ends(joint: xr.Dataset) -> tuple[FloatArray, FloatArray, float]:
    """Lowest and highest pose (4,), and opening by turn of the line on which scales touch."""
    poses = joint["state_poses"].transpose("state", "pose").values
    touching = poses[_on_touching_line(poses, joint)]
    slope = float(touching[-1, 0] / touching[-1, 3]) if len(touching) else 0.0
    return joint["lowest"].values, joint["highest"].values, slope


def _line(joint: xr.Dataset, place: int) -> FloatArray:
    """(n, 4) poses of a panel's curve; turns that close open the gap as touching scales do."""
    low, high, slope = _ends(joint)
    first, last = low[place], high[place]
    if place == 0:
        last = float(joint["before_touching"])
    if place == 1:
        first = 0.0
    if place == 2:
        first, last = 0.0, _SLIDES
    line = np.zeros((101, 4))
    line[:, place] = np.linspace(first, last, len(line))
    if place == 3:
        line[:, 0] = slope * np.maximum(line[:, 3], 0.0)
    return line


def _states(joint: xr.Dataset, place: int) -> tuple[FloatArray, FloatArray]:
    """Coordinates and forces of the states held out that lie on a panel's line."""
    poses = joint["state_poses"].transpose("state", "pose").values
    forces = joint["state_forces"].transpose("state", "pose").values
    others = np.delete(np.arange(4), place)
    chosen = (poses[:, others] == 0.0).all(axis=1)
    if place == 3:
        chosen |= _on_touching_line(poses, joint)
    chosen &= joint["held_out"].values.astype(bool)
    return poses[chosen, place], forces[chosen, place]


def _on_touching_line(poses: FloatArray, joint: xr.Dataset) -> BoolArray:
    """(n,) whether states lie on the line from rest to the largest turn at which tops touch."""
    turn = float(joint["highest"].values[3])
    opening = max(float(joint["touching_slope"]) * turn - float(joint["gap_ratio"]), 0.0)
    apart = poses[:, 0] * turn - opening * poses[:, 3]
    closes = (poses[:, 1] == 0.0) & (poses[:, 3] > 0.0)
    return closes & (np.abs(apart) <= 1e-5 * max(opening, 1.0) * turn)


def _forces(joint: xr.Dataset, poses: FloatArray) -> FloatArray:
    """(n, 4) of the polynomial."""
    exponents: Any = joint["exponents"].transpose("term", "pose").values
    coefficients = joint["coefficients"].values
    found = np.empty_like(poses)
    for i in range(4):
        lowered = exponents.copy()
        lowered[:, i] = np.maximum(lowered[:, i] - 1, 0)
        terms = (poses[:, None, :] ** lowered).prod(axis=2) * exponents[:, i]
        found[:, i] = terms @ coefficients
    return found


def _touching_note(joint: xr.Dataset) -> str:
    _, _, slope = _ends(joint)
    opening = slope * float(joint["substrate_thickness"]) * np.deg2rad(1.0)
    return f"φ > 0 with an opening u of {opening:.3g} mm for each degree, φ < 0 with none"
