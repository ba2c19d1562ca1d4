"""Macro laws with random anisotropy, for the tests of `tensor_law`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexscale.macro.harmonics import Harmonics, stiffness_harmonics
from flexscale.macro.law_table import build_law_table
from flexscale.macro.polar import PolarLaw
from flexscale.macro.tensor_law import energy, law

VARIANTS = ("tangent", "paper")
NO_HESSIAN = np.zeros((0, 0))


def stiffness(seed: int, size: float) -> np.ndarray:
    """(3, 3) positive definite, without any symmetry but its own."""
    root = np.random.default_rng(seed).standard_normal((3, 3))
    return size * (root @ root.T + 0.3 * np.eye(3))


def harmonics(seed: int, mean: float, share: float = 0.05) -> Harmonics:
    rng = np.random.default_rng(seed)
    cosine, sine = mean * share * rng.standard_normal((2, 4))
    cosine[0], sine[0] = mean, 0.0
    return Harmonics(cosine, sine)


TANGENT, IN_PLANE, BIAXIAL = stiffness(1, 60.0), stiffness(2, 100.0), 3000.0
SOFTENING = 8.0
#: Closing touches in every direction; opening, by 1/κ0, in part of the circle only.
POLAR = PolarLaw(
    ("closing", "opening"),
    stiffness_harmonics(TANGENT),
    (harmonics(3, 900.0), harmonics(4, 500.0)),
    (harmonics(5, 0.01), harmonics(6, 45.0, 0.5)),
    ("kappa_0", "1/kappa_0"),
    0.02,
    SOFTENING,
)


def polar_of(variant: str) -> PolarLaw:
    """The law of a variant: "paper" does not soften."""
    return POLAR if variant == "tangent" else replace(POLAR, softening=0.0)


def table(variant: str, turn: float = 0.0, polar: PolarLaw = POLAR) -> np.ndarray:
    """Table of the pattern above, turned by an angle (rad)."""
    return build_law_table(
        turn_polar(polar, turn),
        variant=variant,  # type: ignore[arg-type]
        tangent=turn_stiffness(TANGENT, turn),
        in_plane=turn_stiffness(IN_PLANE, turn),
        w_biaxial=BIAXIAL,
    )


def turn_polar(polar: PolarLaw, turn: float) -> PolarLaw:
    def turned(item: Harmonics) -> Harmonics:
        order = np.arange(len(item.cosine))
        both = (item.cosine + 1j * item.sine) * np.exp(2j * order * turn)
        return Harmonics(both.real, both.imag)

    return PolarLaw(
        polar.sides,
        turned(polar.a),
        tuple(map(turned, polar.b)),
        tuple(map(turned, polar.onset)),
        polar.onset_quantity,
        polar.largest_curvature,
        polar.softening,
    )


def rotation(turn: float) -> np.ndarray:
    return np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])


def turn_form(form: np.ndarray, turn: float) -> np.ndarray:
    """(11, 12, 22) of R T Rᵀ."""
    r = rotation(turn)
    tensor = r @ np.array([[form[0], form[1]], [form[1], form[2]]]) @ r.T
    return np.array([tensor[0, 0], tensor[0, 1], tensor[1, 1]])


def turn_stiffness(matrix: np.ndarray, turn: float) -> np.ndarray:
    """Turned along, for (xx, yy, 2 xy)."""
    columns = []
    for xx, yy, double in np.eye(3):
        back = turn_form(np.array([xx, 0.5 * double, yy]), -turn)
        columns.append([back[0], back[2], 2.0 * back[1]])
    to_own = np.array(columns).T
    return to_own.T @ matrix @ to_own


def random_state(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """e of some percent and b of some times the onset's curvature."""
    return 0.05 * rng.standard_normal(3), 0.02 * rng.standard_normal(3)


def energy_at(state: np.ndarray, parameters: np.ndarray) -> float:
    return energy(state[:3], state[3:], parameters)


def gradient_at(state: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    grad = np.empty(6)
    law(state[:3], state[3:], parameters, grad, NO_HESSIAN)
    return grad


def hessian_at(state: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    grad, hess = np.empty(6), np.empty((6, 6))
    law(state[:3], state[3:], parameters, grad, hess)
    return hess


def principal_curvatures(b: np.ndarray) -> np.ndarray:
    return np.linalg.eigvalsh([[b[0], b[1]], [b[1], b[2]]])
