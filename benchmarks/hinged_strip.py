"""Arrowheads on the stage: joints beside the shell and the fit, curl, and where scales touch.

    python benchmarks/hinged_strip.py [--results DIR] [--output FILE]

A strip of 100 x 25 mm along 0° is bent between its hinges to both sides (Figs. 10, 11) by scales on
joints, laid as the strip of the shell was that was measured when there was one. The shell's numbers
are those of results/reference/benchmarks/native_stage.md at commit d282c27: 36 scales, 47,698
unknowns, a mesh half as fine as a cell's and 1 to 5 % too stiff at rest, run at commit 9c67da1, no
further than 6 mm. "fit" is the same strip of the macro model that is fitted to sweeps of joints.

Curvatures are those in the middle of the strip: slopes of the normals of scales within 20 mm of it,
over undeformed places along and across. Along is positive, so that a strip with a negative
curvature across is a saddle; "rise" is the curvature across times the width squared over eight.
"Without contact" is the same strip whose scales pass through one another. Scales touch where the
barrier between them acts, below 0.005 mm. The first shortening at which they do is sought in steps
of 0.1 mm; the curvature there stands beside that at which scales touch in a cell that is bent along
0° and held flat across. The wider strip, 100 x 50 mm, is that of the native_rig dataset of DIR; its
fit is computed here. Pictures go beside the page.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from report import heading, report, table

import flexscale as fs
from flexscale.arrays import FloatArray
from flexscale.datasets.onset import contact_onset
from flexscale.datasets.registry import Registry
from flexscale.finite.deformed_scales import DeformedScales
from flexscale.finite.driven_sheet import Driven, follow_loads
from flexscale.finite.native_stage import NativeStage
from flexscale.homogenize.native_model import NativeModel
from flexscale.plotting.style import (
    MACRO_COLOR,
    NATIVE_COLOR,
    PAGE_WIDTH,
    SCALE_COLOR,
    SIDE_LINESTYLES,
    flexscale_style,
    new_figure,
)
from flexscale.sides import SIDE_SIGNS

LENGTH, WIDTH = 100.0, 25.0  # mm
OFFSET = (3.41639732, -4.50008329)  # mm, where the shell's strip was cut
SHORTENINGS = (0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0)  # mm
FINE = tuple(0.1 * k for k in range(1, 31))  # mm
MIDDLE = 20.0  # mm
PICTURED = 6.0  # mm
VIEW = (-150.0, 40.0)  # degree
#: N, at the first six shortenings, and pairs in contact there.
SHELL = {
    "closing": (0.9073, 3.5807, 13.4534, 17.6666, 19.4258, 20.3505),
    "opening": (0.8972, 1.0410, 1.5793, 2.9733, 3.9235, 5.2979),
}
SHELL_PAIRS = {"closing": (0, 86, 142, 141, 136, 117), "opening": (0, 0, 134, 184, 191, 265)}


@dataclass(frozen=True)
class Bent:
    """The strip at a shortening.

    Attributes
    ----------
    along, across : mm-1, curvatures in the middle; along is positive.
    """

    shortening: float
    force: float
    pairs: int
    along: float
    across: float
    state: FloatArray


def curvatures(stage: NativeStage, state: FloatArray, sign: float) -> tuple[float, float]:
    """mm-1, along and across in the middle of the strip; along is positive as it is bent."""
    found = stage.scales_at(Driven(stage).evaluate(state))
    centers = np.array([outline.mean(axis=0) for outline in stage.sheet.laid.outlines])
    near = np.abs(centers[:, 0] - 0.5 * stage.length) < MIDDLE
    normals = found.turns[near, :, 2]
    places = centers[near] - centers[near].mean(axis=0)
    tilts = np.stack([np.arctan2(normals[:, 0], normals[:, 2]), np.arcsin(normals[:, 1])], axis=1)
    slopes = np.linalg.lstsq(np.column_stack([places, np.ones(len(places))]), tilts, rcond=None)[0]
    # Towards the side of the normals a sheet is bent where they come closer.
    return -sign * float(slopes[0, 0]), -sign * float(slopes[1, 1])


def bend(stage: NativeStage, side: str, shortenings: tuple[float, ...]) -> list[Bent]:
    """The strip at shortenings that were reached."""
    sign, bent = SIDE_SIGNS[side], []
    start = stage.clear_arc(shortenings[0], sign)
    for sample in follow_loads(stage, shortenings, stage.native.solver, (), start):
        if "state" not in sample:
            break
        along, across = curvatures(stage, sample["state"], sign)
        bent.append(
            Bent(sample["load"], sample["force"], sample["contact_pairs"], along, across,
                 sample["state"])
        )  # fmt: skip
    return bent


def strip(width: float = WIDTH, *, touch: bool = True) -> NativeStage:
    """The strip of arrowheads."""
    native = NativeModel(contact=fs.ContactOptions(enabled=touch))
    offset = OFFSET if width == WIDTH else (0.0, 0.0)
    return NativeStage(fs.named_pattern("arrowhead"), LENGTH, width, 0.0, offset, native)


def fitted(registry: Registry, width: float) -> dict[str, FloatArray]:
    """N, of the macro model on joints, by side."""
    model = fs.MacroModel.from_dataset(
        registry.one(kind="fit", pattern="arrowhead", native="joints")
    )
    return {
        side: fs.simulate_stage(
            model, length=LENGTH, width=width, shortenings=SHORTENINGS, side=side
        ).force
        for side in SIDE_SIGNS
    }


def narrow_rows(
    tests: dict[str, list[Bent]], passing: dict[str, list[Bent]], fit: dict[str, FloatArray]
) -> list[str]:
    """The narrow strip, and how it curls."""
    head = [
        "side",
        "shortening, mm",
        "joints, N",
        "shell, N",
        "joints/shell",
        "fit, N",
        "fit/joints",
    ]
    head += ["pairs, joints", "shell"]
    shapes = ["side", "shortening, mm", "along, 1/mm", "across, 1/mm", "across/along", "rise, mm"]
    shapes += ["along, without contact", "across/along, without contact"]
    rows, curls = [], []
    for side, bent in tests.items():
        for k, (one, free) in enumerate(zip(bent, passing[side], strict=False)):
            shell = SHELL[side][k] if k < len(SHELL[side]) else np.nan
            pairs = f"{SHELL_PAIRS[side][k]}" if k < len(SHELL[side]) else ""
            rows.append([
                side, f"{one.shortening:g}", f"{one.force:.3f}", _shown(shell, 3),
                _shown(one.force / shell, 3), f"{fit[side][k]:.3f}",
                f"{fit[side][k] / one.force:.3f}", f"{one.pairs}", pairs,
            ])  # fmt: skip
            curls.append([
                side, f"{one.shortening:g}", f"{one.along:.4f}", f"{one.across:.4f}",
                f"{one.across / one.along:.2f}", f"{one.across * WIDTH**2 / 8.0:.2f}",
                f"{free.along:.4f}", f"{free.across / free.along:.2f}",
            ])  # fmt: skip
    return [
        "## 100 x 25 mm: force", "", *table(head, rows),
        "## 100 x 25 mm: shape in the middle", "", *table(shapes, curls),
    ]  # fmt: skip


def _shown(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if np.isfinite(value) else ""


def onset_rows(registry: Registry) -> list[str]:
    """The first shortening at which scales touch, and the curvature there."""
    onset = contact_onset(registry.one(kind="sweep", pattern="arrowhead", native="joints"))
    head = ["side", "width, mm", "touch at, mm", "along there, 1/mm", "across/along"]
    head += ["cell touches between, 1/mm"]
    rows = []
    for side in SIDE_SIGNS:
        cell = onset.sel(side=side, direction=0.0)
        low, high = float(cell["free_until"]), float(cell["touches_from"])
        between = f"{low:.4f} and {high:.4f}" if np.isfinite(high) else "not up to 0.03"
        for width in (WIDTH, 2.0 * WIDTH):
            for one in bend(strip(width), side, FINE):
                if one.pairs:
                    rows.append([
                        side, f"{width:g}", f"{one.shortening:.1f}", f"{one.along:.4f}",
                        f"{one.across / one.along:.2f}", between,
                    ])  # fmt: skip
                    break
    return ["## Where scales touch first", "", *table(head, rows)]


def wide_rows(registry: Registry, fit: dict[str, FloatArray]) -> list[str]:
    """The wider strip, of the shipped dataset."""
    native = registry.one(kind="native_rig", pattern="arrowhead")
    head = ["shortening, mm", "closing, N", "fit, N", "fit/joints", "opening, N", "fit, N"]
    head += ["fit/joints", "closing/opening, joints"]
    rows = []
    for k, shortening in enumerate(SHORTENINGS):
        sides = []
        forces = {
            side: float(native["stage_force"].sel(side=side, shortening=shortening))
            for side in SIDE_SIGNS
        }
        for side, force in forces.items():
            macro = fit[side][k]
            sides += [f"{force:.3f}", f"{macro:.3f}", f"{macro / force:.3f}"]
        ratio = forces["closing"] / forces["opening"]
        rows.append([f"{shortening:g}", *sides, f"{ratio:.2f}"])
    return ["## 100 x 50 mm: force", "", *table(head, rows)]


def draw(tests: dict[str, list[Bent]], fit: dict[str, FloatArray], path: Path) -> None:
    """Forces of all models, and curvatures across over those along."""
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.36 * PAGE_WIDTH)
        panels = figure.subplots(1, 3)
        for axes, (side, bent) in zip(panels[:2], tests.items(), strict=True):
            x = [one.shortening for one in bent]
            axes.plot(
                x, [one.force for one in bent], color=NATIVE_COLOR, marker="o", label="joints"
            )
            shell = SHELL[side]
            axes.plot(SHORTENINGS[: len(shell)], shell, color=SCALE_COLOR, marker="^",
                      linestyle=":", label="shell (d282c27)")  # fmt: skip
            axes.plot(SHORTENINGS, fit[side], color=MACRO_COLOR, marker="s", linestyle="--",
                      label="fit on joints")  # fmt: skip
            axes.set(xlabel="shortening / mm", ylabel="force / N", title=side, ylim=(0.0, None))
            axes.legend()
            ratios = [one.across / one.along for one in bent]
            panels[2].plot(x, ratios, color=NATIVE_COLOR, linestyle=SIDE_LINESTYLES[side],
                           marker="o", label=side)  # fmt: skip
        panels[2].axhline(0.0, color="0.5", linewidth=0.7)
        panels[2].set(xlabel="shortening / mm", ylabel="curvature across / along", title="curl")
        panels[2].legend()
        figure.savefig(path, dpi=150)


def draw_scales(stage: NativeStage, one: Bent, path: Path) -> None:
    """The strip in space."""
    found = stage.scales_at(Driven(stage).evaluate(one.state))
    shape = DeformedScales(
        stage.pattern, f"arrowhead, closing, {one.shortening:g} mm shorter",
        stage.sheet.laid.outlines, found.places, found.turns, found.energy, found.contact_force,
    )  # fmt: skip
    fs.plot.scaled_sheet(shape, view=VIEW).savefig(path, dpi=130)


def main() -> None:
    """All tables and pictures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    arguments = parser.parse_args()
    registry, output = fs.open_registry(arguments.results), arguments.output
    bend(strip(), "closing", SHORTENINGS[:2])  # compiles
    start = time.process_time()
    stage = strip()
    tests = {side: bend(stage, side, SHORTENINGS) for side in SIDE_SIGNS}
    seconds = time.process_time() - start
    loose = strip(touch=False)
    passing = {side: bend(loose, side, SHORTENINGS) for side in SIDE_SIGNS}
    fit = fitted(registry, WIDTH)
    rows = heading("Arrowheads on the stage", __doc__ or "")
    rows += narrow_rows(tests, passing, fit) + onset_rows(registry)
    rows += wide_rows(registry, fitted(registry, 2.0 * WIDTH))
    rows += [
        f"{len(stage.sheet.laid.tiles)} scales, {len(stage.active)} unknowns: {seconds:.0f} s of "
        "processor time for both sides on joints; the shell took 460 s of one core for the first "
        "six shortenings."
    ]
    report(rows, output)
    if output:
        draw(tests, fit, output.with_name("hinged_strip.png"))
        pictured = next(one for one in tests["closing"] if one.shortening == PICTURED)
        draw_scales(stage, pictured, output.with_name("hinged_strip_closing.png"))


if __name__ == "__main__":
    main()
