"""Laws of bending, compared on the same samples of any curvature tensor.

    python benchmarks/laws.py --results DIR [--output FILE] [--patterns NAME …]

Laws are made from shipped sweeps and tangents, and from the tensor sweeps in DIR (`flexscale run
workflows/printed_tensors.yaml --results DIR`), and judged on rays that none has seen: those in the
middle between the directions and shapes of the tensor sweep, at 20 curvatures up to its last. A law
that is added to benchmarks/compared_laws is compared as well.

Errors are those of energies, |W/W0 - 1|, as median / 95 % / worst in %; before and in contact, by
whether native scales touch. Times are of energy, gradient and Hessian of one state, on one core.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import xarray as xr
from compared_laws import ComparedLaw, LawData, all_laws
from report import heading, report, table

import flexscale as fs
from flexscale.macro.tensor_samples import TensorSamples, read_tensor_samples
from flexscale.mechanics.sheet_law import SheetLaw

SHIPPED = Path(__file__).resolve().parents[1] / "results"
DIRECTIONS = [5.0 + 20.0 * k for k in range(9)]
SHAPES = [-130.5 + 18.0 * k for k in range(10)]
#: Degrees of shape between which rays are counted as one kind.
KINDS = {
    "opening domes": (-135.0, -100.0),
    "opening cylinders": (-100.0, -70.0),
    "saddles": (-70.0, -15.0),
    "closing cylinders": (-15.0, 15.0),
    "closing domes": (15.0, 45.0),
}


def states_of(samples: TensorSamples) -> np.ndarray:
    """(p, 6) states of a sheet law."""
    states = np.zeros((len(samples), 6))
    states[:, 3:] = samples.tensors.reshape(-1, 4)[:, [0, 1, 3]]
    return states


def energy_errors(law: SheetLaw, samples: TensorSamples) -> np.ndarray:
    """(p,) absolute and relative."""
    return np.abs(law.energies(states_of(samples)) / samples.energies - 1.0)


def microseconds(law: SheetLaw, samples: TensorSamples) -> float:
    """Processor time of energy, gradient and Hessian of a state; the best of three."""
    states = states_of(samples)
    found = []
    for _ in range(4):
        start = time.process_time()
        law.derivatives(states)
        found.append((time.process_time() - start) / len(states))
    return 1e6 * min(found)


def told(errors: np.ndarray) -> str:
    """Median / 95 % / worst, in %."""
    if not len(errors):
        return "–"
    values = 100.0 * np.array([np.median(errors), np.quantile(errors, 0.95), errors.max()])
    return " / ".join(f"{value:.2g}" if value < 100.0 else f"{value:.0f}" for value in values)


def shapes_of(samples: TensorSamples) -> np.ndarray:
    """(p,) degree."""
    principal = np.linalg.eigvalsh(samples.tensors)
    return np.degrees(np.arctan2(principal[:, 0], principal[:, 1]))


def compare(
    laws: list[ComparedLaw], data: LawData, unseen: TensorSamples
) -> tuple[list[list[str]], list[np.ndarray]]:
    """Rows of a pattern, and errors of each law."""
    rows, errors = [], []
    name = str(data.sweep["pattern"].values)
    for law in laws:
        start = time.process_time()
        made = law.make(data).sheet_law()
        seconds = time.process_time() - start
        off = energy_errors(made, unseen)
        errors.append(off)
        before, after = off[~unseen.touches], off[unseen.touches]
        cost = microseconds(made, unseen)
        rows.append([name, law.name, told(before), told(after), f"{cost:.1f}", f"{seconds:.1f}"])
        print(*rows[-1], sep="  ", file=sys.stderr, flush=True)
    return rows, errors


def unseen_rays(pattern: fs.Pattern, sweep: xr.Dataset) -> TensorSamples:
    """Samples between those of the tensor sweep."""
    last = float(sweep["curvature"].max())
    curvatures = [last * k / 20.0 for k in range(21)]
    return read_tensor_samples(fs.tensor_sweep(pattern, DIRECTIONS, SHAPES, curvatures, workers=1))


def main() -> None:
    """All of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=Path, required=True)
    parser.add_argument("--output", type=Path)
    parser.add_argument("--patterns", nargs="*", default=[p.name for p in fs.named_patterns()])
    given = parser.parse_args()
    shipped, registry = fs.open_registry(SHIPPED), fs.open_registry(given.results)
    laws = all_laws()
    rows: list[list[str]] = []
    by_kind: dict[str, list[list[np.ndarray]]] = {kind: [[] for _ in laws] for kind in KINDS}
    for name in given.patterns:
        pattern = fs.named_pattern(name)
        rest = (shipped.one(kind=kind, pattern=name) for kind in ("sweep", "tangent"))
        data = LawData(pattern, *rest, registry.one(kind="tensor_sweep", pattern=name))
        unseen = unseen_rays(pattern, data.tensor_sweep)
        found, errors = compare(laws, data, unseen)
        rows += found
        shapes = shapes_of(unseen)
        for kind, (low, high) in KINDS.items():
            chosen = (shapes >= low) & (shapes < high)
            for k, off in enumerate(errors):
                by_kind[kind][k].append(off[chosen])
    lines = heading("Laws of bending, compared", __doc__ or "")
    lines += ["## Laws", "", *table(["law", "what"], [[law.name, law.what] for law in laws]), ""]
    head = ["pattern", "law", "before contact, %", "in contact, %", "µs", "made in, s"]
    lines += ["## Every pattern", "", *table(head, rows), ""]
    kinds_rows = [
        [kind, *(told(np.concatenate(off)) for off in of_laws)] for kind, of_laws in by_kind.items()
    ]
    lines += ["## By shape, all patterns", ""]
    lines += table(["shape", *(f"{law.name}, %" for law in laws)], kinds_rows)
    report(lines, given.output)


if __name__ == "__main__":
    main()
