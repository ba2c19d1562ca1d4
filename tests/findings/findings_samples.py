"""Synthetic patterns whose response over directions and curvature is chosen, for the findings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from flexscale.findings.pattern_data import PatternData

DIRECTIONS = np.arange(0.0, 180.0, 15.0)
CURVATURES = np.array([0.0, 0.002, 0.004, 0.008, 0.012, 0.016, 0.02])
FIRST_TOUCH = 4  # position of the first sample in contact
Response = Callable[[np.ndarray], np.ndarray]

ISOTROPIC = np.array([[100.0, 20.0, 0.0], [20.0, 100.0, 0.0], [0.0, 0.0, 40.0]])
TETRAGONAL = np.array([[100.0, 20.0, 0.0], [20.0, 100.0, 0.0], [0.0, 0.0, 80.0]])
ORTHOTROPIC = np.array([[100.0, 20.0, 0.0], [20.0, 50.0, 0.0], [0.0, 0.0, 30.0]])
SKEW = np.array([[100.0, 20.0, 30.0], [20.0, 50.0, 0.0], [30.0, 0.0, 30.0]])
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
DART = [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)]


def lobed(fold: int, share: float, turn: float = 0.0) -> Response:
    """1 + share cos(fold (direction - turn)); fold is even, turn in degree."""
    return lambda directions: 1.0 + share * np.cos(fold * np.deg2rad(directions - turn))


def sources(fold: int, mirrored: bool) -> np.ndarray:
    """Direction solved for each one: those of one period of 360/fold, half of it if mirrored."""
    period = 360.0 / fold
    inside = DIRECTIONS % period
    return np.minimum(inside, period - inside) if mirrored else inside


def pattern(
    name: str = "some",
    *,
    fold: int = 2,
    mirrored: bool = False,
    before: Response = np.ones_like,
    after: Response = np.ones_like,
    gain: dict[str, float] | None = None,
    matrix: np.ndarray = ISOTROPIC,
    scale: list[tuple[float, float]] = SQUARE,
) -> PatternData:
    """A pattern of slope 100 `before` and 100 gain `after` contact, which begins at 0.008 /mm.

    Parameters
    ----------
    gain : by side; a side left out never touches.
    """
    gain = {"closing": 5.0} if gain is None else gain
    shape = (2, len(DIRECTIONS), len(CURVATURES))
    moment, pairs = np.zeros(shape), np.zeros(shape, dtype=int)
    onset = CURVATURES[FIRST_TOUCH - 1]
    for row, side in enumerate(("closing", "opening")):
        touching = side in gain
        beyond = np.maximum(CURVATURES - onset, 0.0) if touching else 0.0 * CURVATURES
        slope = gain.get(side, 1.0)
        moment[row] = 100.0 * np.outer(before(DIRECTIONS), CURVATURES - beyond)
        moment[row] += 100.0 * slope * np.outer(after(DIRECTIONS), beyond)
        pairs[row, :, FIRST_TOUCH:] = touching
    dims = ("side", "direction", "curvature")
    sweep = xr.Dataset(
        {
            "moment": (dims, moment),
            "contact_pairs": (dims, pairs),
            "symmetry_source": (("side", "direction"), np.tile(sources(fold, mirrored), (2, 1))),
        },
        coords={
            "side": ["closing", "opening"],
            "direction": DIRECTIONS,
            "curvature": CURVATURES,
        },
    )
    cosine, sine = np.cos(np.deg2rad(DIRECTIONS)), np.sin(np.deg2rad(DIRECTIONS))
    bending = np.stack([cosine**2, sine**2, 2.0 * cosine * sine])
    tangent = xr.Dataset(
        {
            "matrix": (("component", "other_component"), matrix),
            "stiffness": ("direction", np.einsum("in,ij,jn->n", bending, matrix, bending)),
        }
    )
    cell = xr.Dataset(
        {
            "outline_points": (("outline_point", "plane"), np.array(scale)),
            "outline_of_point": ("outline_point", np.zeros(len(scale), dtype=int)),
        }
    )
    return PatternData(name, sweep, tangent, cell)
