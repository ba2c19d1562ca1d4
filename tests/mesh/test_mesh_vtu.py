"""The .vtu writer, read back by XML and base64 alone."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from flexscale.errors import MeshError
from flexscale.mesh import build_mesh, write_mesh, write_vtu
from flexscale.mesh.options import MeshOptions
from tests.patterns.pattern_shapes import SHAPES

DTYPES = {"Float64": "<f8", "Int64": "<i8", "UInt8": "<u1"}


def read(path: Path) -> dict[str, np.ndarray]:
    arrays = {}
    for element in ElementTree.parse(path).getroot().iter("DataArray"):
        content = base64.b64decode(element.text or "")
        size = int(np.frombuffer(content[:8], "<u8")[0])
        assert size == len(content) - 8
        values = np.frombuffer(content[8:], DTYPES[element.get("type", "")])
        arrays[element.get("name") or element.get("Name", "")] = values
    return arrays


@pytest.mark.parametrize(("order", "corners", "kind"), [(1, 4, 10), (2, 10, 24)])
def test_mesh_comes_back(tmp_path: Path, order: int, corners: int, kind: int) -> None:
    mesh = build_mesh(SHAPES["herringbone"][0], MeshOptions(scale_order=order))
    write_mesh(tmp_path / "cell.vtu", mesh)
    assert [file.name for file in tmp_path.iterdir()] == ["cell.vtu"]
    arrays = read(tmp_path / "cell.vtu")
    points = arrays["points"].reshape(-1, 3)
    n_sheet = 3 * mesh.n_triangles
    triangles = arrays["connectivity"][:n_sheet].reshape(-1, 3)
    tets = arrays["connectivity"][n_sheet:].reshape(-1, corners)
    assert np.allclose(points[triangles][..., :2], mesh.corner_positions())
    assert np.allclose(points[tets], mesh.scale_positions[mesh.tets])
    assert arrays["offsets"].tolist() == [
        *range(3, n_sheet + 1, 3),
        *range(n_sheet + corners, n_sheet + corners * len(mesh.tets) + 1, corners),
    ]
    assert arrays["types"].tolist() == [5] * mesh.n_triangles + [kind] * len(mesh.tets)
    assert np.array_equal(arrays["scale"], np.concatenate([mesh.triangle_scale, mesh.tet_scale]))


def test_vectors_and_plane_points(tmp_path: Path) -> None:
    points = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    displacement = np.arange(9.0).reshape(3, 3)
    write_vtu(tmp_path / "t.vtu", points, {"triangle": [[0, 1, 2]]}, {"displacement": displacement})
    arrays = read(tmp_path / "t.vtu")
    assert arrays["points"].reshape(3, 3)[:, 2].tolist() == [0.0, 0.0, 0.0]
    assert np.array_equal(arrays["displacement"].reshape(3, 3), displacement)
    assert 'NumberOfComponents="3"' in (tmp_path / "t.vtu").read_text()


def test_wrong_number_of_values_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match="'stress' has 2 rows, but the file needs 1"):
        write_vtu(tmp_path / "t.vtu", np.eye(3), {"triangle": [[0, 1, 2]]}, {}, {"stress": [1, 2]})
    assert not list(tmp_path.iterdir())
