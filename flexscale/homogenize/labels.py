"""What every dataset of a pattern is labelled with."""

from __future__ import annotations

from flexscale.mesh.options import MeshOptions
from flexscale.patterns import Pattern


def pattern_scalars(pattern: Pattern, mesh: MeshOptions) -> dict[str, float | str]:
    """Scalar coordinates of a pattern's datasets, in the units of `datasets.variables.SCALARS`."""
    return {
        "family": pattern.family,
        "pattern": pattern.name,
        "gap": pattern.gap,
        "tile_area": pattern.tile_area,
        "scale_height": pattern.scale_height,
        "substrate_thickness": pattern.substrate_thickness,
        "scale_young_modulus": pattern.scale_material.young_modulus,
        "scale_poisson_ratio": pattern.scale_material.poisson_ratio,
        "substrate_young_modulus": pattern.substrate_material.young_modulus,
        "substrate_poisson_ratio": pattern.substrate_material.poisson_ratio,
        "mesh_size": pattern.gap / mesh.across,
    }
