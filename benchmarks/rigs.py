"""Mandrel and stage: isotropic calibration, mesh convergence, lobes and sides of fitted patterns.

    python benchmarks/rigs.py --results DIR [--output FILE]

Models are those that `flexscale run` has fitted in DIR. The mandrel is a disc of 100 mm radius,
pushed by 15 mm; angles are in the pattern's coordinates. The mesh has six equal, mirrored sectors,
so that an isotropic disc needs 0 to 30° only, and half a turn takes every energy to itself. The
stage is 100 x 50 mm. The isotropic sheet is 0.4 mm of a material of 26 MPa. "s" is the time of one
solve, on one core.
"""

from __future__ import annotations

import time

import numpy as np
from report import datasets_and_output, heading, report, table
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import flexscale as fs
from flexscale.mechanics.linear_law import isotropic_sheet
from flexscale.sheets.mandrel import MandrelRig, MandrelTest
from flexscale.sheets.stage import StageRig
from flexscale.status import SolveStatus

YOUNG, THICKNESS = 26.0, 0.4  # MPa, mm
SECTOR = (0.0, 15.0, 30.0)  # degree
ROUND = tuple(15.0 * k for k in range(12))
LOBES = ("hexagon", "square", "pinwheel4", "arrowhead")
LOBE_SIZE = 6.25  # mm
SHORTENINGS = (0.1, 0.5, 2.0, 10.0, 30.0, 50.0)
STAGE_SHORTENINGS = (0.5, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0)


def isotropic_disc() -> list[str]:
    """Spread of the force over angles, by mesh, with the default hub."""
    rows = []
    for size in (12.5, 100 / 12, 6.25, 5.0):
        rig = MandrelRig(isotropic_sheet(YOUNG, 0.48, THICKNESS), options=fs.RigOptions(size=size))
        start = time.perf_counter()
        force = rig.test(angles=SECTOR).force
        seconds = (time.perf_counter() - start) / len(SECTOR)
        shown = [f"{1e3 * value:.4f}" for value in force]
        spread = f"{100.0 * np.ptp(force) / force.mean():.3f} %"
        faces = len(rig.sheet.mesh.triangles)
        rows.append([f"{size:.4g}", f"{faces}", *shown, spread, f"{seconds:.1f}"])
    head = ["size [mm]", "faces", *(f"{angle:g}° [mN]" for angle in SECTOR), "spread", "s"]
    return ["## Isotropic disc, hub of 10 mm", "", *table(head, rows)]


def convergence() -> list[str]:
    """Force by element size on meshes that all have a ring at the hub."""
    sizes = (25.0, 12.5, 6.25, 3.125)
    forces = []
    for size in sizes:
        law = isotropic_sheet(YOUNG, 0.48, THICKNESS)
        rig = MandrelRig(law, hub=25.0, options=fs.RigOptions(size=size))
        forces.append(float(rig.test(angles=[15.0]).force[0]))
    rows = []
    for k, (size, force) in enumerate(zip(sizes, forces, strict=True)):
        change = f"{100 * (force / forces[k - 1] - 1.0):+.3f} %" if k else "–"
        error = f"{100 * (force / forces[-1] - 1.0):+.3f} %"
        rows.append([f"{size:g}", f"{1e3 * force:.4f}", change, error])
    head = ["size [mm]", "force at 15° [mN]", "from the mesh before", "over the finest"]
    return ["## Mesh convergence, isotropic disc, hub of 25 mm", "", *table(head, rows)]


def lobes(models: dict[str, fs.MacroModel]) -> list[str]:
    """Forces around the mandrel: smallest, largest, and where."""
    head = ["pattern", "side", *(f"{angle:g}°" for angle in ROUND), "largest/smallest", "failed"]
    rows = []
    for name, model in models.items():
        for side in ("closing", "opening") if name == "arrowhead" else ("closing",):
            options = fs.RigOptions(size=LOBE_SIZE)
            test: MandrelTest = fs.simulate_mandrel(model, angles=ROUND, side=side, options=options)
            ratio = np.nanmax(test.force) / np.nanmin(test.force)
            failed = int(np.count_nonzero(test.status != SolveStatus.converged))
            shown = [f"{force:.3f}" for force in test.force]
            rows.append([name, side, *shown, f"{ratio:.3f}", f"{failed}"])
    return ["## Force around the mandrel [N]", "", *table(head, rows)]


def elastica(shortening: float, length: float, stiffness: float) -> float:
    """N, between the pinned ends of an inextensible strip of a bending stiffness [N mm2]."""
    m = brentq(lambda m: 2.0 * (1.0 - ellipe(m) / ellipk(m)) - shortening / length, 1e-12, 0.999)
    return 4.0 * ellipk(m) ** 2 * stiffness / length**2


def stage_against_elastica() -> list[str]:
    """Force over that of the elastica; a beam's stiffness for both Poisson ratios."""
    beam = 50.0 * YOUNG * THICKNESS**3 / 12.0
    exact = np.array([elastica(shortening, 100.0, beam) for shortening in SHORTENINGS])
    rows = []
    for ratio, size in ((0.0, 20.0), (0.0, 10.0), (0.0, 5.0), (0.48, 5.0)):
        rig = StageRig(isotropic_sheet(YOUNG, ratio, THICKNESS), options=fs.RigOptions(size=size))
        force = rig.test(SHORTENINGS).force
        rows.append([f"{ratio:g}", f"{size:g}", *(f"{value:.5f}" for value in force / exact)])
    head = ["Poisson", "size [mm]", *(f"{shortening:g} mm" for shortening in SHORTENINGS)]
    plate = f"A plate without free edges would be 1/(1 - 0.48²) = {1 / (1 - 0.48**2):.4f} times as "
    plate += "stiff as a beam; near the onset the edges are free to curl."
    return ["## Stage: force over that of a beam's elastica", "", *table(head, rows), plate, ""]


def stage_sides(model: fs.MacroModel) -> list[str]:
    """Closing against opening on the stage."""
    rows = []
    for direction in (0.0, 90.0):
        closing, opening = (
            fs.simulate_stage(model, shortenings=STAGE_SHORTENINGS, direction=direction, side=side)
            for side in ("closing", "opening")
        )
        for k, shortening in enumerate(STAGE_SHORTENINGS):
            pair = closing.force[k], opening.force[k]
            curvatures = closing.largest_curvature[k], opening.largest_curvature[k]
            rows.append(
                [f"{direction:g}°", f"{shortening:g}", *(f"{force:.3f}" for force in pair),
                 f"{pair[0] / pair[1]:.3f}", *(f"{value:.4f}" for value in curvatures)]
            )  # fmt: skip
    head = ["along", "shortening [mm]", "closing [N]", "opening [N]", "closing/opening"]
    head += [f"largest curvature, {side} [mm-1]" for side in ("closing", "opening")]
    beyond = f"The model was fitted up to {model.largest_curvature:g} mm-1."
    return ["## Stage: arrowhead, both sides", "", *table(head, rows), beyond, ""]


def main() -> None:
    """All tables."""
    registry, output = datasets_and_output(__doc__ or "")
    models = {
        name: fs.MacroModel.from_dataset(registry.one(kind="fit", pattern=name)) for name in LOBES
    }
    rows = heading("Mandrel and stage", __doc__ or "")
    rows += isotropic_disc() + convergence() + lobes(models)
    rows += stage_against_elastica() + stage_sides(models["arrowhead"])
    report(rows, output)


if __name__ == "__main__":
    main()
