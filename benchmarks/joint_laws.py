"""Laws of joints that ship with the package: errors of their fits, and what they are like.

    python benchmarks/joint_laws.py [--output FILE] [--make]

Sheets of TPU (Poisson's ratio 0.48) under scales of PETG, 4 mm high, and under rigid ones. Errors
are root mean squares over states that no fit saw, over those of the quantity itself: of the energy,
and of the forces of opening u, shift w and turn φ; the law is exact in the slide s. `--make` solves
the joints that are missing, some minutes each, and writes them into the package.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from report import heading, report, table

import flexscale as fs
from flexscale.arrays import FloatArray
from flexscale.joints.compute import SolvedJoint, compute_joint
from flexscale.joints.key import JointGroove, JointKey, joint_key
from flexscale.joints.storage import SHIPPED, load_joint, write_joint

GAPS, THICKNESSES, HEIGHT = (0.3, 0.4, 0.6, 0.8, 1.0), (0.4, 0.6), 4.0
RIGID = ((0.4, 0.4), (0.6, 0.4), (1.0, 0.4))


def shipped_keys() -> dict[str, JointKey]:
    """All joints that ship, by what they are."""
    keys = {}
    for thickness in THICKNESSES:
        for gap in GAPS:
            name = f"PETG, gap {gap:g}, thickness {thickness:g} mm"
            keys[name] = joint_key(gap, thickness, HEIGHT, fs.TPU, fs.PETG)
    for gap, thickness in RIGID:
        name = f"rigid, gap {gap:g}, thickness {thickness:g} mm"
        keys[name] = joint_key(gap, thickness, HEIGHT, fs.TPU)
    keys["PETG, groove, gap 0.4, thickness 0.4 mm"] = joint_key(
        0.4, 0.4, HEIGHT, fs.TPU, fs.PETG, JointGroove()
    )
    return keys


def make(name: str, key: JointKey) -> SolvedJoint:
    """Solve a joint and write it into the package."""
    start = time.process_time()
    joint = compute_joint(key)
    path = write_joint(joint, SHIPPED)
    print(f"{name}: {time.process_time() - start:.0f} s, {path.name}", file=sys.stderr, flush=True)
    return joint


def poses_in_range(joint: SolvedJoint) -> FloatArray:
    """(n, 4) poses on a grid within the range, without slide."""
    law = joint.law(1.0, 1.0)
    axes = [np.linspace(*law.bounds[i], n) for i, n in ((0, 15), (1, 9), (3, 15))]
    grid = np.stack(np.meshgrid(axes[0], axes[1], [0.0], axes[2], indexing="ij"), axis=-1)
    poses = grid.reshape(-1, 4)
    return poses[law.inside(poses)]


def fit_row(name: str, joint: SolvedJoint) -> list[str]:
    """Errors of a law."""
    errors = [f"{100.0 * joint.errors[k]:.2f} %" for k in (0, 1, 2, 4)]
    size = (SHIPPED / f"joint_{joint.key.digest}.npz").stat().st_size
    missing, n = joint.n_missing, len(joint.poses)
    return [name, f"{n} ({missing})", *errors, f"{size / 1000:.1f} kB"]


def shape_row(name: str, joint: SolvedJoint) -> list[str]:
    """Stiffness of a law, how far the mesh of its states is off, and its curvature."""
    law = joint.law(1.0, 1.0)
    poses = poses_in_range(joint)
    energies, _, tangents = law.evaluate(poses)
    lowest = np.linalg.eigvalsh(tangents)[:, 0]
    at_rest = np.abs(poses / law.bounds[:, 1]).max(axis=1) < 0.35
    k = law.stiffness
    return [
        name,
        *[f"{value:.4f}" for value in (k[0, 0], k[0, 3], k[3, 3], k[1, 1], k[2, 2])],
        f"{100.0 * np.abs(joint.mesh_errors).max():.1f} %",
        f"{energies.min():.1e}",
        f"{lowest.min():.2f} ({100.0 * (lowest < 0.0).mean():.0f} %)",
        f"{lowest[at_rest].min():.3f}",
    ]


def groove_lines(joints: dict[str, SolvedJoint]) -> list[str]:
    """What a groove changes, over the states of the plain joint."""
    plain = joints["PETG, gap 0.4, thickness 0.4 mm"].law(1.0, 1.0)
    grooved = joints["PETG, groove, gap 0.4, thickness 0.4 mm"].law(1.0, 1.0)
    poses = joints["PETG, gap 0.4, thickness 0.4 mm"].poses
    energies, others = plain.evaluate(poses)[0], grooved.evaluate(poses)[0]
    change = np.diag(grooved.stiffness) / np.diag(plain.stiffness) - 1.0
    far = energies > 0.1 * energies.max()
    ratio = others[far] / energies[far] - 1.0
    values = [f"{100.0 * value:+.2f} %" for value in (*change, ratio.min(), ratio.max())]
    head = ["u", "w", "s", "φ", "energy of far states, from", "to"]
    return table(head, [values])


def main() -> None:
    """Write the page; with --make, the laws too."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    parser.add_argument("--make", action="store_true", help="solve the joints that are missing")
    options = parser.parse_args()
    joints = {}
    for name, key in shipped_keys().items():
        found = load_joint(key) if (SHIPPED / f"joint_{key.digest}.npz").exists() else None
        if found is None and options.make:
            found = make(name, key)
        if found is not None:
            joints[name] = found
    lines = heading("Laws of joints", __doc__)
    head = ["joint", "states (not reached)", "W", "of u", "of w", "of φ", "file"]
    lines += ["## Errors over states held out", ""]
    lines += table(head, [fit_row(name, joint) for name, joint in joints.items()])
    lines += [
        "## Stiffness at rest and curvature of W",
        "",
        "In E and t. The mesh of the states is stiffer at rest than the limit, which the law has",
        "as its quadratic part. Second derivatives have a negative eigenvalue, in the share of the",
        "range that is given, because scales turn about the middle of the gap: a turn φ brings the",
        "walls nearer by g (1 - cos φ/2), so that an opened joint has -F g/4 in W's second",
        "derivative by φ, with F the force of u. The solid has the same, and cells add the rest.",
        "",
    ]
    head = [
        "joint",
        "uu",
        "uφ",
        "φφ",
        "ww",
        "ss",
        "mesh",
        "least W",
        "least eigenvalue (share < 0)",
    ]
    head += ["near rest"]
    lines += table(head, [shape_row(name, joint) for name, joint in joints.items()])
    if len(joints) == len(shipped_keys()):
        lines += ["## What the printed groove changes", "", *groove_lines(joints)]
    report(lines, options.output)


if __name__ == "__main__":
    main()
