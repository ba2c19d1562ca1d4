"""Cells of rigid scales on joints: against the solid, and what they cost beside the shell.

    python benchmarks/joint_cells.py [--output FILE] [--full]

Stiffness at rest is compared with the limits of `solid_tangents.py`, lines through contact with
those of `solid_lines.py`, from their logs beside this page. Times are of processor time on one
thread, joints and shell in turn in one process; a Newton iteration is that of a sweep along 7
degree, all that happens in it included. --full sweeps all twelve patterns every 2 degree.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from report import heading, peak_memory, report, table

import flexscale as fs
from flexscale.arrays import BoolArray, FloatArray
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.build import build_problem
from flexscale.homogenize.cell_model import plate_stiffness
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.problem import Problem
from flexscale.homogenize.tangent import TangentStiffness, solve_tangent
from flexscale.plotting.style import (
    MACRO_COLOR,
    NATIVE_COLOR,
    PAGE_WIDTH,
    SCALE_COLOR,
    flexscale_style,
    new_figure,
)

PAGES = Path(__file__).resolve().parents[1] / "results" / "reference" / "benchmarks"
D = plate_stiffness(fs.TPU, 0.4)
DIRECTIONS = np.arange(0.0, 180.0, 15.0)
CURVATURES = tuple(np.linspace(0.0, 0.025, 12))
SIDES = (1, 2, 4, 8, 16)  # of supercells


def read_log(name: str) -> list[dict[str, Any]]:
    """Lines of JSON beside the pages; none if there is no such log yet."""
    path = PAGES / name
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


Limits = dict[tuple[str, str], FloatArray]


def limits(log: list[dict[str, Any]]) -> Limits:
    """Pattern, scales -> stiffness along `DIRECTIONS` [D], extrapolated from two meshes; that of
    elastic scales from their share on one mesh."""
    found: dict[tuple[str, str, float], FloatArray] = {}
    shares: Limits = {}
    for line in log:
        tangent = TangentStiffness(np.array(line["matrix"]), np.zeros((3, 3)))
        a = np.asarray(tangent.stiffness(DIRECTIONS)) / D
        if line["along"] == 1.6 and line["growth"] < 1.5:
            found[line["pattern"], line["scales"], line["edge"]] = a
        elif line["along"] == 1.6:
            shares[line["pattern"], line["scales"]] = a
    out: Limits = {}
    for name in dict.fromkeys(name for name, _, _ in found):
        rigid = 2.0 * found[name, "rigid", 0.03] - found[name, "rigid", 0.06]
        out[name, "rigid"] = rigid
        if (name, "tets") in shares:
            out[name, "PETG"] = rigid * shares[name, "tets"] / shares[name, "rigid"]
    return out


def at_rest() -> list[str]:
    """Joints against the solid, all patterns and both materials of scales."""
    rows = []
    materials = {"rigid": fs.RIGID, "PETG": fs.PETG}
    for (name, scales), solid in limits(read_log("solid_tangents.jsonl")).items():
        pattern = fs.named_pattern(name, scale_material=materials[scales])
        joints = np.asarray(fs.tangent_stiffness(pattern).stiffness(DIRECTIONS)) / D
        ratio = joints / solid - 1.0
        worst = int(np.abs(ratio).argmax())
        rows.append([
            name, scales, f"{solid.min():.1f} to {solid.max():.1f}",
            f"{100 * ratio.min():+.1f} to {100 * ratio.max():+.1f}",
            f"{DIRECTIONS[worst]:g}",
        ])  # fmt: skip
    head = ["pattern", "scales", "solid, D", "joints less solid, %", "worst at, degree"]
    return ["## At rest, every 15 degree", "", *table(head, rows)]


def onset(kappa: FloatArray, gap: FloatArray, touching: BoolArray) -> float:
    """mm-1 at which scales meet: the last two gaps before, carried on to nothing."""
    if not touching.any():
        return float("nan")
    last = int(np.argmax(touching)) - 1
    slope = (gap[last] - gap[last - 1]) / (kappa[last] - kappa[last - 1])
    return float(kappa[last] - gap[last] / slope)


def through_contact() -> list[str]:
    """Joints against the solid along lines; the solid's mesh is stiffer than its limit."""
    lines: dict[tuple[str, float, str], list[dict[str, Any]]] = {}
    for item in read_log("solid_lines.jsonl"):
        lines.setdefault((item["pattern"], item["direction"], item["side"]), []).append(item)
    known = limits(read_log("solid_tangents.jsonl"))
    rows = []
    for (name, direction, side), samples in lines.items():
        pattern = fs.named_pattern(name, scale_material=fs.RIGID)
        kappa = np.array([item["curvature"] for item in samples])
        data = fs.sweep(pattern, [direction], [0.0, *kappa], (side,), workers=1)
        data = data.isel(side=0, direction=0, curvature=slice(1, None))
        solid = np.array([item["moment"] for item in samples])
        gaps = np.array([item["min_gap"] for item in samples])
        touches = np.array([item["contact_force"] > 0.0 for item in samples])
        ratio = data.moment.values / solid - 1.0
        met = onset(kappa, data.min_gap.values, data.contact_pairs.values > 0)
        theirs = onset(kappa, gaps, touches)
        rest = known[name, "rigid"][np.flatnonzero(direction == DIRECTIONS)[0]]
        of_mesh = solid[0] / kappa[0] / D / rest - 1.0
        parts = [ratio[~touches], ratio[touches]]
        said = [f"{100 * p.min():+.1f} to {100 * p.max():+.1f}" if len(p) else "" for p in parts]
        meets = (
            ["", ""] if np.isnan(theirs) else [f"{theirs:.5f}", f"{100 * (met / theirs - 1):+.1f}"]
        )
        rows.append([name, f"{direction:g}", side, f"{100 * of_mesh:+.1f}", *said, *meets])
    head = ["pattern", "direction", "side", "solid's mesh over its limit at rest, %"]
    head += [
        "moment before contact, %",
        "in contact, %",
        "onset of the solid, mm-1",
        "of joints, %",
    ]
    return ["## Along lines to 0.02 mm-1, rigid scales: joints less solid", "", *table(head, rows)]


def shipped(kind: str, name: str) -> Any:
    """The shell's dataset of a pattern among the reference results."""
    registry = fs.open_registry(PAGES.parents[1])
    return registry.one(kind=kind, pattern=name, source="reference", native="shell")


def draw_at_rest(path: Path) -> None:
    """Solid, joints and shell side by side, PETG scales."""
    known = limits(read_log("solid_tangents.jsonl"))
    around = np.arange(0.0, 181.0, 2.0)
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.75 * PAGE_WIDTH)
        axes = figure.subplots(3, 4, sharex=True)
        for item, panel in zip(fs.named_patterns(), axes.flat, strict=True):
            pattern = fs.named_pattern(item.name)
            of_shell = TangentStiffness(
                shipped("tangent", item.name).matrix.values, np.zeros((3, 3))
            )
            shell = np.asarray(of_shell.stiffness(around)) / D
            joints = np.asarray(fs.tangent_stiffness(pattern).stiffness(around)) / D
            panel.semilogy(around, shell, color=SCALE_COLOR, linewidth=0.8, label="shell")
            panel.semilogy(around, joints, color=NATIVE_COLOR, label="joints")
            panel.semilogy(DIRECTIONS, known[item.name, "PETG"], "o", color=MACRO_COLOR,
                           markersize=2.5, label="solid")  # fmt: skip
            panel.set_title(item.name.replace("_", " "))
            panel.set_xticks([0.0, 45.0, 90.0, 135.0, 180.0])
            panel.set_ylim(5.0, 15000.0)
        for panel in axes[-1]:
            panel.set_xlabel("direction [°]")
        for panel in axes[:, 0]:
            panel.set_ylabel("stiffness at rest [D]")
        figure.legend(
            *axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=3
        )
        figure.savefig(path, dpi=150)


def draw_lines(path: Path) -> None:
    """Moments against curvature along the lines of the solid, rigid scales; the shell's are of
    PETG."""
    lines: dict[tuple[str, float], dict[str, list[dict[str, Any]]]] = {}
    for item in read_log("solid_lines.jsonl"):
        sides = lines.setdefault((item["pattern"], item["direction"]), {})
        sides.setdefault(item["side"], []).append(item)
    kappa = np.linspace(0.0, 0.02, 21)
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.62 * PAGE_WIDTH)
        for k, ((name, direction), sides) in enumerate(lines.items()):
            axes = figure.add_subplot(2, 4, k + 1)
            pattern = fs.named_pattern(name, scale_material=fs.RIGID)
            data = fs.sweep(pattern, [direction], kappa.tolist(), workers=1)
            shell = shipped("sweep", name)
            for side, style in (("closing", "-"), ("opening", "--")):
                thin = shell.moment.sel(side=side, direction=direction)
                thin = thin.sel(curvature=thin["curvature"] <= 0.02)
                axes.plot(thin["curvature"], thin, style, color=SCALE_COLOR, linewidth=0.8,
                          label=f"shell, {side}")  # fmt: skip
                axes.plot(kappa, data.moment.sel(side=side, direction=direction), style,
                          color=NATIVE_COLOR, label=f"joints, {side}")  # fmt: skip
                axes.plot([s["curvature"] for s in sides[side]], [s["moment"] for s in sides[side]],
                          "o" if side == "closing" else "s", color=MACRO_COLOR, markersize=2.5,
                          label=f"solid, {side}")  # fmt: skip
            axes.set_title(f"{name}, {direction:g}°")
            axes.set_xlabel("curvature [mm$^{-1}$]")
            axes.set_ylabel("moment [N]")
            axes.set_xlim(0.0, 0.021)
            axes.set_ylim(bottom=0.0)
        figure.legend(
            *figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=6
        )
        figure.savefig(path, dpi=150)


def cost(problem: Problem, solver: fs.SolverOptions) -> tuple[float, float]:
    """ms of a Newton iteration, and of a sample, along 7 degree to both sides."""
    iterations = samples = 0
    start = time.process_time()
    for side in ("closing", "opening"):
        for sample in follow_line(problem, Line(side, 7.0, CURVATURES), solver):
            iterations += sample.get("newton_iterations", 0)
            samples += 1
    seconds = time.process_time() - start
    return 1e3 * seconds / iterations, 1e3 * seconds / samples


def side_by_side() -> list[str]:
    """Joints and shell in turn."""
    rows = []
    for name in ("square", "hexagon", "arrowhead"):
        pattern = fs.named_pattern(name)
        found = {}
        for native in ("joints", "shell"):
            model = fs.NativeModel(native)
            problem = build_problem(pattern, model)
            solve_tangent(problem)
            list(follow_line(problem, Line("closing", 7.0, (0.001,)), model.solver))  # compiles
            found[native] = (len(problem.active), *cost(problem, model.solver))
        (n, a, b), (m, c, d) = found["joints"], found["shell"]
        times = [f"{a:.2f}", f"{c:.1f}", f"{b:.2f}", f"{d:.0f}", f"{d / b:.0f}"]
        rows.append([name, str(n), str(m), *times])
    head = ["pattern", "unknowns, joints", "shell", "ms an iteration, joints", "shell"]
    head += ["ms a sample, joints", "shell", "ratio"]
    return ["## Cost beside the shell", "", *table(head, rows)]


def characterization(full: bool) -> list[str]:
    """Sweeps every 2 degree, both sides, 12 curvatures to 0.025 /mm: 2,160 samples a pattern."""
    names = [item.name for item in fs.named_patterns()] if full else ["hexagon"]
    rows, total = [], 0.0
    for name in names:
        start = time.process_time()
        data = fs.sweep(
            fs.named_pattern(name), np.arange(0.0, 180.0, 2.0).tolist(), CURVATURES, workers=1
        )
        seconds = time.process_time() - start
        total += seconds
        rows.append([
            name, f"{seconds:.1f}", str(int((data.status != 0).sum())),
            str(len(np.unique(data.symmetry_source))), str(int((data.outside_range > 0).sum())),
        ])  # fmt: skip
    if full:
        rows.append(["all", f"{total:.1f}", "", "", ""])
    head = ["pattern", "s", "not converged", "directions solved", "samples beyond the law's range"]
    return ["## 2,160 samples", "", *table(head, rows)]


def supercell(n: int) -> dict[str, float]:
    """Cost of n x n squares in one cell."""
    first, second = np.array([10.0, 0.0]), np.array([0.0, 10.0])
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    tiles = [square + i * first + j * second for i in range(n) for j in range(n)]
    pattern = fs.Pattern.from_polygons(tiles, n * first, n * second)
    problem = build_problem(pattern, fs.NativeModel())
    line = Line("closing", 20.0, (0.002, 0.004, 0.006, 0.008))
    list(follow_line(problem, line, fs.SolverOptions()))  # compiles
    start, iterations = time.process_time(), 0
    for sample in follow_line(problem, line, fs.SolverOptions()):
        iterations += sample["newton_iterations"]
    ms = 1e3 * (time.process_time() - start) / iterations
    return {"scales": n * n, "unknowns": len(problem.active), "ms": ms, "memory": peak_memory()}


def supercells() -> list[str]:
    """Each in a process of its own; the exponent of an iteration's cost."""
    found = []
    for n in SIDES:
        command = [sys.executable, __file__, "--supercell", str(n)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        found.append(json.loads(done.stdout))
    rows = [
        [f"{f['scales']:.0f}", f"{f['unknowns']:.0f}", f"{f['ms']:.2f}",
         f"{f['ms'] / f['scales']:.3f}", f"{f['memory']:.0f}"] for f in found
    ]  # fmt: skip
    a, b = found[-2], found[-1]
    exponent = np.log(b["ms"] / a["ms"]) / np.log(b["scales"] / a["scales"])
    head = ["scales", "unknowns", "ms an iteration", "ms a scale", "peak memory, MB"]
    span = f"From {a['scales']:.0f} to {b['scales']:.0f} scales"
    said = f"{span} the cost grows by the power {exponent:.2f}."
    return ["## Supercells of squares", "", *table(head, rows), said, ""]


def main() -> None:
    """Print the tables, and write them if asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    parser.add_argument("--full", action="store_true", help="sweep all twelve patterns")
    parser.add_argument("--supercell", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.supercell:
        print(json.dumps(supercell(arguments.supercell)))
        return
    rows = heading("Cells on joints", __doc__ or "")
    rows += at_rest() + through_contact() + side_by_side()
    rows += characterization(arguments.full) + supercells()
    if arguments.output:
        draw_at_rest(arguments.output.with_name("joint_cells_at_rest.png"))
        draw_lines(arguments.output.with_name("joint_cells_lines.png"))
    report(rows, arguments.output)


if __name__ == "__main__":
    main()
