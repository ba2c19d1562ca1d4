"""Checks of printed surfaces as another program reads them: from the bytes of an STL file alone."""

from __future__ import annotations

import ipctk
import manifold3d as m3
import numpy as np
import shapely

from flexscale.fabricate.walls import areas_of

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3), equal ones merged, and faces (m, 3) of a binary STL file."""
    facets = np.frombuffer(data[84:], dtype=_FACET)
    assert len(facets) == np.frombuffer(data[80:84], "<u4")[0]
    vertices, index = np.unique(facets["corners"].reshape(-1, 3), axis=0, return_inverse=True)
    return vertices.astype(float), index.reshape(-1, 3)


def n_open_edges(faces: np.ndarray) -> int:
    """Directed edges used twice, or not met by one in the other direction."""
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    n = int(faces.max()) + 1
    keys, counts = np.unique(edges[:, 0] * n + edges[:, 1], return_counts=True)
    back = (keys % n) * n + keys // n
    return int(np.count_nonzero(counts > 1) + np.count_nonzero(~np.isin(back, keys)))


def volume_of(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Signed volume, mm³."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def crosses_itself(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Whether an edge of the surface passes through one of its triangles."""
    mesh = ipctk.CollisionMesh(vertices, ipctk.edges(faces), faces)
    return bool(ipctk.has_intersections(mesh, vertices))


def level(vertices: np.ndarray, faces: np.ndarray, z: float) -> list[shapely.Polygon]:
    """Areas of the cut by a horizontal plane, mm."""
    solid = m3.Manifold(m3.Mesh64(vertices, faces.astype(np.uint64)))
    return list(shapely.get_parts(areas_of(solid.slice(z))))


def smallest_distance(areas: list[shapely.Polygon]) -> float:
    """Between any two of the areas, mm."""
    tree = shapely.STRtree(areas)
    near = tree.query_nearest(areas, exclusive=True, return_distance=True)[1]
    return float(near.min())
