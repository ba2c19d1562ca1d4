"""The substrate by name: its unknowns in a cell, and its energies."""

from __future__ import annotations

from flexscale.embedding.c1_cell import C1Cell
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.edge_angle_cell import EdgeAngleCell
from flexscale.mechanics.constant_strain import ConstantStrainTriangles
from flexscale.mechanics.edge_angles import EdgeAngleBending
from flexscale.mechanics.energy import Energy
from flexscale.mechanics.shell import HctShell
from flexscale.mechanics.substrate_options import DEFAULT_MEASURE, SubstrateOptions
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.patterns import NeoHookean


def build_embedding(
    mesh: PeriodicMesh,
    options: SubstrateOptions,
    bond_radius: float,
    contact_edge: float | None,
    tets: bool,
) -> CellEmbedding:
    """Unknowns of a cell; lengths in mm; without contact where its edge is None."""
    if options.element == "c1":
        return C1Cell(mesh, bond_radius, contact_edge, tets)
    return EdgeAngleCell(mesh, bond_radius, contact_edge, tets)


def build_substrate(
    embedding: CellEmbedding,
    options: SubstrateOptions,
    material: NeoHookean,
    thickness: float,
    bending_stiffness: float,
) -> list[Energy]:
    """Energies of the substrate, membrane before bending; thickness in mm, stiffness in N mm."""
    if isinstance(embedding, C1Cell):
        shell = HctShell(
            embedding.shell.corners,
            embedding.shell.edge_normals,
            embedding.shell.vectors,
            shear_modulus=material.shear_modulus,
            lame_lambda=material.lame_lambda,
            poisson_ratio=material.poisson_ratio,
            thickness=thickness,
            bending_stiffness=bending_stiffness,
            bending_measure=options.bending_measure or DEFAULT_MEASURE,
        )
        return [shell]
    assert isinstance(embedding, EdgeAngleCell)
    membrane = ConstantStrainTriangles(
        embedding.stencils.corners[: embedding.n_gap],
        embedding.stencils.vectors[: embedding.n_gap, :3],
        shear_modulus=material.shear_modulus,
        lame_lambda=material.lame_lambda,
        thickness=thickness,
    )
    bending = EdgeAngleBending(
        embedding.stencils,
        bending_stiffness=bending_stiffness,
        poisson_ratio=material.poisson_ratio,
    )
    return [membrane, bending]
