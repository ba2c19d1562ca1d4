"""Kernels side by side with other libraries, and what an iteration costs beside its factorization.

    python benchmarks/solver_speed.py [--output FILE]

In one run on one thread: element gradients and Hessians of Neo-Hookean tets against FElupe and
scikit-fem, which must give the same numbers (pip install felupe scikit-fem); the paper's triangles
with edge angles; the sheet of squares at about equal error, C1 against edge angles; and a Newton
iteration of squares and hexagons against the bare factorization of its matrix, with the share of
contact. Times of tets leave out the sparse matrix.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from newton_iteration import TOUCHING, milliseconds, split
from report import output_file, report
from substrate_elements import SMOOTH, UNIFORM, measure, options

import flexscale as fs
from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.mechanics.energy import block_pairs
from flexscale.mechanics.neo_hookean import NeoHookeanTets
from flexscale.mesh.torus import build_mesh

ANGLES = UNIFORM[2]  # with twice the error of the coarsest C1 mesh
DIAGONAL = 7591.5  # D, stiffness of squares along the diagonal, by the finest mesh of that page
MU, LAMBDA = fs.PETG.shear_modulus, fs.PETG.lame_lambda


def tet_mesh() -> tuple[FloatArray, IntArray]:
    """Vertices and linear tets of a finely meshed hexagonal scale."""
    mesh = build_mesh(
        fs.named_pattern("hexagon"),
        fs.MeshOptions(scale_order=1, scale_size=0.6, scale_corner=0.3, scale_layers=8),
    )
    return mesh.scale_positions, mesh.tets


def felupe_work(
    rest: FloatArray, tets: IntArray, y: FloatArray
) -> Callable[[], tuple[FloatArray, FloatArray]]:
    """Element gradients (n, 4, 3) and Hessians (n, 4, 3, 4, 3) by FElupe."""
    import felupe

    mesh = felupe.Mesh(rest, tets, "tetra")
    region = felupe.RegionTetra(mesh)
    field = felupe.FieldContainer([felupe.Field(region, dim=3, values=y - rest)])
    material = felupe.NeoHookeCompressible(mu=MU, lmbda=LAMBDA)

    def work() -> tuple[FloatArray, FloatArray]:
        deformation = field.extract()
        stress = material.gradient([*deformation, None])[:1]
        elasticity = material.hessian([*deformation, None])
        force = felupe.IntegralForm(stress, field, region.dV).integrate()[0]
        stiffness = felupe.IntegralForm(elasticity, field, region.dV, field).integrate()[0]
        return np.moveaxis(force, -1, 0), np.moveaxis(stiffness, -1, 0)

    return work


def skfem_work(
    rest: FloatArray, tets: IntArray, y: FloatArray
) -> Callable[[], tuple[FloatArray, FloatArray]]:
    """Element gradients (12, n) and Hessians (12, 12, n) by scikit-fem, summed over nothing."""
    import skfem
    from skfem.helpers import ddot, grad, identity, inv, transpose

    mesh = skfem.MeshTet(rest.T.copy(), tets.T.copy())
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP1()), intorder=1)
    moved = np.empty(basis.N)
    moved[basis.nodal_dofs] = (y - rest).T

    def kinematics(w):  # type: ignore[no-untyped-def]
        f = grad(w["moved"]) + identity(grad(w["moved"]))
        inverse = inv(f)
        jacobian = np.linalg.det(np.moveaxis(f, (0, 1), (-2, -1)))
        return f, transpose(inverse), np.log(jacobian)

    @skfem.LinearForm
    def force(v, w):  # type: ignore[no-untyped-def]
        f, dual, log = kinematics(w)
        return ddot(MU * f + (LAMBDA * log - MU) * dual, grad(v))

    @skfem.BilinearForm
    def stiffness(u, v, w):  # type: ignore[no-untyped-def]
        _, dual, log = kinematics(w)
        du, dv = grad(u), grad(v)
        turned = np.einsum("ik...,lk...,lj...->ij...", dual, du, dual)
        return (
            MU * ddot(du, dv)
            + LAMBDA * ddot(dual, du) * ddot(dual, dv)
            - (LAMBDA * log - MU) * ddot(turned, dv)
        )

    def work() -> tuple[FloatArray, FloatArray]:
        given = {"moved": basis.interpolate(moved)}
        return force.elemental(basis, **given).data, stiffness.elemental(basis, **given).data

    return work


def tets_report() -> list[str]:
    """Table of tets."""
    rest, tets = tet_mesh()
    y = rest + 0.02 * np.sin(0.3 * rest[:, [1, 2, 0]])
    elements = NeoHookeanTets(rest, tets, tets, MU, LAMBDA)
    gradient = np.zeros_like(y)

    def ours() -> FloatArray:
        gradient[:] = 0.0
        elements.add_gradient(y, gradient)
        return elements.hessian_blocks(y)

    blocks, n = ours(), len(tets)
    i, j = block_pairs(4)
    energy = elements.energy_parts(y).sum()
    direction = np.random.default_rng(0).normal(size=y.shape)
    local = direction[tets]
    twice = np.where(i == j, 1.0, 2.0)
    curvature = np.einsum("p,npcd,npc,npd->", twice, blocks, local[:, i], local[:, j])
    times = {"FlexScale": milliseconds(ours)}
    found = {"FlexScale": (float((gradient * direction).sum()), float(curvature))}
    for name, make in (("FElupe", felupe_work), ("scikit-fem", skfem_work)):
        try:
            work = make(rest, tets, y)
        except ImportError:
            print(f"{name} is not installed and left out", flush=True)
            continue
        force, stiffness = work()
        times[name] = milliseconds(work)
        if name == "FElupe":
            found[name] = (
                float(np.einsum("nac,nac->", force, local)),
                float(np.einsum("nacbd,nac,nbd->", stiffness, local, local)),
            )
        else:
            found[name] = (
                float(np.einsum("kn,nk->", force.reshape(12, n), local.reshape(n, 12))),
                float(
                    np.einsum(
                        "kln,nk,nl->",
                        stiffness.reshape(12, 12, n),
                        local.reshape(n, 12),
                        local.reshape(n, 12),
                    )
                ),
            )
    own = times["FlexScale"]
    rows = [f"## {n:,} linear tets, gradient and Hessian", ""]
    rows += ["| | µs a tet | over FlexScale | dE, off by | d2E, off by |", "|---|---|---|---|---|"]
    for name, duration in times.items():
        off = [abs(a / b - 1.0) for a, b in zip(found[name], found["FlexScale"], strict=True)]
        rows.append(
            f"| {name} | {1e3 * duration / n:.2f} | {duration / own:.1f} | {off[0]:.0e} "
            f"| {off[1]:.0e} |"
        )
    return [*rows, "", f"Energy of the state {energy:.4g} N mm. Goal: 0.3 µs.", ""]


def triangles_report() -> list[str]:
    """Triangles with edge angles, and the sheet's assembly at equal error."""
    pattern = fs.Pattern(fs.Tiling("IH76"))
    problem = CellProblem.from_pattern(
        pattern,
        fs.NativeModel(
            "shell",
            contact=fs.ContactOptions(enabled=False),
            substrate=fs.SubstrateOptions("edge_angle"),
            mesh=options(4, 0.05, 0.05),
        ),
    )
    y = problem.embedding.world_map.place(problem.embedding.rest, Bend(0.0, 0.0)).y
    sheet = problem.energies[:2]
    count = len(sheet[1].vectors)

    def work() -> None:
        gradient = np.zeros_like(y)
        for energy in sheet:
            energy.energy_parts(y)
            energy.add_gradient(y, gradient)
            energy.hessian_blocks(y)

    duration = milliseconds(work)
    smooth = measure("IH76", "c1", options(*SMOOTH[0]))
    angles = measure("IH76", "edge_angle", options(*ANGLES, ANGLES[1]))
    errors = [100.0 * (row.values[-1] / DIAGONAL - 1.0) for row in (smooth, angles)]
    ratio = angles.assembly / smooth.assembly
    return [
        f"## Edge angles, {count:,} triangles",
        "",
        f"Energy, gradient and Hessian, membrane and bending: {1e3 * duration / count:.2f} µs a "
        "triangle (goal 1.3; libshell in C++ 13).",
        "",
        f"Assembly of squares' sheet: C1 {1e3 * smooth.assembly:.0f} ms with {smooth.unknowns:,} "
        f"unknowns ({errors[0]:+.1f} % along the diagonal), edge angles {1e3 * angles.assembly:.0f}"
        f" ms with {angles.unknowns:,} ({errors[1]:+.1f} %): {ratio:.0f} times (goal 10).",
        "",
    ]


def iteration_report() -> list[str]:
    """A Newton iteration against its factorization."""
    rows = ["## A Newton iteration in contact", ""]
    rows += ["| | ms | over the factorization (goal 1.5) | contact, % (goal 25) |"]
    rows += ["|---|---|---|---|"]
    for family, name in (("IH76", "squares"), ("IH20", "hexagons")):
        parts = split(CellProblem.from_pattern(fs.Pattern(fs.Tiling(family))), TOUCHING)
        numbers = [parts[key] for key in ("sum", "sum / factorization", "contact's share, %")]
        rows.append(f"| {name} | " + " | ".join(f"{number:.1f}" for number in numbers) + " |")
    return [*rows, ""]


def main() -> None:
    """Print the tables, and write them if asked."""
    output = output_file(__doc__)
    rows = ["# Speed of the native solver", ""]
    rows += tets_report() + triangles_report() + iteration_report()
    report(rows, output)


if __name__ == "__main__":
    main()
