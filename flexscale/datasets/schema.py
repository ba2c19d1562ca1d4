"""What each kind of dataset holds: one declarative table per kind.

The tables feed building (`build`), checking (`checks`) and the catalog. A change that readers
would notice raises the kind's version.
"""

from __future__ import annotations

from flexscale.datasets.sheet_schema import (
    NATIVE_RIG,
    NATIVE_SHEET,
    RIG,
    SHEET,
    TURNED_SHEET,
)
from flexscale.datasets.variables import STATUS_ATTRS, Schema, Variable
from flexscale.errors import UnknownNameError, suggest

_DIRECTION = Variable("direction", ("direction",), "float64", "degree", "bending direction")
_SAMPLE = ("side", "direction", "curvature")


def _sampled(name: str, units: str, long_name: str, **attrs: str) -> Variable:
    return Variable(name, _SAMPLE, "float64", units, long_name, attrs=attrs)


def _counted(name: str, long_name: str, *, optional: bool = False) -> Variable:
    return Variable(name, _SAMPLE, "int32", "1", long_name, optional=optional)


#: The parts of the energy density; they sum to it.
ENERGY_PARTS = tuple(
    f"energy_density_{part}" for part in ("membrane", "bending", "scales", "contact")
)

_RETURNING = {
    "comment": "of the equilibrium met on the way back from the next curvature, where the energy "
    "curved downward on the way there; another value than without `_returning` means that there "
    "is more than one branch; nan where the way was stable"
}

SWEEP = Schema(
    "sweep",
    1,
    "Bending of a periodic scaled sheet in many directions",
    coordinates=(
        Variable("side", ("side",), "text", "", "side to which the sheet is bent"),
        _DIRECTION,
        Variable("curvature", ("curvature",), "float64", "mm-1", "magnitude of the curvature"),
        Variable("component", ("component",), "text", "", "component of a symmetric 2x2 tensor"),
        Variable("side_sign", ("side",), "int8", "1", "sign of the curvature, scales on +n"),
        Variable("direction_rad", ("direction",), "float64", "rad", "bending direction"),
        Variable(
            "signed_curvature", ("side", "curvature"), "float64", "mm-1", "curvature, closing > 0"
        ),
    ),
    variables=(
        _sampled("energy_density", "N mm-1", "energy per rest area of the midsurface"),
        _sampled("energy_density_membrane", "N mm-1", "stretching energy of the substrate"),
        _sampled("energy_density_bending", "N mm-1", "bending energy of the substrate"),
        _sampled("energy_density_scales", "N mm-1", "elastic energy of the scales"),
        _sampled("energy_density_contact", "N mm-1", "contact energy of the scales"),
        _sampled(
            "moment",
            "N",
            "bending moment per width",
            method="derivative of the energy density by the curvature at fixed unknowns",
        ),
        *(
            Variable(name, _SAMPLE, "float64", units, long_name, True, _RETURNING, partial=True)
            for name, units, long_name in (
                ("energy_density_returning", "N mm-1", "energy per rest area, bent back"),
                ("moment_returning", "N", "bending moment per width, bent back"),
            )
        ),
        Variable(
            "stretch",
            (*_SAMPLE, "component"),
            "float64",
            "1",
            "symmetric stretch F of the lattice",
        ),
        _sampled("min_gap", "mm", "smallest distance between scales"),
        _counted("contact_pairs", "active contact pairs"),
        _sampled("contact_force", "N", "sum of the contact forces on the scales of a cell"),
        Variable(
            "barrier_stiffness",
            _SAMPLE,
            "float64",
            "N mm-3",
            "stiffness of the barrier between scales",
            optional=True,
            attrs={"comment": "raised where scales press so hard that they nearly meet"},
        ),
        _counted("newton_iterations", "Newton iterations"),
        _counted("alm_iterations", "augmented Lagrangian iterations", optional=True),
        _counted("negative_eigenvalues", "negative eigenvalues of the constrained Hessian"),
        _counted("saddles_left", "saddles met and left on the way to the sample", optional=True),
        _sampled("residual_norm", "N", "norm of the remaining force"),
        _sampled("mean_offset", "mm", "mean normal displacement of the substrate"),
        Variable("status", _SAMPLE, "int8", "1", "end of the solve", attrs=STATUS_ATTRS),
        Variable(
            "symmetry_source",
            ("side", "direction"),
            "float64",
            "degree",
            "direction that was computed; others follow by the pattern's symmetry",
        ),
    ),
)

_VOIGT = (
    Variable("component", ("component",), "text", "", "curvature or strain xx, yy, 2xy"),
    Variable(
        "other_component", ("other_component",), "text", "", "curvature or strain xx, yy, 2xy"
    ),
)
_BENDING = "stiffness C: energy density 1/2 k C k with k = (kxx, kyy, 2 kxy)"
_IN_PLANE = "in-plane stiffness A: energy density 1/2 E A E with E = (Exx, Eyy, 2 Exy)"


def _matrix(name: str, units: str, long_name: str) -> Variable:
    return Variable(name, ("component", "other_component"), "float64", units, long_name)


TANGENT = Schema(
    "tangent",
    2,
    "Stiffness of a periodic scaled sheet at rest",
    coordinates=(_DIRECTION, *_VOIGT),
    variables=(
        _matrix("matrix", "N mm", _BENDING),
        _matrix("in_plane", "N mm-1", _IN_PLANE),
        Variable(
            "stiffness", ("direction",), "float64", "N mm", "moment per curvature in a direction"
        ),
    ),
)


def _mesh(name: str, dims: str, dtype: str, long_name: str, units: str = "1") -> Variable:
    return Variable(name, tuple(dims.split()), dtype, units, long_name)


def _polygon(name: str, dims: str, dtype: str, long_name: str, units: str = "1") -> Variable:
    return Variable(name, tuple(dims.split()), dtype, units, long_name, optional=True)


CELL = Schema(
    "cell",
    1,
    "Geometry and mesh of one periodic cell",
    coordinates=(),
    variables=(
        _mesh("lattice", "lattice_vector plane", "float64", "lattice vectors t1, t2", "mm"),
        _mesh("positions", "vertex plane", "float64", "rest positions of the substrate", "mm"),
        _mesh("triangles", "triangle corner", "int32", "substrate triangles, ccw"),
        _mesh("triangle_offsets", "triangle corner lattice_vector", "int32", "lattice offsets"),
        _mesh("triangle_scale", "triangle", "int32", "covering scale, -1 in the gap"),
        _mesh("vertex_scale", "vertex", "int32", "scale that carries the vertex, -1 free"),
        _mesh("vertex_kind", "vertex", "int8", "0 free, 1 outline, 2 corner, 3 under a scale"),
        _mesh("outline_tangent", "vertex plane", "float64", "unit tangent of the outline"),
        _mesh("edges", "edge edge_end", "int32", "substrate edges"),
        _mesh("edge_shift", "edge lattice_vector", "int32", "lattice offset of the second end"),
        _mesh("triangle_edges", "triangle corner", "int32", "edge from corner i to i+1"),
        _mesh(
            "triangle_edge_offsets",
            "triangle corner lattice_vector",
            "int32",
            "lattice offset of the edge's first end",
        ),
        _mesh("edge_scale", "edge", "int32", "scale outline, -1 gap, -2 under a scale"),
        _mesh("scale_positions", "scale_vertex space", "float64", "rest positions", "mm"),
        _mesh("tets", "tet tet_corner", "int32", "tetrahedra of the scales"),
        _mesh("tet_scale", "tet", "int32", "scale of the tetrahedron"),
        _mesh("base_triangles", "base_triangle base_corner", "int32", "scale bases, ccw from +z"),
        _mesh("base_scale", "base_triangle", "int32", "scale of the base triangle"),
        _mesh("surface_triangles", "surface_triangle corner", "int32", "scale surfaces, outward"),
        _mesh("surface_scale", "surface_triangle", "int32", "scale of the surface triangle"),
        _mesh("n_scales", "", "int32", "number of scales in the cell"),
        _polygon("tile_points", "tile_point plane", "float64", "tile polygons, ccw", "mm"),
        _polygon("tile_of_point", "tile_point", "int32", "tile of the point"),
        _polygon("outline_points", "outline_point plane", "float64", "scale outlines, ccw", "mm"),
        _polygon("outline_of_point", "outline_point", "int32", "scale of the point"),
    ),
)

SHAPE = Schema(
    "shape",
    1,
    "Deformed cell at chosen samples of a sweep",
    coordinates=(
        _mesh("sample_direction", "sample", "float64", "bending direction", "degree"),
        _mesh("sample_curvature", "sample", "float64", "signed curvature, closing > 0", "mm-1"),
    ),
    variables=(
        _mesh("lattice", "lattice_vector plane", "float64", "lattice vectors t1, t2", "mm"),
        _mesh("stretch", "sample component", "float64", "stretch F of the lattice: xx, yy, xy"),
        _mesh("points", "point space", "float64", "rest positions, scales and substrate", "mm"),
        _mesh("displacement", "sample point space", "float64", "displacement", "mm"),
        Variable(
            "contact_force",
            ("sample", "point"),
            "float64",
            "N",
            "length of the force by which other scales press on a point",
            optional=True,
        ),
        _mesh("triangles", "triangle corner", "int32", "substrate triangles into points"),
        _mesh("triangle_scale", "triangle", "int32", "covering scale, -1 in the gap"),
        _mesh("tets", "tet tet_corner", "int32", "scale tetrahedra into points"),
        _mesh("tet_scale", "tet", "int32", "scale of the tetrahedron"),
        _mesh("surface_triangles", "surface_triangle corner", "int32", "scale surfaces, outward"),
        _mesh("surface_scale", "surface_triangle", "int32", "scale of the surface triangle"),
    ),
)

_MIXED = {"comment": "units: see parameter_units"}
_COEFFICIENT = {"comment": "units: see parameter_units; mm where onset_quantity is 1/kappa_0"}
_PARAMETRIC = ("side", "parameter", "direction")
_ERROR = "assessment side direction"
_OVERALL = "assessment side"

FIT = Schema(
    "fit",
    2,
    "Macro model of a scaled sheet: two-regime bending law in every direction",
    coordinates=(
        Variable("side", ("side",), "text", "", "side to which the sheet is bent"),
        _DIRECTION,
        Variable("parameter", ("parameter",), "text", "", "a before, b after contact at kappa_0"),
        Variable("parameter_units", ("parameter",), "text", "", "units of the parameter"),
        *_VOIGT,
        Variable("harmonic", ("harmonic",), "int32", "1", "order k of cos 2k and sin 2k"),
        Variable("assessment", ("assessment",), "text", "", "samples the errors are taken at"),
        Variable("statistic", ("statistic",), "text", "", "statistic over samples"),
    ),
    variables=(
        Variable(
            "cos_coefficient",
            ("side", "parameter", "harmonic"),
            "float64",
            "",
            "coefficient of cos 2k direction",
            attrs=_COEFFICIENT,
        ),
        Variable(
            "sin_coefficient",
            ("side", "parameter", "harmonic"),
            "float64",
            "",
            "coefficient of sin 2k direction",
            attrs=_COEFFICIENT,
        ),
        Variable("order", ("parameter",), "int32", "1", "highest order of the parameter"),
        Variable(
            "onset_quantity",
            ("side",),
            "text",
            "",
            "what the harmonics of kappa_0 interpolate: kappa_0, 1/kappa_0, or none (no contact)",
        ),
        Variable(
            "directional_value",
            _PARAMETRIC,
            "float64",
            "",
            "parameter fitted in one direction, nan without contact",
            attrs=_MIXED,
        ),
        Variable(
            "fitted_value",
            _PARAMETRIC,
            "float64",
            "",
            "parameter by the harmonics, nan without contact",
            attrs=_MIXED,
        ),
        _mesh("samples_before", "side direction", "int32", "samples up to the onset"),
        _mesh("samples_beyond", "side direction", "int32", "samples beyond the onset"),
        _mesh("energy_rmse", _ERROR, "float64", "error of the energy", "N mm-1"),
        _mesh("moment_rmse", _ERROR, "float64", "error of the moment", "N"),
        _mesh(
            "moment_error",
            f"{_ERROR} statistic",
            "float64",
            "relative error of the moment",
        ),
        _mesh("overall_energy_rmse", _OVERALL, "float64", "error of energy", "N mm-1"),
        _mesh("overall_moment_rmse", _OVERALL, "float64", "error of the moment", "N"),
        _mesh(
            "overall_moment_error",
            f"{_OVERALL} statistic",
            "float64",
            "relative error of the moment over all directions",
        ),
        _mesh("largest_curvature", "", "float64", "largest curvature sampled", "mm-1"),
        _mesh("n_parameters", "", "int32", "numbers that define the model"),
        _mesh("n_ignored", "", "int32", "samples ignored, not converged"),
        Variable("weighting", (), "text", "", "weights of the samples: relative or absolute"),
        Variable("variant", (), "text", "", "energy of a curvature tensor: tangent or paper"),
        _matrix("tangent", "N mm", f"{_BENDING}, nan if not known"),
        _matrix("in_plane", "N mm-1", f"{_IN_PLANE}, nan if not known"),
        _mesh("w_biaxial", "", "float64", "energy density 1/2 w det(k)^2", "N mm3"),
        _mesh("softening", "", "float64", "s: energy E before contact is log(1 + s E)/s", "mm N-1"),
    ),
)

SCHEMAS: dict[str, Schema] = {
    item.kind: item
    for item in (
        CELL,
        SWEEP,
        TANGENT,
        SHAPE,
        FIT,
        SHEET,
        TURNED_SHEET,
        NATIVE_SHEET,
        RIG,
        NATIVE_RIG,
    )
}


def schema_of(kind: str) -> Schema:
    """Table of a kind; UnknownNameError with the closest names for an unknown one."""
    if kind not in SCHEMAS:
        raise UnknownNameError(f"There is no dataset kind {kind!r}. {suggest(kind, SCHEMAS)}")
    return SCHEMAS[kind]
