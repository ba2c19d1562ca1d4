"""The joint's cross-section as a solid: against the clamped strip, by mesh, and by what it holds.

    python benchmarks/joint_section.py [--output FILE]

The strip is Kirchhoff's plate of the gap's width, clamped at both walls, and a shear panel for the
slide: what the shell has in the place of a joint. The section is the sheet of TPU (Poisson's ratio
0.48) under two scales, solved in plane strain and antiplane shear; lengths are in thicknesses t of
the sheet, stiffnesses in its Young's modulus E.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from report import heading, output_file, report, table

import flexscale as fs
from flexscale.arrays import FloatArray
from flexscale.joints.compute import LINEAR, SAMPLED, build_section, linear_stiffness
from flexscale.joints.key import JointGroove, JointKey, joint_key
from flexscale.joints.section import Section
from flexscale.joints.section_mesh import Grading, SectionShape, build_section_mesh
from flexscale.joints.states import follow, rest_state

RATIO = fs.TPU.poisson_ratio
GAPS = (0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)  # thicknesses
SIZES = (0.04, 0.02, 0.01, 0.005, 0.0025)  # thicknesses, at the bond's edges
MODES = ("stretch u", "hinge φ", "hinge φ, u free", "coupling u–φ", "S-mode w", "slide s")
NOTE = (0.34, 0.64, 0.545, -0.39, 0.094, 0.53)  # of the first estimate, g = t, rigid scales


def ratios(stiffness: FloatArray, gap: float) -> FloatArray:
    """(6,) of a joint's stiffness (4, 4) in E t^2 over the strip's, in the order of `MODES`."""
    plane = 1.0 / (1.0 - RATIO**2)
    bending, shear = plane / 12.0, 0.5 / (1.0 + RATIO)
    (uu, ww, ss, pp), up = np.diag(stiffness), stiffness[0, 3]
    return np.array(
        [
            uu * gap / plane,
            pp * gap / bending,
            (pp - up**2 / uu) * gap / bending,
            up / np.sqrt(uu * pp),
            ww * gap**3 / (12.0 * bending),
            ss * gap / shear,
        ]
    )


def rigid(gap: float) -> JointKey:
    """A joint of rigid scales at a gap in thicknesses."""
    return JointKey(gap, 10.0, RATIO)


def of_print(
    gap: float = 0.4, thickness: float = 0.4, height: float = 4.0, groove: JointGroove | None = None
) -> JointKey:
    """A joint of the paper's materials, mm."""
    return joint_key(gap, thickness, height, fs.TPU, fs.PETG, groove)


def cells(values: FloatArray, digits: int = 4) -> list[str]:
    """Numbers of a row."""
    return [f"{value:.{digits}f}" for value in values]


def strip_table() -> list[str]:
    """Joint over strip, by gap, for rigid scales and for PETG."""
    lines = []
    for title, key in (("Rigid scales", rigid), ("Scales of PETG", lambda g: of_print(0.4 * g))):
        rows = [[f"{g:g}", *cells(ratios(linear_stiffness(key(g)), g))] for g in GAPS]
        lines += [f"### {title}", "", *table(["g/t", *MODES], rows)]
    return lines


def mesh_table() -> list[str]:
    """The same at g = t by the smallest element, and the limit from each two meshes."""
    rows, before = [], None
    for size in SIZES:
        grading = replace(LINEAR[0], smallest=size)
        section = build_section(rigid(1.0), grading, slides=True)
        stiffness = rest_state(section).tangent
        row = [f"{size:g} t", str(len(section.active)), *cells(ratios(stiffness, 1.0))]
        rows.append(row)
        if before is not None:
            limit = 2.0 * stiffness - before
            rows.append(["limit of the last two", "", *cells(ratios(limit, 1.0))])
        before = stiffness
    rows.append(["first estimate (0.2 %)", "", *[f"{value:g}" for value in NOTE]])
    return table(["smallest element", "unknowns", *MODES], rows)


def growth_table() -> list[str]:
    """Limits by how elements grow away from the edges."""
    rows = []
    for growth, largest in ((2.0, 0.5), (1.5, 0.25), (1.25, 0.125)):
        pair = tuple(Grading(size, growth, largest) for size in (0.01, 0.005))
        found = ratios(linear_stiffness(rigid(1.0), pair), 1.0)
        rows.append([f"{growth:g}, up to {largest:g} t", *cells(found)])
    return table(["growth from element to element", *MODES], rows)


def extent_table() -> list[str]:
    """By depth behind the walls, height, and groove."""
    rows = []
    for depth in (2.0, 4.0, 6.0, 8.0, 12.0):
        for height in (None, 10.0):
            shape = SectionShape(1.0, depth, height)
            scales = None
            if height is not None:
                ratio = fs.PETG.young_modulus / fs.TPU.young_modulus
                scales = fs.NeoHookean(ratio, fs.PETG.poisson_ratio)
            section = Section(build_section_mesh(shape, LINEAR[0]), RATIO, scales, slides=True)
            name = "rigid" if height is None else "PETG"
            rows.append([f"{name}, {depth:g} t", *cells(ratios(rest_state(section).tangent, 1.0))])
    for height in (2.0, 3.0, 4.0, 6.0):
        key = of_print(height=height)
        rows.append([f"PETG, height {height:g} mm", *cells(ratios(linear_stiffness(key), 1.0))])
    for key, name in (
        (of_print(groove=JointGroove()), "PETG, groove"),
        (replace(of_print(groove=JointGroove()), modulus_ratio=None, scale_poisson_ratio=None),
         "rigid, groove"),
        (of_print(groove=JointGroove(first=0.4)), "PETG, groove from 0.4 mm"),
    ):  # fmt: skip
        rows.append([name, *cells(ratios(linear_stiffness(key), 1.0))])
    return table(["section", *MODES], rows)


def state_table() -> list[str]:
    """Energy and forces of three far states by mesh, rigid scales at g = t."""
    poses = {
        "touching": np.array([2.675, 0.0, 0.0, 0.35]),
        "shifted": np.array([0.3, 0.9, 0.5, 0.0]),
        "pressed": np.array([-0.3, 0.2, 0.0, -0.2]),
    }
    rows = []
    for name, pose in poses.items():
        for grading in (SAMPLED, Grading(0.01, 1.5, 0.25), Grading(0.005, 1.5, 0.25)):
            section = build_section(rigid(1.0), grading, slides=True)
            start = time.perf_counter()
            states = list(follow(section, rest_state(section), np.outer(np.arange(1, 9) / 8, pose)))
            took = time.perf_counter() - start
            if len(states) < 8:
                rows.append([name, f"{grading.smallest:g} t", "not reached", *[""] * 4, ""])
                continue
            last = states[-1]
            values = [last.energy, *last.forces]
            row = [name, f"{grading.smallest:g} t", *[f"{value:.5f}" for value in values]]
            rows.append([*row, f"{took:.1f}"])
    return table(
        ["state", "smallest element", "W", "of u", "of w", "of s", "of φ", "time [s]"], rows
    )


def main() -> None:
    """Write the page."""
    output = output_file(__doc__)
    lines = heading("Cross-section of a joint", __doc__)
    lines += ["## Joint over clamped strip", "", "Limits of two meshes.", "", *strip_table()]
    lines += ["## Mesh, g = t, rigid scales", ""]
    lines += ["Errors fall with the smallest element: the stress is singular as r^(-1/2).", ""]
    lines += [*mesh_table(), *growth_table()]
    lines += ["## What the section holds, g = t = 0.4 mm", "", *extent_table()]
    lines += ["## Far states by mesh, g = t, rigid scales", "", "In E and t.", "", *state_table()]
    report(lines, output)


if __name__ == "__main__":
    main()
