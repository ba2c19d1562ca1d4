"""Bending stiffness of the flat cell: three linear solves at kappa = 0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexscale.embedding.curvature_map import Bend
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.energy import FloatArray
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.patterns import Pattern

_SAMPLES = 1800


@dataclass(frozen=True)
class TangentStiffness:
    """Bending stiffness C of a pattern at rest.

    Attributes
    ----------
    matrix : (3, 3) N mm; energy density 1/2 k^T C k for k = (kappa_xx, kappa_yy, 2 kappa_xy) in
        mm-1.
    """

    matrix: FloatArray

    def stiffness(self, direction: ArrayLike) -> float | FloatArray:
        """a = C : (n n n n) for bending in `direction` [degrees], N mm; of the same shape."""
        angle = np.radians(np.asarray(direction, dtype=float))
        c, s = np.cos(angle), np.sin(angle)
        k = np.stack([c * c, s * s, 2.0 * c * s], axis=-1)
        a = np.einsum("...i,ij,...j->...", k, self.matrix, k)
        return float(a) if a.ndim == 0 else a

    @property
    def softest(self) -> float:
        """Direction of least stiffness, degrees in [0, 180)."""
        return self._extreme(1.0)

    @property
    def stiffest(self) -> float:
        """Direction of greatest stiffness, degrees in [0, 180)."""
        return self._extreme(-1.0)

    def _extreme(self, sign: float) -> float:
        directions = np.arange(_SAMPLES) * (180.0 / _SAMPLES)
        values = sign * np.asarray(self.stiffness(directions))
        best = int(np.argmin(values))
        before, here, after = values[best - 1], values[best], values[(best + 1) % _SAMPLES]
        bend = before - 2.0 * here + after
        shift = 0.5 * (before - after) / bend if bend > 1e-9 * abs(here) else 0.0
        return float((directions[best] + shift * 180.0 / _SAMPLES) % 180.0)

    def __str__(self) -> str:
        soft, stiff = self.softest, self.stiffest
        return (
            f"tangent stiffness: softest {self.stiffness(soft):.4g} N mm at {soft:.1f} degree, "
            f"stiffest {self.stiffness(stiff):.4g} N mm at {stiff:.1f} degree"
        )


def solve_tangent(problem: CellProblem) -> TangentStiffness:
    """Tangent of a cell problem.

    With R the rates of the world vectors for unit curvatures, K = d2E/dy2 and H = J^T K J at rest,
    C = (R^T K R - f^T H^-1 f) / A, f = J^T K R, H^-1 under the mean-offset constraint.
    """
    embedding, pull_back = problem.embedding, problem.pull_back
    cell = problem.bent(Bend(0.0, 0.0))
    state = cell.evaluate(embedding.rest)
    blocks = pull_back.pair_blocks(state.world.y)
    problem.system.factorize(cell.hessian_values(state))
    # kappa_xy counts once: 2 kappa_xy = 1 is half the tensor e1 e2 + e2 e1.
    factors = (1.0, 1.0, 0.5)
    found = embedding.world_map.flat_rates(embedding.rest)
    rates = [factor * rate for factor, rate in zip(factors, found, strict=True)]
    stressed = [pull_back.multiply(blocks, r) for r in rates]
    loads = [embedding.world_map.pull_gradient(state.world, s)[problem.active] for s in stressed]
    relaxed = [problem.system.solve(-load)[0] for load in loads]
    matrix = np.array(
        [
            [np.sum(rates[i] * stressed[j]) + loads[i] @ relaxed[j] for j in range(3)]
            for i in range(3)
        ]
    )
    return TangentStiffness(0.5 * (matrix + matrix.T) / problem.area)


def tangent_stiffness(
    pattern: Pattern,
    *,
    mesh: MeshOptions | None = None,
    substrate: SubstrateOptions | None = None,
    scales: ScaleOptions | None = None,
    linear_solver: str = "auto",
) -> TangentStiffness:
    """Bending stiffness tensor of a pattern at rest, in seconds.

    Parameters
    ----------
    pattern : the scale pattern.
    mesh : element sizes; the default mesh if not given.
    substrate : elements of the sheet; the default ones if not given.
    scales : how scales are modeled; the default if not given.
    linear_solver : "auto", "pardiso" or "superlu".

    Examples
    --------
    >>> import flexscale as fs
    >>> tangent = fs.tangent_stiffness(fs.Pattern(fs.Tiling("IH76")))
    >>> bool(tangent.stiffness(45.0) > tangent.stiffness(0.0))
    True
    """
    contact = ContactOptions(enabled=False)
    problem = CellProblem.from_pattern(
        pattern,
        mesh,
        contact=contact,
        substrate=substrate,
        scales=scales,
        linear_solver=linear_solver,
    )
    return solve_tangent(problem)
