"""What a finite sheet of scales can be made of: fewer choices than a periodic cell has."""

from __future__ import annotations

from flexscale.errors import ConfigError
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions


def require_finite_options(substrate: SubstrateOptions, scales: ScaleOptions) -> None:
    """Refuse what a finite sheet does not compute, before anything is meshed.

    Raises
    ------
    ConfigError : scales or a substrate that only a periodic cell has.
    """
    if scales.model != "modes":
        raise ConfigError(
            f"A native sheet or stage has scales of few modes, not {scales.model!r}: leave the "
            "model of the scales at 'modes'."
        )
    if substrate.element != "c1":
        raise ConfigError(
            f"A native sheet or stage has a substrate of smooth triangles, not "
            f"{substrate.element!r}: leave the element of the substrate at 'c1'."
        )
