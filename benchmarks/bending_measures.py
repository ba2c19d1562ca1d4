"""Opening far: what the choice of the bending energy changes, and whether gap strips buckle.

    python benchmarks/bending_measures.py [--output FILE]

Squares and hexagons, opening to 0.03 /mm, with the energy integrated over the thickness ("layers",
the default) and with the three bending energies that are added to the midsurface's. "Second branch"
counts samples at which bending back from the next one met another equilibrium, of those where the
way was unstable; "drop" is the largest loss of moment there. The last two columns look at the sheet
at the largest curvature: the smallest stretch of the midsurface, and half the thickness over the
smallest radius of curvature, which is 1 where the inner face is pressed to nothing. Beyond 1 the
sheet is folded more sharply than its own thickness allows: the strip has collapsed.
"""

from __future__ import annotations

import itertools

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.arrays import FloatArray
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.mechanics.shell import HctShell
from flexscale.mechanics.substrate_options import BENDING_MEASURES
from flexscale.mesh.torus import build_mesh
from flexscale.solve.solver_options import SolverOptions

CURVATURES = (0.001, 0.003, 0.006, 0.01, 0.0125, 0.015, 0.02, 0.025, 0.03)
SHOWN = (0.01, 0.02, 0.03)
SAME = 1e-5


def extremes(shell: HctShell, y: FloatArray, thickness: float) -> tuple[float, float]:
    """Smallest stretch of the midsurface, largest t/2 times principal curvature."""
    v = np.einsum("tqai,tic->tqac", shell.derivatives, y[shell.vectors])
    a = np.einsum("tqic,tqjc->tqij", v[:, :, :2], v[:, :, :2])
    normal = np.cross(v[:, :, 0], v[:, :, 1])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    b = np.einsum("tqkc,tqc->tqk", v[:, :, 2:], normal)[..., [0, 1, 1, 2]].reshape(a.shape)
    curvatures = np.linalg.eigvals(np.linalg.solve(a, b)).real
    stretch = np.sqrt(np.linalg.eigvalsh(a).min())
    return float(stretch), float(0.5 * thickness * np.abs(curvatures).max())


def second_branch(samples: list[dict]) -> str:
    """How many samples have another equilibrium on the way back, and the largest drop of moment."""
    checked, drops = 0, []
    for before, after in itertools.pairwise(samples):
        if "energy_density_returning" in after:
            checked += 1
            if abs(after["energy_density_returning"] / before["energy_density"] - 1.0) > SAME:
                drops.append(1.0 - after["moment_returning"] / before["moment"])
    return f"{len(drops)} of {checked}" + (f", drop {100.0 * max(drops):.0f} %" if drops else "")


def row(family: str, direction: float, measure: str) -> str:
    """Moments of one opening line."""
    pattern = fs.Pattern(fs.Tiling(family))
    options = fs.SubstrateOptions(bending_measure=measure)
    mesh = build_mesh(pattern, fs.MeshOptions())
    problem = CellProblem(mesh, CellModel.of_pattern(pattern, fs.NativeModel(substrate=options)))
    line = Line("opening", direction, CURVATURES)
    samples = list(follow_line(problem, line, SolverOptions()))
    done = [sample for sample in samples if sample["status"] == 0]
    found = {sample["curvature"]: sample for sample in done}
    cells = [f"{family} {direction:g}°", measure]
    cells += [f"{found[k]['moment']:.3f}" if k in found else "not converged" for k in SHOWN]
    iterations = np.mean([sample["newton_iterations"] for sample in done])
    cells += [f"{len(done)} of {len(samples)}", f"{iterations:.1f}", second_branch(done)]
    last = done[-1]
    y = problem.embedding.world_map.place(last["state"], line.bend(last["curvature"])).y
    shell = problem.energies[0]
    assert isinstance(shell, HctShell)
    cells += [f"{value:.2f}" for value in extremes(shell, y, pattern.substrate_thickness)]
    text = "| " + " | ".join(cells) + " |"
    print(text, flush=True)
    return text


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    rows = [
        "| pattern | bending energy | M(0.01), N | M(0.02) | M(0.03) | converged | iterations "
        "| second branch | smallest stretch | t / 2 radius |",
        "|---" * 10 + "|",
    ]
    for family, direction in (("IH76", 0.0), ("IH76", 45.0), ("IH20", 0.0)):
        rows += [row(family, direction, measure) for measure in reversed(BENDING_MEASURES)]
    report(rows, output)


if __name__ == "__main__":
    main()
