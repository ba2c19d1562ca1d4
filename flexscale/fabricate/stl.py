"""Solids as binary STL files."""

from __future__ import annotations

import numpy as np

from flexscale.fabricate.solids import Solid

_FACET = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")], align=False
)


def stl_bytes(solid: Solid, title: str) -> bytes:
    """Contents of a binary STL file.

    Parameters
    ----------
    title : for the header, of which 80 bytes are kept. It must not begin with "solid", which
        programs take for the text format.
    """
    corners = solid.vertices[solid.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets = np.zeros(len(corners), dtype=_FACET)
    facets["normal"] = normals / np.where(lengths > 0.0, lengths, 1.0)
    facets["corners"] = corners
    header = title.encode("ascii", "replace")[:80].ljust(80)
    return header + np.uint32(len(facets)).tobytes() + facets.tobytes()
