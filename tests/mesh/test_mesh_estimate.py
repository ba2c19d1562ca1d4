"""Numbers of elements told before a mesh is made."""

from __future__ import annotations

import pytest

import flexscale as fs
from flexscale.errors import MeshError
from flexscale.mesh import build_mesh
from flexscale.mesh.estimate import estimate_elements
from flexscale.mesh.sheet import disc, rectangle

COARSE = fs.MeshOptions(scale_layers=2, scale_size=6, scale_strips=1, across=2)
CASES = {
    "default": ("square", fs.MeshOptions()),
    "coarse": ("hexagon", COARSE),
    "sharp tiles": ("arrowhead", COARSE),
    "fine scales": ("square", fs.MeshOptions(scale_size=0.5, scale_layers=2)),
    "fine gaps": ("square", fs.MeshOptions(along=0.05, corner=0.05, scale_layers=2)),
}


@pytest.mark.parametrize("case", CASES)
def test_estimates_tell_the_order_of_magnitude(case: str) -> None:
    """A factor of 4: what is refused beyond a million is not a mesh of a thousand elements."""
    name, options = CASES[case]
    pattern = fs.named_pattern(name)
    expected, mesh = estimate_elements(pattern, options), build_mesh(pattern, options)
    assert 0.25 < expected.triangles / mesh.n_triangles < 4.0
    assert 0.25 < expected.tets / len(mesh.tets) < 4.0


def test_meshes_of_too_many_elements_are_refused_at_once() -> None:
    pattern = fs.named_pattern("square")
    with pytest.raises(MeshError, match=r"about [\d.e+]+ tets, more than .*now 0\.0018 mm"):
        fs.tangent_stiffness(
            pattern, model=fs.NativeModel("shell", mesh=fs.MeshOptions(scale_size=0.0018))
        )
    with pytest.raises(MeshError, match=r"triangles, more than .*now 0\.001 mm"):
        build_mesh(pattern, fs.MeshOptions(along=0.001, corner=0.001))


def test_macro_sheets_of_too_many_triangles_are_refused_at_once() -> None:
    with pytest.raises(MeshError, match="give a larger element size"):
        rectangle(1000.0, 1000.0, 0.01)
    with pytest.raises(MeshError, match="give a larger element size"):
        disc(100.0, 1000)
