"""`flexscale export`: stiffness and laws of datasets, as files that other simulators read."""

from __future__ import annotations

import sys
from pathlib import Path

from flexscale.exchange.formats import FORMATS

HELP = "Write a dataset's stiffness or law for another simulator (docs/export.md), print its path."


def export_dataset(
    identifier: str, to: str, output: Path | None, results: Path, *, replace: bool
) -> None:
    """Export a dataset of the registry; its file is named after it unless `output` names one."""
    from flexscale.checks import require_choice
    from flexscale.datasets.export import file_stem
    from flexscale.datasets.registry import open_registry
    from flexscale.exchange.export import export

    require_choice(to, "format to export to", FORMATS)
    registry = open_registry(results)
    entry = registry.get(identifier)
    path = output or Path(f"{file_stem(entry)}_{to}{FORMATS[to].suffix}")
    written = export(registry.load(entry), to=to, path=path, replace=replace)
    sys.stdout.write(f"{written}\n")
