"""The deformed cell at chosen samples, for pictures and for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.build import build_dataset
from flexscale.datasets.kinds.shape import SHAPE
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.build import build_problem
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.sweep import check_sweep
from flexscale.patterns import Pattern

if TYPE_CHECKING:
    import xarray as xr


def solve_shapes(
    pattern: Pattern,
    bends: Sequence[tuple[str, float, float]],
    native: NativeModel | None = None,
) -> xr.Dataset:
    """Displacements of scales and substrate under some bends.

    Parameters
    ----------
    pattern : the scale pattern.
    bends : (side, direction [degree], curvature [mm-1, > 0]) of each sample.
    native : the native model, the default one if not given.

    Returns
    -------
    xarray.Dataset of kind shape/1; displacements of a sample that did not converge are NaN.
    """
    native = native or NativeModel()
    for side, direction, curvature in bends:
        check_sweep(pattern, [direction], [curvature], [side])
    problem = build_problem(pattern, native)
    display = problem.display()
    rest = display.rest
    displacement = np.full((len(bends), *rest.shape), np.nan)
    force = np.full((len(bends), len(rest)), np.nan)
    stretch = np.full((len(bends), 3), np.nan)
    signed = np.empty(len(bends))
    for k, (side, direction, curvature) in enumerate(bends):
        line = Line(side, float(direction), (float(curvature),))
        (sample,) = follow_line(problem, line, native.solver)
        signed[k] = line.bend(curvature).curvature
        if "state" in sample:
            displacement[k] = display.place(sample["state"], line.bend(curvature)) - rest
            stretch[k] = sample["stretch"]
            force[k] = display.contact_force(sample["state"], line.bend(curvature))
    torus = display.mesh
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
        **native.to_config(),
        "bends": [list(bend) for bend in bends],
    }
    scalars = pattern_scalars(pattern, native)
    return build_dataset(SHAPE, arrays, scalars=scalars, config=config)
