"""Scales on bent sheets of 100 x 50 mm: overlap before and after it is removed, motion and time.

    python benchmarks/synthesis.py --results DIR [--output FILE]

Sheets are those of the models that `flexscale run` has fitted in DIR, with smooth triangles of 5
mm, closing along 0° of the pattern. Depths: per pair of scales, the smallest translation that parts
two of their convex parts, the deepest of these. Motion counts from where each scale follows the
sheet best: root of the mean, over the scales, of the mean square displacement of a scale's points,
and the farthest that any point goes. Turning weighs 1 where it counts by how far it moves points,
and 30 where scales are to stay flatter on the sheet. The second curvature is the largest principal
one, at the free edges, where sheets leave the cylinder. Times are of one core, without the sheet's
own simulation.
"""

from __future__ import annotations

import time

from report import datasets_and_output, heading, report

import flexscale as fs

PATTERNS = ("square", "hexagon", "chevron", "arrowhead")
CURVATURES = (0.0125, 0.02)
WEIGHTS = (1.0, 30.0)
HEAD = (
    "| pattern | curvature [/mm] | largest in the sheet [/mm] | scales | pairs that overlap "
    "| deepest before [mm] | turning weighs | deepest after [mm] | rms motion [mm] "
    "| largest motion [mm] | largest turn [°] | iterations | placing alone [s] | both [s] |"
)


def timed(pattern: fs.Pattern, sheet, **options) -> tuple[fs.ScaledSheet, float]:
    """Scales on a sheet, and seconds."""
    start = time.perf_counter()
    scaled = fs.synthesize_scales(pattern, sheet, **options)
    return scaled, time.perf_counter() - start


def rows_of(name: str, model: fs.MacroModel, curvature: float) -> list[str]:
    """One row for each weight of turning."""
    pattern = fs.named_pattern(name)
    sheet = fs.simulate_sheet(model, length=100.0, width=50.0, curvature=curvature)
    _, placing = timed(pattern, sheet, remove_overlap=False)
    rows = []
    for weight in WEIGHTS:
        scaled, both = timed(pattern, sheet, turn_weight=weight)
        cells = [
            name, f"{curvature:g}", f"{sheet.largest_curvature:.4f}", str(scaled.n_scales),
            str(len(scaled.overlap_before.pairs)), f"{scaled.overlap_before.deepest:.3f}",
            f"{weight:g}", f"{scaled.overlap.deepest:.3f}", f"{scaled.rms_motion:.3f}",
            f"{scaled.largest_motion:.3f}", f"{scaled.largest_turn:.1f}",
            str(scaled.iterations), f"{placing:.2f}", f"{both:.2f}",
        ]  # fmt: skip
        rows.append(f"| {' | '.join(cells)} |")
    return rows


def main() -> None:
    """All four patterns at both curvatures."""
    registry, output = datasets_and_output(__doc__ or "")
    rows = heading("Scales on bent sheets", __doc__ or "")
    rows += [HEAD, "|" + "---|" * 14]
    for name in PATTERNS:
        entry = next(iter(registry.find(kind="fit", pattern=name)))
        model = fs.MacroModel.from_dataset(registry.load(entry))
        for curvature in CURVATURES:
            rows += rows_of(name, model, curvature)
    report(rows, output)


if __name__ == "__main__":
    main()
