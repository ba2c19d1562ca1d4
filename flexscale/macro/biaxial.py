"""Resistance of a sheet to double curvature [Eq. 13]: the paper's w_biaxial, and its default."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.units import require_range

MOST_W_BIAXIAL = 1e12  # N mm3: a million times that of tiles of 10 cm2 on the stiffest sheets


def choose_w_biaxial(
    given: float | None, in_plane: FloatArray | None, tile_area: float | str | None
) -> float:
    """What was given, or the default; 0 where nothing is known of the cell.

    Raises
    ------
    UnitRangeError : a negative or infinite one was given.
    """
    if given is not None:
        return require_range(given, "w_biaxial", "N mm3", 0.0, MOST_W_BIAXIAL)
    if in_plane is None or tile_area is None:
        return 0.0
    return default_w_biaxial(in_plane, float(tile_area))


def default_w_biaxial(in_plane: FloatArray, tile_area: float) -> float:
    """Resistance of a tile to double curvature [N mm3], Y S² / (192 π²) [Eq. 13].

    A macro sheet stretches by its own shape where it is bent doubly, but not within a tile, whose
    scale is flat: a patch of a tile's area S with Gaussian curvature K and free edges must stretch.
    For a round one of radius R, the Föppl-von Kármán equation Δ²φ = −Y K gives the stresses
    Y K (R² − r²)/16 and Y K (R² − 3 r²)/16, and a mean energy of Y K² R⁴/384 = ½ w K²; R⁴ = S²/π².

    Parameters
    ----------
    in_plane : (3, 3) N mm-1; Y is its stiffness in uniaxial tension, averaged over all directions.
    tile_area : mm2.
    """
    # 1/Y(θ) = n n : A⁻¹ : n n; its mean over θ has the invariants of A⁻¹ only.
    soft = np.linalg.inv(in_plane)
    mean = (3.0 * (soft[0, 0] + soft[1, 1]) + 2.0 * soft[0, 1] + soft[2, 2]) / 8.0
    return float(tile_area**2 / (192.0 * np.pi**2 * mean))
