"""Registry of many datasets: times of opening it, of queries, of one dataset, and of publishing.

    python benchmarks/registry.py [--number 10000] [--output FILE]

Small sweeps are published one by one in a temporary folder, each checked, written, read back and
moved to its place as any result is. Publishing brings the catalog up to date, which takes longer
the more there are; so that ten thousand take minutes and not hours, they are published in folders
of a hundred and then moved into one, whose catalog is built from them. At each number of datasets:
`open` lists the folders and reads the catalog; `rebuild` reads every record, as after the catalog
was lost; `find` asks for a family and a range of gaps; `one` also loads the file and verifies it;
`table` is the pandas table of all; `publish` adds one more dataset. Best of five, but `rebuild` and
`publish` once; wall time.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr
from report import report

import flexscale as fs
from flexscale.datasets.identity import Recipe
from flexscale.datasets.kinds.sweep import build_sweep_dataset
from flexscale.datasets.store import Store

BATCH = 100
N_FAMILIES = 93
ALLOWED_MS = 50.0


def small_sweep(index: int) -> xr.Dataset:
    """A valid sweep of 2 directions and 3 curvatures; its gap and family tell it from others."""
    curvatures, stiffness = np.array([0.0, 0.01, 0.02]), 100.0 + index
    shape = (1, 2, 3)
    energy = np.broadcast_to(0.5 * stiffness * curvatures**2, shape)
    arrays = {
        "energy_density": energy,
        "energy_density_membrane": 0.5 * energy,
        "energy_density_bending": 0.5 * energy,
        "energy_density_scales": 0.0 * energy,
        "moment": np.broadcast_to(stiffness * curvatures, shape),
        "stretch": np.broadcast_to([1.0, 1.0, 0.0], (*shape, 3)),
        "newton_iterations": np.full(shape, 3),
        "negative_eigenvalues": np.zeros(shape, dtype=int),
        "residual_norm": np.zeros(shape),
        "mean_offset": np.zeros(shape),
        "status": np.zeros(shape, dtype=int),
    }
    family = f"IH{index % N_FAMILIES + 1:02d}"
    scalars = {"family": family, "pattern": f"{family}_{index}", "gap": 0.2 + 0.6e-4 * index}
    return build_sweep_dataset(
        ["closing"], np.array([0.0, 90.0]), curvatures, arrays, scalars=scalars, config={}
    )


def publish(store: Store, index: int) -> float:
    """Seconds to publish one more dataset."""
    dataset, recipe = small_sweep(index), Recipe("synthetic", 1, {"index": index})
    start = time.perf_counter()
    store.publish(dataset, "sweep", recipe)
    return time.perf_counter() - start


def fill(root: Path, start: int, stop: int) -> None:
    """Publish the datasets of a range and move them into `root`; its catalog stays as it was."""
    for first in range(start, stop, BATCH):
        with tempfile.TemporaryDirectory(dir=root.parent) as batch:
            store = Store(batch)
            for index in range(first, min(first + BATCH, stop)):
                publish(store, index)
            for folder in store.local.glob("*/*/*/*/"):
                target = root / "local" / folder.relative_to(store.local)
                target.parent.mkdir(parents=True, exist_ok=True)
                folder.rename(target)
        print(f"{min(first + BATCH, stop)} datasets", file=sys.stderr, flush=True)


def best(action: Callable[[], object], repeat: int = 5) -> float:
    """Least milliseconds of an action."""
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def row(root: Path, number: int) -> tuple[str, float]:
    """Row of the table for a folder that holds so many datasets, and the time of `find` in ms."""
    rebuild = best(lambda: fs.open_registry(root).reindex(), repeat=1)
    registry = fs.open_registry(root)
    assert len(registry) == number
    criteria = {"kind": "sweep", "family": "IH20", "gap": fs.between(0.2, 0.5, "mm")}
    times = {
        "open": best(lambda: fs.open_registry(root)),
        "rebuild": rebuild,
        "find": best(lambda: registry.find(**criteria)),
        "one": best(lambda: registry.one(pattern="IH20_19")),
        "table": best(registry.table),
        "publish": 1e3 * publish(Store(root), number),
    }
    size = (root / "local" / "catalog.csv").stat().st_size / 2**20
    cells = [f"{number}", *(f"{value:.3g}" for value in times.values()), f"{size:.2f}"]
    return f"| {' | '.join(cells)} |", times["find"]


def main() -> None:
    """Numbers of datasets up to the one asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--number", type=int, default=10_000, help="datasets in all")
    parser.add_argument("--output", type=Path, help="write the table to this Markdown file too")
    arguments = parser.parse_args()
    numbers = [n for n in (100, 1_000, 10_000) if n < arguments.number] + [arguments.number]
    rows = ["# Registry of many datasets", "", (__doc__ or "").split("\n\n", 2)[2].strip(), ""]
    rows += ["| datasets | open | rebuild | find | one | table | publish | catalog |"]
    rows += ["|---|---|---|---|---|---|---|---|", "| | ms | ms | ms | ms | ms | ms | MiB |"]
    with tempfile.TemporaryDirectory() as folder:
        root, there = Path(folder) / "results", 0
        root.mkdir()
        start = time.perf_counter()
        for number in numbers:
            fill(root, there, number)
            text, find = row(root, number)
            rows.append(text)
            there = number + 1  # `publish` has added one
        seconds = time.perf_counter() - start
    verdict = "within" if find <= ALLOWED_MS else "beyond"
    rows += [
        "",
        f"Making and measuring them took {seconds:.0f} s. `find` among {numbers[-1]} takes",
    ]
    rows[-1] += f" {find:.2g} ms, {verdict} the {ALLOWED_MS:g} ms allowed."
    report(rows, arguments.output)


if __name__ == "__main__":
    main()
