"""Meshes of one lattice cell as a torus."""

from flexscale.mesh.bare import build_bare_mesh
from flexscale.mesh.bonds import Bonds, build_bonds
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.mesh.torus import build_mesh
from flexscale.mesh.vtu import write_mesh, write_vtu

__all__ = [
    "Bonds",
    "MeshOptions",
    "PeriodicMesh",
    "build_bare_mesh",
    "build_bonds",
    "build_mesh",
    "write_mesh",
    "write_vtu",
]
