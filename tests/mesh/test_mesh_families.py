"""Cells of all families mesh: tori that conform across all edges, with sound scales."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import PatternError, TilingError
from flexscale.mesh.torus import build_mesh
from tests.mesh.mesh_checks import assert_sound
from tests.sampling import every

FAMILIES = [family.name for family in fs.families()]
MESHES = pytest.mark.parametrize(
    "mesh",
    [
        pytest.param(fs.MeshOptions().finer(0.5), id="coarse"),
        pytest.param(fs.MeshOptions(), marks=pytest.mark.slow, id="default"),
    ],
)


@MESHES
@pytest.mark.parametrize("name", every(3, FAMILIES))
def test_default_cells_are_sound(name: str, mesh: fs.MeshOptions) -> None:
    pattern = fs.Pattern(fs.Tiling(name))
    assert_sound(build_mesh(pattern, mesh), pattern)


@MESHES
@pytest.mark.parametrize("name", [entry.name for entry in fs.named_patterns()])
def test_named_cells_are_sound(name: str, mesh: fs.MeshOptions) -> None:
    pattern = fs.named_pattern(name)
    assert_sound(build_mesh(pattern, mesh), pattern)


@MESHES
@pytest.mark.parametrize("name", every(3, FAMILIES[::4]))
def test_random_members_are_sound(name: str, mesh: fs.MeshOptions) -> None:
    n = next(family.n_parameters for family in fs.families() if family.name == name)
    parameters = np.random.default_rng(int(name[2:])).uniform(-0.3, 0.3, n)
    try:
        tiling = fs.Tiling(name, parameters)
    except TilingError:
        pytest.skip("no tile")
    pattern = fs.Pattern(tiling)
    assert_sound(build_mesh(pattern, mesh), pattern)


def test_a_tile_too_thin_for_the_gap_is_refused_in_one_sentence() -> None:
    thin = fs.Tiling("IH74", [0.6])
    with pytest.raises(PatternError, match="gap"):
        fs.Pattern(thin, gap=6.0)
