"""Fit of a joint's law: a polynomial in (u, w, phi) whose quadratic part is the linear joint's.

Energies and the three forces of all states are fitted together by linear least squares, each in
its own root mean square over the states, and each state by how far it is from rest: small bending
is met first, and by all joints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.joints.states import SectionState

DEGREE = 8
GUARD_WEIGHT = 0.1  # of states beyond the range
TANGENT_WEIGHT = 0.1  # of second derivatives, beside energies and forces
NEAR_REST = 0.05  # energy, in its root mean square, below which a state weighs no more
_PLANE = [0, 1, 3]  # of q: what the polynomial beyond the quadratic part depends on
_ROWS, _COLUMNS = [0, 0, 0, 1, 1, 3], [0, 1, 3, 1, 3, 3]  # of the tangent


@dataclass(frozen=True)
class Samples:
    """States of a section, in thicknesses and moduli of the sheet.

    Attributes
    ----------
    poses : (n, 4) q.
    energies : (n,) W.
    forces : (n, 4) dW/dq.
    tangents : (n, 4, 4) d2W/dq2.
    """

    poses: FloatArray
    energies: FloatArray
    forces: FloatArray
    tangents: FloatArray

    @classmethod
    def of(cls, states: Sequence[SectionState]) -> Samples:
        """Of states of a section."""
        return cls(
            np.array([state.pose for state in states]),
            np.array([state.energy for state in states]),
            np.array([state.forces for state in states]),
            np.array([state.tangent for state in states]),
        )


def fit_terms(
    samples: Samples,
    guards: Samples,
    stiffness: FloatArray,
    degree: int = DEGREE,
) -> tuple[IntArray, FloatArray]:
    """Exponents (n_terms, 4) and coefficients (n_terms,) of a law.

    Parameters
    ----------
    samples : states without slide.
    guards : states beyond the range of poses, fitted loosely.
    stiffness : (4, 4) of the linear joint, in E t^2.
    degree : of the polynomial.
    """
    quadratic, given = _quadratic_terms(stiffness)
    free = _higher_terms(degree)
    sizes = _Sizes.of(samples)
    rows, targets = [], []
    for states, weight in ((samples, 1.0), (guards, GUARD_WEIGHT)):
        rest = _term_columns(quadratic, states.poses, sizes)
        wanted = np.concatenate(
            [
                states.energies[:, None] / sizes.energy,
                states.forces[:, _PLANE] / sizes.forces,
                TANGENT_WEIGHT * states.tangents[:, _ROWS, _COLUMNS] / sizes.tangents,
            ],
            axis=1,
        )
        weights = weight / np.sqrt(NEAR_REST + states.energies / sizes.energy)
        matrix = _term_columns(free, states.poses, sizes) * weights[:, None, None]
        rows.append(matrix.reshape(-1, len(free)))
        targets.append(((wanted - rest @ given) * weights[:, None]).ravel())
    matrix = np.concatenate(rows)
    norms = np.sqrt((matrix**2).sum(axis=0))
    found = np.linalg.lstsq(matrix / norms, np.concatenate(targets), rcond=1e-12)[0] / norms
    exponents, coefficients = np.concatenate([quadratic, free]), np.concatenate([given, found])
    order = np.lexsort((exponents[:, 3], exponents[:, 0], exponents[:, 1], exponents[:, 2]))
    return exponents[order], coefficients[order]


def evaluate_terms(
    exponents: IntArray, coefficients: FloatArray, poses: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Energies (n,) and forces (n, 4) of a polynomial at poses (n, 4), all without units."""
    values, slopes = _term_values(exponents, poses)
    return values @ coefficients, slopes @ coefficients


def fit_errors(exponents: IntArray, coefficients: FloatArray, samples: Samples) -> FloatArray:
    """(5,) root mean square errors of energy and forces, each over its root mean square."""
    energies, forces = evaluate_terms(exponents, coefficients, samples.poses)
    sizes = np.concatenate([[_rms(samples.energies)], _rms(samples.forces)])
    found = np.concatenate([[_rms(energies - samples.energies)], _rms(forces - samples.forces)])
    return np.divide(found, sizes, out=np.zeros(5), where=sizes > 0.0)


def with_stiffness(
    exponents: IntArray, coefficients: FloatArray, stiffness: FloatArray, poses: FloatArray
) -> FloatArray:
    """Coefficients (n_terms,) of the law with another stiffness (4, 4) at rest.

    A mesh's error is a share of the singular stress at the bond's edges, which a joint that is
    opened by more than a thickness has no more of than it had: far there, states are righter than
    the stiffness. The change of W is therefore q dK q / 2 faded by 1/(1 + (u/t)^2) where u > 0,
    which the higher terms are fitted to at `poses` (n, 4).
    """
    found = coefficients.copy()
    quadratic, wanted = _quadratic_terms(stiffness)
    change = np.zeros(len(wanted))
    for k, (row, value) in enumerate(zip(quadratic, wanted, strict=True)):
        place = (exponents == row).all(axis=1)
        change[k] = value - found[place][0]
        found[place] = value
    higher = exponents.sum(axis=1) > 2
    values, slopes = _term_values(exponents[higher], poses)
    left, left_forces = evaluate_terms(quadratic, change, poses)
    opened = np.maximum(poses[:, 0], 0.0)
    fading = 1.0 / (1.0 + opened**2) - 1.0
    left_forces = fading[:, None] * left_forces
    left_forces[:, 0] -= 2.0 * opened / (1.0 + opened**2) ** 2 * left
    matrix = np.concatenate([values[:, None], slopes[:, _PLANE]], axis=1).reshape(-1, higher.sum())
    target = np.concatenate([(fading * left)[:, None], left_forces[:, _PLANE]], axis=1).ravel()
    norms = np.sqrt((matrix**2).sum(axis=0))
    found[higher] += np.linalg.lstsq(matrix / norms, target, rcond=1e-6)[0] / norms
    return found


def _quadratic_terms(stiffness: FloatArray) -> tuple[IntArray, FloatArray]:
    pairs = [(0, 0), (0, 3), (3, 3), (1, 1), (2, 2)]
    exponents = np.zeros((len(pairs), 4), dtype=np.int64)
    for row, pair in enumerate(pairs):
        for coordinate in pair:
            exponents[row, coordinate] += 1
    return exponents, np.array([stiffness[i, j] * (0.5 if i == j else 1.0) for i, j in pairs])


def _higher_terms(degree: int) -> IntArray:
    return np.array(
        [
            (u, w, 0, phi)
            for w in range(0, degree + 1, 2)
            for u in range(degree + 1 - w)
            for phi in range(degree + 1 - w - u)
            if u + w + phi > 2
        ],
        dtype=np.int64,
    )


@dataclass(frozen=True)
class _Sizes:
    """Root mean squares of what is fitted."""

    energy: float
    forces: FloatArray
    tangents: FloatArray

    @classmethod
    def of(cls, samples: Samples) -> _Sizes:
        return cls(
            float(_rms(samples.energies)),
            _rms(samples.forces)[_PLANE],
            _rms(samples.tangents[:, _ROWS, _COLUMNS]),
        )


def _term_columns(exponents: IntArray, poses: FloatArray, sizes: _Sizes) -> FloatArray:
    """(n, 10, n_terms): energy, 3 forces and 6 second derivatives of terms, in their sizes."""
    values, slopes = _term_values(exponents, poses)
    bends = _term_bends(exponents, poses)
    return np.concatenate(
        [
            values[:, None] / sizes.energy,
            slopes[:, _PLANE] / sizes.forces[:, None],
            TANGENT_WEIGHT * bends / sizes.tangents[:, None],
        ],
        axis=1,
    )


def _term_values(exponents: IntArray, poses: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values (n, n_terms) of the monomials and their derivatives (n, 4, n_terms)."""
    values = _derivative(exponents, poses, ())
    return values, np.stack([_derivative(exponents, poses, (i,)) for i in range(4)], axis=1)


def _term_bends(exponents: IntArray, poses: FloatArray) -> FloatArray:
    """(n, 6, n_terms) second derivatives of the monomials in the plane."""
    pairs = zip(_ROWS, _COLUMNS, strict=True)
    return np.stack([_derivative(exponents, poses, pair) for pair in pairs], axis=1)


def _derivative(exponents: IntArray, poses: FloatArray, by: tuple[int, ...]) -> FloatArray:
    """(n, n_terms) of the monomials, differentiated by each of the named coordinates."""
    lowered, factor = exponents.copy(), np.ones(len(exponents))
    for coordinate in by:
        factor *= np.maximum(lowered[:, coordinate], 0)
        lowered[:, coordinate] -= 1
    powers = poses[:, None, :] ** np.maximum(lowered, 0)
    return factor * powers.prod(axis=2)


def _rms(values: FloatArray) -> FloatArray:
    return np.sqrt(np.mean(np.square(values), axis=0))
