"""Discs between hub and probe: are free lengths why forces half a turn apart differ?

    python benchmarks/half_turn.py [--log FILE] [--output FILE]

A disc of the three-fold pattern is clamped at its middle and pushed at its rim by 15 mm, as in
Fig. 9h, where prints resist differently half a turn apart. The paper explains it by the clamp: all
scales next to the middle are immobile, so that free lengths from there to the rim differ. A sheet
that is bent to one curvature everywhere cannot tell half a turn. Discs here are of rigid scales on
joints, pushed towards the scales, and differ in one thing at a time.

With "scales" as clamp, all scales that the hub touches are held whole, as on the mandrel. With
"round", the pattern is cut along a circle about the middle, and what is inside is one body: the
joint along the circle, and so the free length, is the same all around, but scales and joints beyond
it are where they are, and cut. The clamp of 17 mm has the area of the whole scales that the hub of
10 mm holds of the three-fold pattern about its first center. Hexagons about a corner are turned
into themselves by a third of a turn only, hexagons about their middle by a sixth.

"Asymmetry" is the largest F(a) / F(a + 180°) - 1 over angles every 15° (30° where no center lies in
the middle). Free length is taken along the ray to the probe, from where it leaves the clamped
scales, and as the shortest way from the probe to them. "Power" is the slope of a line through 0 of
log F(a)/F(a + 180°) over the same logarithm of free lengths, r the correlation about 0; a beam
would have -3. "Pairs" are the most scales in contact at any angle. With --log, finished discs are
kept in a file of JSON lines, and a second call goes on from there. A picture goes beside the page:
all pairs of angles of discs with whole scales as clamp, with lines of powers -1 to -3; and forces
around four discs.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from half_turn_discs import INDENTATIONS, LAYOUTS, measure
from report import heading, report, table

from flexscale.arrays import FloatArray
from flexscale.plotting.style import (
    MACRO_COLOR,
    NATIVE_COLOR,
    PAGE_WIDTH,
    flexscale_style,
    new_figure,
)

LOOKS = (("threefold", NATIVE_COLOR, "o"), ("hexagon", MACRO_COLOR, "s"))


def half_turn_ratios(values: FloatArray, angles: FloatArray) -> FloatArray:
    """(n,) of values at angles over those half a turn further; angles are of one turn of order 3 or
    6, or all around, at equal steps."""
    step = angles[1] - angles[0]
    shift = round((180.0 % (step * len(angles))) / step)
    return np.asarray(values / np.roll(values, -shift))


def line_through_zero(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Slope, and correlation about 0."""
    return float(x @ y / (x @ x)), float(x @ y / np.sqrt((x @ x) * (y @ y)))


@dataclass(frozen=True)
class Asymmetry:
    """Of one disc at one indentation: logarithms (n,) over half a turn, of forces and lengths."""

    forces: FloatArray
    along: FloatArray
    nearest: FloatArray

    @property
    def largest(self) -> float:
        """%, of the force over that half a turn away."""
        return 100.0 * float(np.expm1(self.forces.max()))

    def told(self, name: str) -> str:
        """Power and correlation, by one of both lengths."""
        lengths = getattr(self, name)
        if np.abs(lengths).max() < 1e-9:
            return "no difference"
        power, r = line_through_zero(lengths, self.forces)
        return f"{power:.1f} (r {r:.2f})"


def asymmetry(found: dict[str, Any], load: int) -> Asymmetry:
    """Of a disc of the log, at a number of the indentations."""
    angles = np.array(found["angles"])
    values = (np.array(found["forces"])[:, load], found["along"], found["nearest"])
    return Asymmetry(*(np.log(half_turn_ratios(np.asarray(v), angles)) for v in values))


def rows_of(discs: dict[str, dict[str, Any]]) -> list[str]:
    """The tables."""
    head = ["pattern", "middle", "clamp", "hub, mm", "radius, mm", "scales held", "pairs"]
    for load in INDENTATIONS:
        head.append(f"asymmetry, {load:g} mm")
    head += [f"power and r along the ray, {INDENTATIONS[-1]:g} mm", "of the shortest way"]
    rows = []
    for layout in LAYOUTS:
        found = discs[layout.name]
        few, many = (asymmetry(found, load) for load in range(len(INDENTATIONS)))
        rows.append([
            layout.pattern, layout.point, layout.clamp, f"{layout.hub:g}", f"{layout.radius:g}",
            f"{found['held']}", f"{max(found['pairs'])}", f"{few.largest:.2f} %",
            f"{many.largest:.2f} %", many.told("along"), many.told("nearest"),
        ])  # fmt: skip
    return ["## Discs", "", *table(head, rows), *together(discs), *around(discs)]


def whole(discs: dict[str, dict[str, Any]], pattern: str) -> list[dict[str, Any]]:
    """Discs of a pattern whose clamp is of whole scales and differs over half a turn."""
    return [
        discs[layout.name]
        for layout in LAYOUTS
        if (layout.pattern, layout.clamp) == (pattern, "scales") and layout.point != "middle"
    ]


def together(discs: dict[str, dict[str, Any]]) -> list[str]:
    """Power and correlation over all pairs of angles of a pattern's discs."""
    rows = []
    for pattern in ("threefold", "hexagon"):
        for load, indentation in enumerate(INDENTATIONS):
            all_of = [asymmetry(found, load) for found in whole(discs, pattern)]
            forces = np.concatenate([a.forces for a in all_of])
            row = [pattern, f"{len(all_of)}", f"{indentation:g}"]
            for name in ("along", "nearest"):
                power, r = line_through_zero(
                    np.concatenate([getattr(a, name) for a in all_of]), forces
                )
                row.append(f"{power:.2f} (r {r:.2f})")
            rows.append(row)
    head = ["pattern", "discs", "indentation, mm", "power and r along the ray"]
    return ["## All discs whose clamp is of whole scales", "",
            *table([*head, "of the shortest way"], rows)]  # fmt: skip


def around(discs: dict[str, dict[str, Any]]) -> list[str]:
    """Forces around discs with both clamps."""
    rows = []
    for layout in LAYOUTS[:4]:
        found = discs[layout.name]
        forces = [f"{force[-1]:.4f}" for force in found["forces"]]
        rows.append([layout.pattern, layout.clamp, *forces])
    head = ["pattern", "clamp", *(f"{angle:g}°" for angle in LAYOUTS[0].angles)]
    title = f"## Force [N] at {INDENTATIONS[-1]:g} mm; 120° on it is the same again"
    return [title, "", *table(head, rows)]


def draw(discs: dict[str, dict[str, Any]], path: Path) -> None:
    """Asymmetry of forces over that of free lengths, and forces around four discs."""
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.45 * PAGE_WIDTH)
        left, right = figure.subplots(1, 2)
        for pattern, color, marker in LOOKS:
            all_of = [asymmetry(found, -1) for found in whole(discs, pattern)]
            x, y = (np.concatenate([getattr(a, n) for a in all_of]) for n in ("nearest", "forces"))
            left.plot(x, y, linestyle="", color=color, marker=marker, markersize=3.5, label=pattern)
        reach = np.array(left.get_xlim())
        for power in (-1.0, -2.0, -3.0):
            left.plot(reach, power * reach, color="0.6", linewidth=0.7)
            left.annotate(f"{power:g}", (reach[0], power * reach[0]), color="0.4", fontsize=7)
        left.set(xlabel="log of shortest free length over that half a turn away",
                 ylabel="log of force over that half a turn away")  # fmt: skip
        left.legend()
        for layout in LAYOUTS[:4]:
            found = discs[layout.name]
            forces = np.array(found["forces"])[:, -1]
            color, marker = next((c, m) for name, c, m in LOOKS if name == layout.pattern)
            right.plot([*found["angles"], 120.0], [*forces, forces[0]], color=color, marker=marker,
                       markersize=3.5, linestyle="-" if layout.clamp == "scales" else "--",
                       label=f"{layout.pattern}, {layout.clamp}")  # fmt: skip
        right.set(xlabel="angle / degree", ylabel="force / N", ylim=(0.0, None))
        right.legend()
        figure.savefig(path, dpi=150)


def measured(log: Path) -> dict[str, dict[str, Any]]:
    """All discs by name, made as far as the log does not have them."""
    lines = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    discs = {line["name"]: line for line in lines}
    for layout in LAYOUTS:
        if layout.name not in discs:
            discs[layout.name] = measure(layout)
            print(f"{layout.name}: {discs[layout.name]['seconds']:.0f} s", file=sys.stderr)
            with log.open("a") as kept_lines:
                kept_lines.write(json.dumps(discs[layout.name]) + "\n")
    return discs


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--log", type=Path, help="file that keeps the discs done so far")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        discs = measured(arguments.log or Path(name) / "half_turn.jsonl")
    seconds = sum(discs[layout.name]["seconds"] for layout in LAYOUTS)
    rows = heading("Forces half a turn apart", __doc__ or "") + rows_of(discs)
    rows.append(f"All discs take {seconds:.0f} s of processor time.")
    report(rows, arguments.output)
    if arguments.output:
        draw(discs, arguments.output.with_name("half_turn.png"))


if __name__ == "__main__":
    main()
