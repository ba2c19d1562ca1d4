"""Meshes and states as .vtu files, for ParaView and its kin."""

from __future__ import annotations

import base64
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexscale.errors import MeshError
from flexscale.mesh.periodic_mesh import PeriodicMesh

_CELL_TYPES = {
    "triangle": (3, 5),
    "tetra": (4, 10),
    "quadratic_tetra": (10, 24),
}  # corners, VTK's number
_VTK_NAMES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}


def write_vtu(
    path: str | os.PathLike[str],
    points: ArrayLike,
    cells: Mapping[str, ArrayLike],
    point_data: Mapping[str, ArrayLike] | None = None,
    cell_data: Mapping[str, ArrayLike] | None = None,
) -> None:
    """Write an unstructured grid of triangles and tets.

    Parameters
    ----------
    path : file to write; it appears complete or not at all.
    points : (n_points, 2 or 3) mm; z = 0 is added to the plane.
    cells : "triangle" -> (n, 3), "tetra" -> (m, 4), "quadratic_tetra" -> (m, 10) points, in the
        order of `cell_data`.
    point_data, cell_data : name -> (n_points, …) and (n_cells, …) values.

    Raises
    ------
    MeshError : an array does not have one row per point or per cell.
    """
    positions = np.asarray(points, dtype=float)
    if positions.shape[1] == 2:
        positions = np.column_stack([positions, np.zeros(len(positions))])
    blocks = [(np.asarray(cells[name], dtype=np.int64), *_CELL_TYPES[name]) for name in cells]
    n_corners = np.concatenate([np.full(len(block), corners) for block, corners, _ in blocks])
    kinds = np.concatenate([np.full(len(block), kind) for block, _, kind in blocks])
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt64">',
        f'<UnstructuredGrid><Piece NumberOfPoints="{len(positions)}" NumberOfCells="{len(kinds)}">',
        "<Points>",
        _data_array("points", positions),
        "</Points><Cells>",
        _data_array("connectivity", np.concatenate([block.ravel() for block, _, _ in blocks])),
        _data_array("offsets", np.cumsum(n_corners)),
        _data_array("types", kinds.astype(np.uint8)),
        "</Cells>",
        *_data_section("PointData", point_data or {}, len(positions)),
        *_data_section("CellData", cell_data or {}, len(kinds)),
        "</Piece></UnstructuredGrid></VTKFile>",
    ]
    target = Path(path)
    partial = target.with_name(f".{target.name}.{os.getpid()}.partial")
    partial.write_text("\n".join(lines) + "\n", encoding="ascii")
    os.replace(partial, target)


def write_mesh(path: str | os.PathLike[str], mesh: PeriodicMesh) -> None:
    """Write a periodic mesh at rest: sheet triangles at z = 0 and scale tets.

    Cell data `scale`: scale that covers a triangle (-1 in the gap) or owns a tet. Point data
    `vertex_kind`: as in `PeriodicMesh`, -1 on the vertices of scales.
    """
    corners = np.column_stack([mesh.triangles.ravel(), mesh.triangle_offsets.reshape(-1, 2)])
    images, number = np.unique(corners, axis=0, return_inverse=True)
    flat = mesh.positions[images[:, 0]] + images[:, 1:] @ mesh.lattice
    sheet = np.column_stack([flat, np.zeros(len(flat))])
    solid = "quadratic_tetra" if mesh.tets.shape[1] == 10 else "tetra"
    write_vtu(
        path,
        np.concatenate([sheet, mesh.scale_positions]),
        {"triangle": number.reshape(-1, 3), solid: len(sheet) + mesh.tets},
        point_data={
            "vertex_kind": np.concatenate(
                [mesh.vertex_kind[images[:, 0]], np.full(mesh.n_scale_vertices, -1)]
            )
        },
        cell_data={"scale": np.concatenate([mesh.triangle_scale, mesh.tet_scale])},
    )


def _data_section(tag: str, data: Mapping[str, ArrayLike], n_rows: int) -> list[str]:
    arrays = {name: np.asarray(values) for name, values in data.items()}
    for name, values in arrays.items():
        if len(values) != n_rows:
            raise MeshError(
                f"{tag} {name!r} has {len(values)} rows, but the file needs {n_rows}: one per "
                f"{'point' if tag == 'PointData' else 'cell'}."
            )
    return [
        f"<{tag}>",
        *(_data_array(name, values) for name, values in arrays.items()),
        f"</{tag}>",
    ]


def _data_array(name: str, values: NDArray) -> str:
    """One array, inline in base64 behind its length in bytes."""
    kind = "u1" if values.dtype == np.uint8 else "f8" if values.dtype.kind == "f" else "i8"
    content = np.ascontiguousarray(values, dtype=f"<{kind}")
    components = "" if values.ndim == 1 else f' NumberOfComponents="{content[0].size}"'
    header = np.array([content.nbytes], dtype="<u8").tobytes()
    text = base64.b64encode(header + content.tobytes()).decode("ascii")
    return (
        f'<DataArray type="{_VTK_NAMES[kind]}" Name="{name}"{components} format="binary">'
        f"{text}</DataArray>"
    )
