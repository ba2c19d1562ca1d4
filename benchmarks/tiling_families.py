"""All 93 families: do their members cover the plane, and how symmetric are they as drawn?

    python benchmarks/tiling_families.py [--output FILE]

Of every family the tile with parameters 0 and twenty random valid ones (uniform in ±0.4, straight
edges). Hole: the cell's area less the tiles', overlap: of any tile with any other in the plane;
both as shares of a tile. "Drawn" is the group of the default tiles, without markings or curves.
"""

from __future__ import annotations

import time

import numpy as np
import shapely
from report import output_file, report

import flexscale as fs
from flexscale.errors import TilingError

N_RANDOM, SIZE = 20, 0.4
SPAN = range(-3, 4)


def cover_errors(tiling: fs.Tiling) -> tuple[float, float]:
    """Hole and largest pairwise overlap, as shares of a tile's area."""
    home = [shapely.Polygon(tile) for tile in tiling.tiles]
    hole = abs(np.linalg.det(tiling.lattice) - sum(tile.area for tile in home)) / home[0].area
    shifts = np.array([(m, n) for m in SPAN for n in SPAN]) @ tiling.lattice
    images = [shapely.Polygon(t + shift) for t in tiling.tiles for shift in shifts]
    tree = shapely.STRtree(images)
    worst = 0.0
    for tile in home:
        near = [images[k] for k in tree.query(tile, predicate="intersects")]
        # Snap rounding: plain overlays of tiles that touch along edges may return the whole tile.
        overlaps = shapely.area(shapely.intersection(tile, near, grid_size=1e-12)).tolist()
        overlaps.remove(max(overlaps))  # with itself
        worst = max(worst, *overlaps, 0.0)
    return float(hole), worst / home[0].area


def random_members(name: str, n_parameters: int) -> tuple[list[fs.Tiling], int]:
    """Valid random members, and how many were tried."""
    rng = np.random.default_rng(int(name[2:]))
    found: list[fs.Tiling] = []
    tried = 0
    while n_parameters and len(found) < N_RANDOM:
        tried += 1
        try:
            found.append(fs.Tiling(name, rng.uniform(-SIZE, SIZE, n_parameters)))
        except TilingError:
            continue
    return found, tried


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    rows = ["| family | group | drawn | parameters | valid of tried | hole | overlap | ms |"]
    rows.append("|---|---|---|---|---|---|---|---|")
    worst, own_group = np.zeros(2), 0
    for family in fs.families():
        start = time.perf_counter()
        default = fs.Tiling(family.name)
        seconds = time.perf_counter() - start
        members, tried = random_members(family.name, family.n_parameters)
        errors = np.max([cover_errors(tiling) for tiling in [default, *members]], axis=0)
        drawn = default.symmetry().group
        own_group += drawn == family.group and not family.needs_marking
        worst = np.maximum(worst, errors)
        share = f"{len(members)} of {tried}" if tried else ""
        rows.append(
            f"| {family.name} | {family.group} | {drawn} | {family.n_parameters} | {share} "
            f"| {errors[0]:.0e} | {errors[1]:.0e} | {1e3 * seconds:.1f} |"
        )
    rows += ["", f"Largest hole {worst[0]:.1e}, largest overlap {worst[1]:.1e} of a tile; "]
    rows[-1] += f"{own_group} of the 81 unmarked types show just their own group by default."
    report(rows, output)


if __name__ == "__main__":
    main()
