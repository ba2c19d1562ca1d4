"""The substrate by name: its unknowns in a cell, and its energies."""

from __future__ import annotations

from flexscale.embedding.c1_cell import C1Cell
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.edge_angle_cell import EdgeAngleCell
from flexscale.embedding.solid_cell import SolidCell
from flexscale.homogenize.cell_model import CellModel
from flexscale.mechanics.constant_strain import ConstantStrainTriangles
from flexscale.mechanics.edge_angles import EdgeAngleBending
from flexscale.mechanics.energy import Energy
from flexscale.mechanics.neo_hookean_wedges import NeoHookeanWedges
from flexscale.mechanics.shell import HctShell
from flexscale.mechanics.substrate_options import DEFAULT_MEASURE
from flexscale.mesh.layers import build_layers, layer_levels
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.system_failures import require_memory

#: GB of a cell of n unknowns and rigid scales: a + b n^c, from 3e4 to 2e5 of them.
_MEMORY = (0.35, 3.7e-7, 1.33)
_ELASTIC = 1.6  # times as much with scales of several hundred modes


def _require_memory(n_unknowns: int, model: CellModel) -> None:
    """Refuse a solid that the memory does not suffice for, before it is built."""
    a, b, c = _MEMORY
    needed = a + b * n_unknowns**c
    needed *= 1.0 if model.scales.model == "rigid" else _ELASTIC
    assert model.solid is not None
    require_memory(
        needed,
        f"The cell of a solid substrate with {n_unknowns:.2g} unknowns",
        f"give a larger solid option `edge` (now {model.solid.edge:g} mm) or `growth` (now "
        f"{model.solid.growth:g}), or larger mesh options `along` and `corner`",
    )


def build_embedding(
    mesh: PeriodicMesh, model: CellModel, contact_edge: float | None, tets: bool
) -> CellEmbedding:
    """Unknowns of a cell; lengths in mm; without contact where its edge is None."""
    if model.solid is not None:
        thickness, solid = model.substrate_thickness, model.solid
        heights = layer_levels(thickness, solid.n_rows(thickness), solid.growth)
        layers = build_layers(mesh, heights)
        _require_memory(layers.n_unknowns, model)
        return SolidCell(mesh, layers, contact_edge, tets)
    if model.substrate.element == "c1":
        return C1Cell(mesh, model.bond_radius, contact_edge, tets)
    return EdgeAngleCell(mesh, model.bond_radius, contact_edge, tets)


def build_substrate(embedding: CellEmbedding, model: CellModel) -> list[Energy]:
    """Energies of the substrate; of a shell, membrane before bending."""
    material, thickness = model.substrate_material, model.substrate_thickness
    bending_stiffness = model.plate_stiffness
    if isinstance(embedding, SolidCell):
        wedges = embedding.wedges
        solid = NeoHookeanWedges(
            wedges.corners,
            wedges.upper,
            wedges.lower,
            wedges.vectors,
            material.shear_modulus,
            material.lame_lambda,
        )
        return [solid]
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
            bending_measure=model.substrate.bending_measure or DEFAULT_MEASURE,
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
