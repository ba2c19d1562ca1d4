"""Kind `shape`: the deformed cell at chosen samples of a sweep."""

from __future__ import annotations

from flexscale.datasets.mesh_variables import array, check_mesh
from flexscale.datasets.variables import Schema, Variable

SHAPE = Schema(
    "shape",
    1,
    "Deformed cell at chosen samples of a sweep",
    coordinates=(
        array("sample_direction", "sample", "float64", "bending direction", "degree"),
        array("sample_curvature", "sample", "float64", "signed curvature, closing > 0", "mm-1"),
    ),
    variables=(
        array("lattice", "lattice_vector plane", "float64", "lattice vectors t1, t2", "mm"),
        array("stretch", "sample component", "float64", "stretch F of the lattice: xx, yy, xy"),
        array("points", "point space", "float64", "rest positions, scales and substrate", "mm"),
        array("displacement", "sample point space", "float64", "displacement", "mm"),
        Variable(
            "contact_force",
            ("sample", "point"),
            "float64",
            "N",
            "length of the force by which other scales press on a point",
            optional=True,
        ),
        array("triangles", "triangle corner", "int32", "substrate triangles into points"),
        array("triangle_scale", "triangle", "int32", "covering scale, -1 in the gap"),
        array("tets", "tet tet_corner", "int32", "scale tetrahedra into points"),
        array("tet_scale", "tet", "int32", "scale of the tetrahedron"),
        array("surface_triangles", "surface_triangle corner", "int32", "scale surfaces, outward"),
        array("surface_scale", "surface_triangle", "int32", "scale of the surface triangle"),
    ),
    check=check_mesh({"triangles": "point", "tets": "point", "surface_triangles": "point"}),
)
