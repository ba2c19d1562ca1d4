"""Kind `cell`: geometry and mesh of one periodic cell."""

from __future__ import annotations

from flexscale.datasets.mesh_variables import array, check_mesh
from flexscale.datasets.variables import Schema

#: Index arrays and the dimension they point into.
_INDICES = {
    "triangles": "vertex",
    "triangle_edges": "edge",
    "edges": "vertex",
    "tets": "scale_vertex",
    "base_triangles": "scale_vertex",
    "surface_triangles": "scale_vertex",
}

CELL = Schema(
    "cell",
    1,
    "Geometry and mesh of one periodic cell",
    coordinates=(),
    variables=(
        array("lattice", "lattice_vector plane", "float64", "lattice vectors t1, t2", "mm"),
        array("positions", "vertex plane", "float64", "rest positions of the substrate", "mm"),
        array("triangles", "triangle corner", "int32", "substrate triangles, ccw"),
        array("triangle_offsets", "triangle corner lattice_vector", "int32", "lattice offsets"),
        array("triangle_scale", "triangle", "int32", "covering scale, -1 in the gap"),
        array("vertex_scale", "vertex", "int32", "scale that carries the vertex, -1 free"),
        array("vertex_kind", "vertex", "int8", "0 free, 1 outline, 2 corner, 3 under a scale"),
        array("outline_tangent", "vertex plane", "float64", "unit tangent of the outline"),
        array("edges", "edge edge_end", "int32", "substrate edges"),
        array("edge_shift", "edge lattice_vector", "int32", "lattice offset of the second end"),
        array("triangle_edges", "triangle corner", "int32", "edge from corner i to i+1"),
        array(
            "triangle_edge_offsets",
            "triangle corner lattice_vector",
            "int32",
            "lattice offset of the edge's first end",
        ),
        array("edge_scale", "edge", "int32", "scale outline, -1 gap, -2 under a scale"),
        array("scale_positions", "scale_vertex space", "float64", "rest positions", "mm"),
        array("tets", "tet tet_corner", "int32", "tetrahedra of the scales"),
        array("tet_scale", "tet", "int32", "scale of the tetrahedron"),
        array("base_triangles", "base_triangle base_corner", "int32", "scale bases, ccw from +z"),
        array("base_scale", "base_triangle", "int32", "scale of the base triangle"),
        array("surface_triangles", "surface_triangle corner", "int32", "scale surfaces, outward"),
        array("surface_scale", "surface_triangle", "int32", "scale of the surface triangle"),
        array("n_scales", "", "int32", "number of scales in the cell"),
        array(
            "tile_points", "tile_point plane", "float64", "tile polygons, ccw", "mm", optional=True
        ),
        array("tile_of_point", "tile_point", "int32", "tile of the point", optional=True),
        array(
            "outline_points",
            "outline_point plane",
            "float64",
            "scale outlines, ccw",
            "mm",
            optional=True,
        ),
        array("outline_of_point", "outline_point", "int32", "scale of the point", optional=True),
    ),
    check=check_mesh(_INDICES),
)
