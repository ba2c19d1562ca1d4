"""Joints that end at a free border, by the solid: a row of scales with free sides, bent and pulled.

    python benchmarks/free_ends.py [--log FILE] [--output FILE]

The row, of rectangles 10 mm long, is periodic along x; its lattice is wider than its tiles, so that
nothing of one row hangs on the next. Its border runs half a gap from the scales, as that of a laid
sheet. The stiffness of a joint across is K = k (l + 2 e): k that of a joint per length, l the
length along which walls face one another, e what an end adds to it. Two widths tell k and e; with
them, the same row in the plane tells c, what an end at a crossing adds. Bending lets the row strain
as it likes, stretch holds it flat. Rigid scales, gap and sheet of 0.4 mm. A mesh is stiffer than
the limit by a share of the size of the elements at the bond's edge: limits are twice the finer
mesh's value less the coarser one's.

The log keeps one line of JSON for each solve, and solves that it has are not done again.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from report import heading, report, table

import flexscale as fs
from flexscale.arrays import FloatArray
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.mesh.solid_options import SolidOptions
from flexscale.mesh.tile import build_tile_mesh, find_tip_sizes
from flexscale.mesh.torus import join_tiles
from flexscale.patterns.joint_lines import joints_between
from flexscale.patterns.laid import rectangle

SIDE = 10.0  # mm, along x
WIDTHS = (5.0, 10.0)  # mm, of a row
GAP = 0.4  # mm
APART = 1.0  # mm, between strips
EDGES = (0.06, 0.03)  # mm, elements at the bond's edge
CORNER = 0.1  # mm, elements along the gap where joints end
ROOT = 2.0**0.5
TURN = 8  # unknown of the first scale: the height of its frame's second vector
LOG = Path("results/local/free_ends.jsonl")
#: Width of the row and size of the elements [mm], and whether sides are free.
Job = tuple[float, float, bool]
JOBS: list[Job] = [
    *((width, edge, True) for edge in EDGES for width in WIDTHS),
    *((WIDTHS[0], edge, False) for edge in EDGES),
]
NAMES = ("width", "edge", "free")
STIFFNESSES = {"bending": "N mm", "stretch": "N/mm"}


def row_pattern(width: float) -> fs.Pattern:
    """Rectangles in rows of a width [mm]."""
    return fs.Pattern.from_polygons([rectangle(SIDE, width)], (SIDE, 0.0), (0.0, width), gap=GAP)


def mesh_strip(pattern: fs.Pattern, native: fs.NativeModel, apart: float) -> PeriodicMesh:
    """The mesh of a pattern's cell, glued along x, and along y if `apart` is 0."""
    options = native.solid.in_plane(native.mesh, pattern.gap)
    under = native.solid.under_scales(options, pattern.substrate_thickness)
    tips = find_tip_sizes(pattern.prototiles, pattern.gap, options, True)
    meshes = [
        build_tile_mesh(shape, pattern.gap, pattern.scale_height, options, tips, under)
        for shape in pattern.prototiles
    ]
    placed = [(meshes[copy.prototile], copy.placement) for copy in pattern.copies]
    lattice = pattern.lattice + np.array([[0.0, 0.0], [0.0, apart]])
    return join_tiles(placed, lattice, pattern.scale_height)


class _Pinned:
    """A linear system whose matrix is stiffer at some unknowns.

    Where rigid motions cost nothing, one unknown for each of them holds them, and answers to loads
    that no rigid motion feels stay what they are.
    """

    def __init__(self, system: Any, places: list[int]) -> None:
        self.system, self.diagonal, self.places = system, system.diagonal, places

    def factorize(self, values: FloatArray) -> int:
        values = values.copy()
        values[self.diagonal[self.places]] += np.abs(values[self.diagonal]).mean()
        return int(self.system.factorize(values))

    def solve(self, right_hand_side: FloatArray) -> Any:
        return self.system.solve(right_hand_side)


def solve(width: float, edge: float, free: bool) -> dict[str, Any]:
    """One line of the log: stiffnesses of a joint across, of a strip or of a row of the plane.

    Bending lets the strip strain as it likes, stretch holds it flat.
    """
    start = time.process_time()
    native = fs.NativeModel(
        "solid",
        mesh=MeshOptions(along=1.6, corner=CORNER),
        scales=ScaleOptions("rigid"),
        solid=SolidOptions(edge, ROOT),
    ).without_contact
    pattern = row_pattern(width)
    mesh = mesh_strip(pattern, native, APART if free else 0.0)
    problem = CellProblem(mesh, CellModel.of_pattern(pattern, native))
    n = problem.embedding.n_unknowns
    if free:  # the strip turns about x, and strains across and in shear, at no cost
        places = np.searchsorted(problem.active, [TURN, n - 2, n - 1]).tolist()
        problem.system = _Pinned(problem.system, places)  # type: ignore[assignment]
    bends = problem.flat_bends()
    bending = bends.fixed[0, 0] + bends.loads[0] @ bends.relaxed[0]
    pull = np.zeros(len(problem.active))
    pull[-3] = 1.0  # of the strain along x
    compliance = problem.system.solve(pull)[0][-3]
    return {
        **dict(zip(NAMES, (width, edge, free), strict=True)),
        "bending": float(bending) / SIDE**2,
        "stretch": 1.0 / float(compliance) / SIDE**2,
        "n_unknowns": len(problem.active),
        "processor_seconds": round(time.process_time() - start, 1),
    }


def read(log: Path) -> dict[Job, dict[str, Any]]:
    """Lines of a log by their jobs."""
    lines = [json.loads(text) for text in log.read_text().splitlines()] if log.exists() else []
    return {tuple(line[name] for name in NAMES): line for line in lines}


def length_by_rule(width: float) -> float:
    """mm, of the joint between two scales of one row, as whole sheets have it."""
    tile = rectangle(SIDE, width)
    (joint,) = joints_between([tile, tile + np.array([SIDE, 0.0])], GAP, np.arange(2))
    return float(joint.weights.sum())


def solve_table(done: dict[Job, dict[str, Any]]) -> list[str]:
    """What was solved."""
    rows = []
    for job in JOBS:
        line = done[job]
        values = [f"{line[name]:.5f}" for name in STIFFNESSES]
        shown = [f"{line[name]:g}" for name in NAMES[:2]]
        sides = "free" if line["free"] else "periodic"
        cost = [str(line["n_unknowns"]), f"{line['processor_seconds']:.0f}"]
        rows.append([*shown, sides, *values, *cost])
    named = [f"{name} [{unit}]" for name, unit in STIFFNESSES.items()]
    head = ["width [mm]", "elements [mm]", "sides", *named, "unknowns"]
    return table([*head, "processor [s]"], rows)


def end_table(done: dict[Job, dict[str, Any]], name: str) -> list[str]:
    """Ends by mesh, of one stiffness, and what the rule of all ends makes of them."""
    cases = [(WIDTHS[0], True), (WIDTHS[1], True), (WIDTHS[0], False)]
    found = [[done[width, edge, free][name] for width, free in cases] for edge in EDGES]
    found.append([2.0 * fine - coarse for coarse, fine in zip(*found, strict=True)])
    rows = []
    for label, values in zip((*map(str, EDGES), "limit"), found, strict=True):
        per_length = (values[1] - values[0]) / (WIDTHS[1] - WIDTHS[0])
        free, crossing = (0.5 * (values[k] / per_length - WIDTHS[0] + GAP) for k in (0, 2))
        off = [
            length_by_rule(width) * per_length / value - 1.0
            for width, value in zip(WIDTHS, values[:2], strict=True)
        ]
        shown = [f"{per_length:.5f}", f"{free:.4f}", f"{free / GAP:.3f}", f"{crossing:.4f}"]
        rows.append([label, *shown, *(f"{100.0 * share:+.2f} %" for share in off)])
    head = ["elements [mm]", f"k [{STIFFNESSES[name]} per mm]", "e [mm]", "e / gap", "c [mm]"]
    return table([*head, *(f"rule, {width:g} mm wide" for width in WIDTHS)], rows)


def main() -> None:
    """Solve what the log does not have, and write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--log", type=Path, default=LOG, help="file of the solves, gone on with")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    options = parser.parse_args()
    options.log.parent.mkdir(parents=True, exist_ok=True)
    for job in JOBS:
        if job not in read(options.log):
            line = json.dumps(solve(*job))
            with options.log.open("a") as file:
                file.write(line + "\n")
    done = read(options.log)
    lines = heading("Free ends of joints", __doc__ or "")
    for name in STIFFNESSES:
        lines += [f"## {name.capitalize()}", "", *end_table(done, name)]
    lines += [
        "`rule`: how much stiffer one row is on joints that end by `patterns/joint_lines.py`, by "
        f"{0.5 * (length_by_rule(WIDTHS[0]) - WIDTHS[0] + GAP):.4f} mm beyond their walls.",
        "",
        "## Solves",
        "",
    ]
    report([*lines, *solve_table(done)], options.output)


if __name__ == "__main__":
    main()
