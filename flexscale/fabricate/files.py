"""The files of a printable sheet: STL, 3MF, preview, figures as text and as JSON.

Everything is made before the first file is written, every file appears whole or not at all, and the
JSON, which knows the others by their digests, goes first and comes last: with it, a set is complete
and of one piece.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from flexscale.datasets.identity import Recipe, canonical_json
from flexscale.datasets.provenance import code_version
from flexscale.datasets.staging import require_free, write_atomically
from flexscale.errors import BadInputError
from flexscale.fabricate.layout import Layout
from flexscale.fabricate.preview import sheet_picture
from flexscale.fabricate.report import report_lines
from flexscale.fabricate.shapes import Shape
from flexscale.fabricate.sheet import PrintableSheet, sheet_figures
from flexscale.fabricate.stl import stl_bytes
from flexscale.fabricate.threemf import PrintMaterial, threemf_bytes
from flexscale.patterns import PETG, TPU, NeoHookean, Pattern
from flexscale.plotting.picture_file import picture_bytes
from flexscale.plotting.printable import printable
from flexscale.plotting.style import SCALE_COLOR, SUBSTRATE_COLOR

ENDINGS = ("-substrate.stl", "-scales.stl", ".txt", ".3mf", ".png", ".json")
STEP, VERSION = "fabricate", 2  # raised whenever the solids of equal options change


def pattern_digest(pattern: Pattern) -> str:
    """Sha256 of what defines a pattern: of `recipe.parameters.pattern` in all of its datasets."""
    return hashlib.sha256(canonical_json(pattern.to_config()).encode()).hexdigest()


def sheet_name(pattern: Pattern, shape: Shape, layout: Layout) -> str:
    """Name of the files of a sheet, for instance "hexagon-rectangle-100x50-30deg"."""
    turned = f"-{layout.direction:g}deg" if layout.direction else ""
    return f"{pattern.name}-{shape.name}{turned}"


def require_room(folder: Path, name: str, replace: bool) -> None:
    """Refuse a folder that is not there, or has files of a sheet of this name.

    Raises
    ------
    BadInputError : there is no such folder, or files that may not be replaced.
    """
    if not folder.is_dir():
        raise BadInputError(f"There is no folder {folder}: create it, or name another one.")
    require_free([folder / f"{name}{ending}" for ending in ENDINGS], replace)


def write_sheet(
    sheet: PrintableSheet,
    folder: Path,
    dataset: Mapping[str, str] | None = None,
    *,
    replace: bool = False,
) -> list[Path]:
    """Write all files of a sheet.

    Parameters
    ----------
    folder : an existing folder.
    dataset : "id" and "recipe_digest" of the pattern's cell dataset, for the record.
    replace : whether files of the same names may be written over.

    Returns
    -------
    Paths: two STL files, the figures, the 3MF, the preview, and last the JSON.

    Raises
    ------
    BadInputError : there is no such folder, it cannot be written to, or it has files of these
        names.
    """
    name = sheet_name(sheet.pattern, sheet.shape, sheet.layout)
    require_room(folder, name, replace)
    identity = sheet_identity(sheet, dataset)
    contents = _contents(sheet, name, identity)
    record = {
        "title": name,
        **identity,
        "pattern": sheet.pattern.to_config(),
        "options": sheet.to_config(),
        "materials": {solid: material.name for solid, material in _materials(sheet).items()},
        "figures": sheet_figures(sheet),
        "files": {
            file: {"sha256": hashlib.sha256(data).hexdigest(), "bytes": len(data)}
            for file, data in contents.items()
        },
    }
    text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    contents[f"{name}.json"] = text.encode()
    try:
        (folder / f"{name}.json").unlink(missing_ok=True)
        for file, data in contents.items():
            write_atomically(folder / file, partial(Path.write_bytes, data=data))
    except OSError as error:
        raise BadInputError(
            f"{name} cannot be written to {folder}: {error.strerror}. Free space there, or name "
            "another folder."
        ) from error
    return [folder / file for file in contents]


def sheet_identity(
    sheet: PrintableSheet, dataset: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Where a sheet comes from, in texts: as the 3MF and the JSON carry it."""
    parameters = {"pattern": sheet.pattern.to_config(), **sheet.to_config()}
    code = code_version()
    identity = {
        "pattern_digest": pattern_digest(sheet.pattern),
        "recipe_digest": Recipe(STEP, VERSION, parameters).digest(),
        "flexscale": f"{code.version} {code.commit}{' (changed)' if code.dirty else ''}".strip(),
    }
    if dataset is not None:
        identity |= {"dataset": dataset["id"], "dataset_recipe_digest": dataset["recipe_digest"]}
    return identity


def _contents(sheet: PrintableSheet, name: str, identity: Mapping[str, str]) -> dict[str, bytes]:
    """Bytes of each file but the JSON, by its name."""
    title = f"flexscale {name} {identity['pattern_digest'][:12]}"
    materials = _materials(sheet)
    parts = [(solid, materials[solid.name]) for solid in sheet.solids]
    metadata = {
        **identity,
        "pattern": canonical_json(sheet.pattern.to_config()),
        "options": canonical_json(sheet.to_config()),
    }
    source = identity.get("dataset", f"digest {identity['pattern_digest'][:12]}")
    remark = f"Outlines of {source}; all walls are vertical."
    preview = printable(sheet_picture(sheet, remark))
    figures = "\n".join([title, "", *report_lines(sheet), ""])
    return {
        **{f"{name}-{solid.name}.stl": stl_bytes(solid, title) for solid in sheet.solids},
        f"{name}.txt": figures.encode(),
        f"{name}.3mf": threemf_bytes(parts, name, metadata),
        f"{name}.png": picture_bytes(preview, "png"),
    }


def _materials(sheet: PrintableSheet) -> dict[str, PrintMaterial]:
    pattern = sheet.pattern
    return {
        "substrate": PrintMaterial(_material_name(pattern.substrate_material), SUBSTRATE_COLOR),
        "scales": PrintMaterial(_material_name(pattern.scale_material), SCALE_COLOR),
    }


def _material_name(material: NeoHookean) -> str:
    """PETG or TPU, or what is known of another material."""
    for name, known in (("PETG", PETG), ("TPU", TPU)):
        if material == known:
            return name
    return f"E {material.young_modulus:g} MPa, nu {material.poisson_ratio:g}"
