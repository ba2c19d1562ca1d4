"""Step `shape`: a deformed cell to look at."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.build import build_dataset
from flexscale.embedding.curvature_map import Bend
from flexscale.homogenize import CellProblem, SolverOptions
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.line import Line, follow_line
from flexscale.mesh.bonds import build_bonds
from flexscale.steps.base import Resources
from flexscale.steps.catalog import ShapeParameters

if TYPE_CHECKING:
    import xarray as xr

_N_STEPS = 4  # samples on the way to the wanted curvature


def compute(
    parameters: ShapeParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind shape/1; a state that did not converge has no displacement (nan)."""
    pattern, options = parameters.build_pattern(), parameters.build_mesh_options()
    problem = CellProblem.from_pattern(pattern, options)
    drawing = _Drawing(problem)
    rest = drawing.points(problem.embedding.rest, Bend(0.0, 0.0))
    solver = SolverOptions(**parameters.solver)
    stretches, displacements, curvatures = [], [], []
    for sample in parameters.samples:
        path = np.linspace(0.0, sample.curvature, _N_STEPS + 1)
        line = Line(sample.side, sample.direction, tuple(path.tolist()))
        *_, reached = follow_line(problem, line, solver)
        z = reached.get("state", np.full(problem.embedding.n_unknowns, np.nan))
        bend = line.bend(sample.curvature)
        displacements.append(drawing.points(z, bend) - rest)
        stretches.append(np.array([1.0, 1.0, 0.0]) + z[-3:])
        curvatures.append(bend.curvature)
    arrays = drawing.topology() | {
        "points": rest,
        "displacement": np.array(displacements),
        "stretch": np.array(stretches),
        "sample_direction": [sample.direction for sample in parameters.samples],
        "sample_curvature": curvatures,
    }
    scalars = pattern_scalars(pattern, options)
    config = parameters.model_dump(mode="json")
    return build_dataset("shape", arrays, scalars=scalars, config=config)


class _Drawing:
    """The points of one whole cell, scales first, and the triangles and tets between them.

    Gap triangles take the world vectors of their corners, lattice images among them; triangles
    under a scale follow its base, which they are bonded to.
    """

    def __init__(self, problem: CellProblem) -> None:
        self.mesh, self.world_map = problem.mesh, problem.embedding.world_map
        mesh = self.mesh
        corner_rows = problem.embedding.shell.vectors[:, [0, 3, 6]]
        self.gap_rows, gap_index = np.unique(corner_rows, return_inverse=True)
        covered = np.flatnonzero(mesh.triangle_scale >= 0)
        under, under_index = np.unique(mesh.triangles[covered], return_inverse=True)
        self.bonds = build_bonds(mesh, mesh.positions[under], mesh.vertex_scale[under])
        n_scale, n_gap = mesh.n_scale_vertices, len(self.gap_rows)
        gap_triangles = n_scale + gap_index.reshape(-1, 3)
        covered_triangles = n_scale + n_gap + under_index.reshape(-1, 3)
        self.triangles = np.concatenate([gap_triangles, covered_triangles])
        gap_scale = np.full(len(gap_triangles), -1)
        self.triangle_scale = np.concatenate([gap_scale, mesh.triangle_scale[covered]])

    def points(self, z: np.ndarray, bend: Bend) -> np.ndarray:
        """World positions (n_points, 3) of the state z, mm."""
        y = self.world_map.place(z, bend).y
        scales = y[: self.mesh.n_scale_vertices]
        bonds = self.bonds
        weighted = bonds.values[:, None] * scales[bonds.scale_vertices]
        under = np.add.reduceat(weighted, bonds.indptr[:-1])
        return np.concatenate([scales, y[self.gap_rows], under])

    def topology(self) -> dict[str, Any]:
        """Arrays of the shape dataset that do not depend on the state."""
        mesh = self.mesh
        return {
            "lattice": mesh.lattice,
            "triangles": self.triangles,
            "triangle_scale": self.triangle_scale,
            "tets": mesh.tets,
            "tet_scale": mesh.tet_scale,
            "surface_triangles": mesh.surface_triangles,
            "surface_scale": mesh.surface_scale,
        }
