"""Points of a deformed sheet: where a place (u, v) of the sheet at rest has gone.

On C1 triangles it lies on the element's own cubic surface, on linear triangles in the flat triangle
between the deformed corners, as barycentric coordinates say.
"""

from __future__ import annotations

import numpy as np
import shapely

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import BadInputError
from flexscale.mechanics.hct import hct_ordinates
from flexscale.mechanics.sheet_shell import SheetShell
from flexscale.mesh.sheet import SheetMesh
from flexscale.sheets.sheet import Sheet
from flexscale.sheets.sheet_rows import smooth_rows

_OUTSIDE = 1e-3  # of a triangle's height: how far beyond the border points may lie


def locate(mesh: SheetMesh, points: FloatArray) -> tuple[IntArray, FloatArray]:
    """Triangles (n,) that hold points (n, 2), and barycentric coordinates (n, 3) in them.

    Raises
    ------
    BadInputError : a point lies outside the sheet.
    """
    tree = shapely.STRtree(shapely.polygons(mesh.points[mesh.triangles]))
    asked, found = tree.query_nearest(shapely.points(points), all_matches=False)
    triangles = np.empty(len(points), dtype=np.int64)
    triangles[asked] = found
    corners = mesh.points[mesh.triangles[triangles]]
    spans = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
    shares = np.linalg.solve(spans, (points - corners[:, 0])[:, :, None])[:, :, 0]
    weights = np.column_stack([1.0 - shares.sum(axis=1), shares])
    if len(weights) and weights.min() < -_OUTSIDE:
        x, y = points[int(weights.min(axis=1).argmin())]
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        raise BadInputError(
            f"The point ({x:.4g}, {y:.4g}) mm lies outside the sheet, which reaches from "
            f"({low[0]:.4g}, {low[1]:.4g}) to ({high[0]:.4g}, {high[1]:.4g}) mm: stay inside."
        )
    return triangles, weights


def sheet_positions(sheet: Sheet, rows: FloatArray, points: FloatArray) -> FloatArray:
    """Where points of a deformed sheet are.

    Parameters
    ----------
    sheet : the sheet.
    rows : (n_rows, 3) its deformed state.
    points : (n, 2) places in the sheet at rest, mm.

    Returns
    -------
    (n, 3) mm.

    Raises
    ------
    BadInputError : a point lies outside the sheet.
    """
    triangles, weights = locate(sheet.mesh, points)
    if not isinstance(sheet.energy, SheetShell):
        at_vertices = rows[sheet.rows.positions(np.ones(sheet.mesh.n_vertices, dtype=bool))]
        return np.einsum("nk,nkc->nc", weights, at_vertices[sheet.mesh.triangles[triangles]])
    used, inverse = np.unique(triangles, return_inverse=True)
    smooth = smooth_rows(sheet.mesh)
    vectors = rows[smooth.vectors[used]].copy()
    # Derivatives along u and v from those along each vertex's own two directions.
    for k in range(3):
        at = slice(3 * k + 1, 3 * k + 3)
        inverse_frames = np.linalg.inv(smooth.vertex_frames[used, k])
        vectors[:, at] = np.einsum("nde,nec->ndc", inverse_frames, vectors[:, at])
    ordinates = hct_ordinates(
        sheet.mesh.points[sheet.mesh.triangles[used]], smooth.edge_normals[used]
    )
    controls = np.einsum("nkabcd,ndx->nkabcx", ordinates, vectors)
    return _cubic_values(controls[inverse], weights)


def _cubic_values(controls: FloatArray, weights: FloatArray) -> FloatArray:
    """(n, 3) values at barycentric places (n, 3) of cubics with ordinates (n, 3, 4, 4, 4, 3)."""
    n = np.arange(len(weights))
    apex = weights.argmin(axis=1)  # the sub-triangle lies across from this corner
    part = (apex + 1) % 3
    third = weights[n, apex]
    inner = np.stack(
        [weights[n, part] - third, weights[n, (part + 1) % 3] - third, 3.0 * third], axis=1
    )
    out = np.zeros((len(weights), 3))
    for a in range(4):
        for b in range(4 - a):
            c = 3 - a - b
            choices = 6.0 / (_FACTORIAL[a] * _FACTORIAL[b] * _FACTORIAL[c])
            basis = choices * inner[:, 0] ** a * inner[:, 1] ** b * inner[:, 2] ** c
            out += basis[:, None] * controls[n, part, a, b, c]
    return out


_FACTORIAL = (1.0, 1.0, 2.0, 6.0)
