"""The deformed cell at chosen samples, for pictures and for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.build import build_dataset
from flexscale.embedding.curvature_map import Bend
from flexscale.embedding.display import Display
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.line import Line, follow_line
from flexscale.homogenize.sweep import check_sweep
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.energy import FloatArray
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.patterns import Pattern
from flexscale.solve.solver_options import SolverOptions

if TYPE_CHECKING:
    import xarray as xr


def solve_shapes(
    pattern: Pattern,
    bends: Sequence[tuple[str, float, float]],
    *,
    mesh: MeshOptions | None = None,
    solver: SolverOptions | None = None,
    contact: ContactOptions | None = None,
    substrate: SubstrateOptions | None = None,
    scales: ScaleOptions | None = None,
) -> xr.Dataset:
    """Displacements of scales and substrate under some bends.

    Parameters
    ----------
    pattern : the scale pattern.
    bends : (side, direction [degree], curvature [mm-1, > 0]) of each sample.
    mesh, solver, contact, substrate, scales : element sizes, solver, contact, substrate and scale
        options; the defaults if not given.

    Returns
    -------
    xarray.Dataset of kind shape/1; displacements of a sample that did not converge are NaN.
    """
    mesh, solver = mesh or MeshOptions(), solver or SolverOptions()
    for side, direction, curvature in bends:
        check_sweep(pattern, [direction], [curvature], [side])
    contact, substrate = contact or ContactOptions(), substrate or SubstrateOptions()
    scales = scales or ScaleOptions()
    problem = CellProblem.from_pattern(
        pattern,
        mesh,
        contact=contact,
        substrate=substrate,
        scales=scales,
        linear_solver=solver.linear_solver,
    )
    display = Display(problem.embedding)
    rest = display.place(problem.embedding.rest, Bend(0.0, 0.0))
    displacement = np.full((len(bends), *rest.shape), np.nan)
    force = np.full((len(bends), len(rest)), np.nan)
    stretch = np.full((len(bends), 3), np.nan)
    signed = np.empty(len(bends))
    for k, (side, direction, curvature) in enumerate(bends):
        line = Line(side, float(direction), (float(curvature),))
        (sample,) = follow_line(problem, line, solver)
        signed[k] = line.bend(curvature).curvature
        if "state" in sample:
            displacement[k] = display.place(sample["state"], line.bend(curvature)) - rest
            stretch[k] = sample["stretch"]
            force[k] = _contact_force(problem, line.bend(curvature), sample["state"], len(rest))
    torus = problem.mesh
    arrays: dict[str, Any] = {
        "sample_direction": np.array([float(direction) for _, direction, _ in bends]),
        "sample_curvature": signed,
        "lattice": torus.lattice,
        "stretch": stretch,
        "points": rest,
        "displacement": displacement,
        "triangles": display.triangles,
        "triangle_scale": torus.triangle_scale,
        "tets": torus.tets,
        "tet_scale": torus.tet_scale,
        "surface_triangles": torus.surface_triangles,
        "surface_scale": torus.surface_scale,
    }
    if problem.contact is not None:
        arrays["contact_force"] = force
    config = {
        "pattern": pattern.to_config(),
        "mesh": mesh.to_config(),
        "solver": solver.to_config(),
        "contact": contact.to_config(),
        "substrate": substrate.to_config(),
        "scales": scales.to_config(),
        "bends": [list(bend) for bend in bends],
    }
    return build_dataset("shape", arrays, scalars=pattern_scalars(pattern, mesh), config=config)


def _contact_force(problem: CellProblem, bend: Bend, z: FloatArray, n_points: int) -> FloatArray:
    """(n_points,) N; the scale vertices come first among the points."""
    force = np.zeros(n_points)
    if problem.contact is not None:
        y = problem.embedding.world_map.place(z, bend).y
        n = problem.mesh.n_scale_vertices
        force[:n] = problem.contact.vertex_forces(y, n)
    return force
