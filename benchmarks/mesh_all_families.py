"""Cells of all 93 families, meshed: how many, how fast, how good the elements are.

    python benchmarks/mesh_all_families.py [--output FILE]

Default members, and of families with parameters five random valid ones each (uniform in ±0.3), at a
gap of 0.4 mm and a tile area of 100 mm². Every mesh is checked as the tests check theirs: a torus
that conforms across all edges, scales of the right volume with closed surfaces. Quality is 1 for
equilateral elements, 0 for flat ones.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.errors import PatternError, TilingError
from flexscale.mesh.quality import tet_qualities, triangle_qualities
from flexscale.mesh.torus import build_mesh

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.mesh.mesh_checks import assert_sound

N_RANDOM, SIZE = 5, 0.3


def members(family) -> list[fs.Tiling]:
    """Random valid members of a family."""
    rng = np.random.default_rng(int(family.name[2:]))
    found: list[fs.Tiling] = []
    while family.n_parameters and len(found) < N_RANDOM:
        try:
            found.append(fs.Tiling(family.name, rng.uniform(-SIZE, SIZE, family.n_parameters)))
        except TilingError:
            continue
    return found


def measure(tilings: list[fs.Tiling], failures: list[str]) -> tuple[int, int, list[list[float]]]:
    """Meshed, without a scale, and (s, worst triangle, worst tet, scales) of each mesh."""
    numbers, without = [], 0
    for tiling in tilings:
        start = time.perf_counter()
        try:
            pattern = fs.Pattern(tiling)
        except PatternError:
            without += 1
            continue
        mesh = build_mesh(pattern, fs.MeshOptions())
        seconds = time.perf_counter() - start
        try:
            assert_sound(mesh, pattern)
        except AssertionError as error:
            failures.append(f"{tiling!r}: {error}")
        in_gap = mesh.triangle_scale < 0
        corners = mesh.corner_positions()[in_gap]
        flat = triangle_qualities(
            corners.reshape(-1, 2), np.arange(corners.size // 2).reshape(-1, 3)
        )
        solid = tet_qualities(mesh.scale_positions, mesh.tets[:, :4])
        numbers.append([seconds, float(flat.min()), float(solid.min()), mesh.n_scales])
    return len(numbers), without, numbers


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    rows = [
        "| family | meshed | tile too thin for the gap | scales of the cell | s, largest "
        "| worst triangle of the sheet | worst tet |",
        "|---|---|---|---|---|---|---|",
    ]
    failures: list[str] = []
    every: list[list[float]] = []
    refused = 0
    for family in fs.families():
        meshed, without, numbers = measure([fs.Tiling(family.name), *members(family)], failures)
        every += numbers
        refused += without
        table = np.array(numbers)
        scales = "–".join(f"{n:g}" for n in sorted({table[:, 3].min(), table[:, 3].max()}))
        rows.append(
            f"| {family.name} | {meshed} | {without or ''} | {scales} | {table[:, 0].max():.2f} "
            f"| {table[:, 1].min():.3f} | {table[:, 2].min():.4f} |"
        )
    table = np.array(every)
    rows += ["", f"{len(every)} cells meshed, {refused} tiles too thin for the gap, "]
    rows[-1] += f"{len(failures)} meshes unsound; seconds per cell: median "
    rows[-1] += f"{np.median(table[:, 0]):.3f}, largest {table[:, 0].max():.2f}."
    report([*rows, *failures], output)


if __name__ == "__main__":
    main()
