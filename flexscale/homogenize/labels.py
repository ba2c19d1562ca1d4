"""What every dataset of a pattern is labelled with."""

from __future__ import annotations

from flexscale.homogenize.native_model import NativeModel
from flexscale.patterns import Pattern


def pattern_scalars(pattern: Pattern, native: NativeModel) -> dict[str, float | str]:
    """Scalar coordinates of a pattern's datasets, in the units of `datasets.variables.SCALARS`."""
    meshed: dict[str, float | str] = (
        {} if native.name == "joints" else {"mesh_size": pattern.gap / native.mesh.across}
    )
    return meshed | {
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
    }
