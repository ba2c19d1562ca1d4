"""Files of `fs.export` for the twelve patterns: CalculiX, the C header and HYLC against ours.

    python benchmarks/exported_files.py [--output FILE]

CalculiX (ccx, Debian's calculix-ccx) bends a cantilever of 60 mm × 20 mm, against our own sheet of
the same A and D, and twists a plate of 60 mm × 60 mm on three corners, against Kirchhoff's: largest
difference anywhere over the largest deflection. "layers": their thickness over that of the sheet.

The C header of the pattern's fit is compiled by cc -O2 and compared with our kernels at 2,000
random curvatures on both sides of contact: largest difference of energy, gradient and Hessian over
the size of each. Times are processor time of one evaluation of all three. HYLC: departure of
energies of single curvatures in all directions from the law, which its form cannot hold.
"""

from __future__ import annotations

import json
import logging
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from ccx_plates import cantilever, twisted_plate
from report import heading, output_file, report, table

import flexscale as fs
from flexscale.exchange.bending import bending_law
from flexscale.exchange.equivalent_layers import find_layers
from flexscale.homogenize.tangent import TangentStiffness

ROOT = Path(__file__).resolve().parents[1]
N_CURVATURES, N_TIMES = 2000, 500
CELLS = (72, 24)  # of a cantilever; with 48 by 16 rhombi are 1.5 % too stiff at their clamped end
MAIN = """#include <stdio.h>
#include <time.h>
#include "law.h"
static double k[{n}][3], g[{n}][3], h[{n}][9], w[{n}];
int main(void) {{
    int i, j, r;
    clock_t start;
    for (i = 0; i < {n}; ++i)
        if (scanf("%lf %lf %lf", k[i], k[i] + 1, k[i] + 2) != 3) return 1;
    start = clock();
    for (r = 0; r < {times}; ++r)
        for (i = 0; i < {n}; ++i) w[i] = {name}_energy(k[i], g[i], h[i]);
    printf("%g\\n", (double)(clock() - start) / CLOCKS_PER_SEC / {n} / {times});
    for (i = 0; i < {n}; ++i) {{
        printf("%.17g", w[i]);
        for (j = 0; j < 3; ++j) printf(" %.17g", g[i][j]);
        for (j = 0; j < 9; ++j) printf(" %.17g", h[i][j]);
        printf("\\n");
    }}
    return 0;
}}
"""


def percent(value: float) -> str:
    return f"{100.0 * value:.2f} %"


def section_row(pattern: str, tangent: TangentStiffness, folder: Path) -> list[str]:
    found, ours = cantilever(tangent, folder, CELLS)
    twisted, expected = twisted_plate(tangent, folder)
    layers = find_layers(tangent.in_plane, tangent.matrix)
    thick = (2.0 * layers.face + layers.core) / fs.named_pattern(pattern).substrate_thickness
    off = np.abs(twisted - expected).max() / np.abs(expected).max()
    return [pattern, f"{thick:.0f}", percent(found / ours - 1.0), percent(float(off))]


def code_row(pattern: str, model: fs.MacroModel, folder: Path) -> list[str]:
    rng = np.random.default_rng(1)
    size = model.largest_curvature * 10.0 ** rng.uniform(-1.5, 0.0, N_CURVATURES)
    k = size[:, None] * rng.standard_normal((N_CURVATURES, 3))
    fs.export(model, to="c-header", path=folder / "law.h", replace=True)
    name = f"flexscale_{model.labels['family']}_{pattern}"
    (folder / "main.c").write_text(MAIN.format(n=N_CURVATURES, times=N_TIMES, name=name))
    subprocess.run(["cc", "-O2", "main.c", "-o", "main", "-lm"], cwd=folder, check=True)
    text = "\n".join(" ".join(map(repr, row)) for row in k.tolist())
    done = subprocess.run([folder / "main"], input=text, capture_output=True, text=True, check=True)
    seconds, *lines = done.stdout.splitlines()
    rows = np.array([[float(word) for word in line.split()] for line in lines])
    states, order = np.zeros((N_CURVATURES, 6)), [3, 5, 4]
    states[:, 3:] = k[:, [0, 2, 1]]
    law = bending_law(model)
    gradient, hessian = law.derivatives(states)
    ours = (
        law.energies(states)[:, None],
        gradient[:, order],
        hessian[:, order][:, :, order].reshape(-1, 9),
    )
    off = [
        np.max(np.abs(found - own).max(axis=1) / np.abs(own).max(axis=1))
        for found, own in zip((rows[:, :1], rows[:, 1:4], rows[:, 4:]), ours, strict=True)
    ]
    path = fs.export(model, to="hylc", path=folder / "hylc.json", replace=True)
    lost = json.loads(path.read_text())["flexscale"]["departure from the law"]
    return [
        pattern,
        *(f"{value:.0e}" for value in off),
        f"{1e6 * float(seconds):.2f}",
        *(f"{100.0 * lost[name]:.0f} %" for name in ("median", "largest")),
    ]


def main() -> None:
    output = output_file(__doc__)
    for program in ("ccx", "cc"):
        if shutil.which(program) is None:
            raise SystemExit(f"exported_files: there is no {program} on this machine.")
    logging.getLogger("flexscale.exchange.hylc").setLevel(logging.ERROR)  # the table says it
    registry = fs.open_registry(ROOT / "results")
    sections, codes = [], []
    with tempfile.TemporaryDirectory() as name:
        for pattern in (item.name for item in fs.named_patterns()):
            wanted = {"pattern": pattern, "source": "reference"}
            flat = registry.one(kind="tangent", **wanted)
            tangent = TangentStiffness(flat["matrix"].values, flat["in_plane"].values)
            sections.append(section_row(pattern, tangent, Path(name)))
            model = fs.MacroModel.from_dataset(registry.one(kind="fit", **wanted))
            codes.append(code_row(pattern, model, Path(name)))
            print(sections[-1], codes[-1], flush=True)
    rows = heading("Exported files", __doc__)
    rows += ["## CalculiX", ""]
    rows += table(["pattern", "layers", "cantilever", "twisted plate"], sections)
    rows += ["## C header and HYLC", ""]
    head = ["pattern", "energy", "gradient", "Hessian", "µs", "HYLC, median", "HYLC, most"]
    report([*rows, *table(head, codes)], output)


if __name__ == "__main__":
    main()
