"""Other laws through the sheet law's interface: the native sheet's own, and one with contact."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from flexscale.mechanics.constant_strain import ConstantStrainTriangles
from flexscale.mechanics.edge_angles import EdgeAngleBending, EdgeStencils
from flexscale.mechanics.linear_law import (
    linear_energy,
    linear_law,
    linear_sheet,
    orthotropic_matrix,
)
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mechanics.sheet_shell import SheetShell
from flexscale.mechanics.sheet_triangles import SheetTriangles
from flexscale.mechanics.shell_law import bending_energy, membrane_energy, shell_law
from flexscale.sheets.bent_sheet import SheetOptions, bend_sheet
from flexscale.status import SolveStatus
from tests.derivatives import full_hessian, relative_error
from tests.mechanics.test_edge_angles import POINTS
from tests.mechanics.test_energies import CORNERS, LAMBDA, MU, NU, build_shell, edge_normals

THICKNESS, STIFFNESS = 0.4, 0.18


@njit
def native_energy(e, b, p):
    a = np.array([1.0 + e[0], e[1], 1.0 + e[2]])
    area = np.sqrt(a[0] * a[2] - a[1] ** 2)
    membrane = membrane_energy(e[0], e[1], e[2], p[0], p[1])
    return p[2] * membrane + p[3] * bending_energy(a, b, area, p[4])


@njit
def native_law(e, b, p, grad, hess):
    shell_law(e, b, p[0], p[1], p[2], p[3], p[4], grad, hess)


@njit
def form_energy(e, b, p):
    """Bending quadratic in the second form: D/2 [(tr b)^2 - 2 (1 - nu) det b]."""
    bending = 0.5 * (b[0] + b[2]) ** 2 - (1.0 - p[4]) * (b[0] * b[2] - b[1] ** 2)
    return p[2] * membrane_energy(e[0], e[1], e[2], p[0], p[1]) + p[3] * bending


@njit
def form_law(e, b, p, grad, hess):
    shell_law(e, b, p[0], p[1], p[2], 0.0, p[4], grad, hess)
    matrix = np.array([[1.0, 0.0, p[4]], [0.0, 2.0 * (1.0 - p[4]), 0.0], [p[4], 0.0, 1.0]])
    for i in range(3):
        for j in range(3):
            grad[3 + i] += p[3] * matrix[i, j] * b[j]
            if hess.shape[0]:
                hess[3 + i, 3 + j] += p[3] * matrix[i, j]


PARAMETERS = np.array([MU, LAMBDA, THICKNESS, STIFFNESS, NU])
NATIVE = SheetLaw(native_energy, native_law, PARAMETERS, MU * THICKNESS)
BY_FORM = SheetLaw(form_energy, form_law, PARAMETERS, MU * THICKNESS)


def compare(found, expected: list, y: np.ndarray) -> None:
    """Energy, gradient and Hessian of one element against the sum of others."""
    forces, wanted = np.zeros_like(y), np.zeros_like(y)
    found.add_gradient(y, forces)
    for energy in expected:
        energy.add_gradient(y, wanted)
    total = sum(energy.energy_parts(y).sum() for energy in expected)
    assert found.energy_parts(y).sum() == pytest.approx(total, rel=1e-12)
    assert relative_error(forces, wanted) < 1e-12
    hessian = sum(full_hessian(energy, y) for energy in expected)
    assert relative_error(full_hessian(found, y), hessian) < 1e-12


def test_c1_sheet_with_the_native_law_is_the_native_sheet():
    shell, rest = build_shell("turn")
    sheet = SheetShell(CORNERS, edge_normals(CORNERS), shell.vectors, NATIVE, rest)
    y = rest + 0.05 * np.random.default_rng(7).normal(size=rest.shape)
    compare(sheet, [shell], y)


def test_triangles_with_the_native_law_are_the_native_sheet():
    """Their bending is quadratic in the shape operator: that of the second form, on the turn."""
    stencils = EdgeStencils(
        POINTS[None, :3],
        np.arange(9)[None],
        np.array([[0.5, 0.5, 1.0]]),
        np.array([[1.0, -1.0, 0.0]]),
    )
    bending = EdgeAngleBending(stencils, bending_stiffness=STIFFNESS, poisson_ratio=NU)
    membrane = ConstantStrainTriangles(
        stencils.corners, stencils.vectors[:, :3],
        shear_modulus=MU, lame_lambda=LAMBDA, thickness=THICKNESS,
    )  # fmt: skip
    y = np.zeros((9, 3))
    y[:6, :2] = POINTS
    y += 0.1 * np.random.default_rng(8).normal(size=y.shape)
    compare(SheetTriangles(stencils, BY_FORM), [membrane, bending], y)


KAPPA_0, JUMP = 0.015, 200.0


@njit
def touching_energy(e, b, p):
    beyond = max(b[0] - KAPPA_0, 0.0)
    return linear_energy(e, b, p) + 0.5 * JUMP * beyond * beyond


@njit
def touching_law(e, b, p, grad, hess):
    linear_law(e, b, p, grad, hess)
    beyond = b[0] - KAPPA_0
    if beyond > 0.0:
        grad[3] += JUMP * beyond
        if hess.shape[0] > 0:
            hess[3, 3] += JUMP


@pytest.mark.parametrize("curvature", [0.01, 0.03, -0.03])
def test_a_law_with_a_kink_in_its_moment(curvature):
    """Two regimes along x, as scales that touch on one side: energy and moment of the cylinder."""
    linear = linear_sheet(
        orthotropic_matrix(4e3, 2.5e3, 0.0, 500.0), orthotropic_matrix(30.0, 12.0, 0.0, 6.0)
    )
    law = SheetLaw(touching_energy, touching_law, linear.parameters, linear.stiffness)
    beyond = max(curvature - KAPPA_0, 0.0)
    for element in ("c1", "edge_angle"):
        options = SheetOptions(element, size=3.0)
        bent = bend_sheet(law, length=30.0, width=15.0, curvature=curvature, options=options)
        assert bent.status == SolveStatus.converged
        energy = 0.5 * 30.0 * curvature**2 + 0.5 * JUMP * beyond**2
        assert bent.energy_density == pytest.approx(energy, rel=2e-3)
        assert bent.moment == pytest.approx(30.0 * curvature + JUMP * beyond, rel=2e-3)
