"""Parts of the documentation that repeat what the code says.

    python docs/generate.py [--check]

Written are docs/reference/experiments.md, docs/reference/datasets.md, and the part of
docs/architecture.md between its two marks. With --check nothing is written, and the exit code is 1
if one of them is out of date.
"""

from __future__ import annotations

import argparse
import ast
import sys
import textwrap
from collections.abc import Iterator
from importlib import util
from pathlib import Path
from types import ModuleType

from flexscale.datasets.schema import SCHEMAS
from flexscale.datasets.variables import SCALARS, Schema, Variable
from flexscale.steps.catalog import FIGURES, STEPS
from flexscale.steps.experiment import ExperimentFile
from flexscale.steps.quantities import UNITS
from flexscale.steps.summary import describe_experiment

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
BEGIN, END = "<!-- generated: floors -->", "<!-- end of generated -->"
SIGNATURE = "Written by `python docs/generate.py` from {}; do not edit."


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """Lines of a Markdown table."""
    cells = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    return [f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *cells)]


def wrapped(text: str) -> list[str]:
    """Lines of a paragraph."""
    return textwrap.wrap(text, 100, break_long_words=False, break_on_hyphens=False)


def code(text: str) -> str:
    return f"`{text}`" if text else ""


# --- docs/reference/experiments.md ----------------------------------------------------------


def field_rows() -> list[list[str]]:
    """Key, unit, default, bounds and meaning of every field, as `flexscale run --fields` has them.

    Its columns begin where those of its heading do.
    """
    heading, *lines = describe_experiment(ExperimentFile).splitlines()
    starts = [heading.index(name) for name in ("key", "unit", "default", "bounds", "meaning")]
    rows = []
    for line in lines:
        if any(line[start - 1] != " " for start in starts[1:]):
            raise SystemExit(f"A column of `flexscale run --fields` is too narrow: {line}")
        ends = [*starts[1:], len(line)]
        rows.append([line[a:b].strip() for a, b in zip(starts, ends, strict=True)])
    return rows


def experiments() -> str:
    """The page of experiment files."""
    rows = field_rows()
    lines = [
        "# Experiment files",
        "",
        SIGNATURE.format("the fields that `flexscale run --fields` prints"),
        "",
        *wrapped(
            "An experiment file is YAML. Only `patterns` is required. NAME stands for a name of "
            "yours. A default of `-` means that nothing stands there. A value is a number in the "
            "unit of its field, or text with another unit (below). Where several numbers are "
            "taken, one number is a series of one, and `{start: 0, stop: 180, step: 15}` is a "
            "range without its end. Unknown keys are errors, and all mistakes of a file are told "
            "before anything is computed."
        ),
        "",
        *wrapped(
            "Every block from `cell` on asks for a [step](../glossary.md); `{}` takes all its "
            "defaults, where none is required. Options of the native model are the blocks `mesh`, "
            "`contact`, `substrate`, `scales` and `solver`; in Python they are those of "
            "`fs.NativeModel`."
        ),
    ]
    for key in dict.fromkeys(row[0].split(".")[0] for row in rows):
        own = next(row for row in rows if row[0] == key)
        lines += ["", f"## `{key}`", "", *wrapped(_sentence(own[4]))]
        if key in STEPS:
            lines += ["", *_of_step(key)]
        fields = [row for row in rows if row[0].startswith(f"{key}.")]
        if fields:
            lines += ["", *table(_FIELD_HEAD, [_field(row) for row in fields])]
        if key == "figures":
            lines += ["", *_figures()]
    lines += ["", "## Units", "", *_units()]
    return "\n".join(lines) + "\n"


_FIELD_HEAD = ["key", "unit", "default", "bounds", "meaning"]


def _field(row: list[str]) -> list[str]:
    key, unit, default, bounds, meaning = row
    return [code(key), unit, code(default) if default != "required" else default, bounds, meaning]


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}." if text else ""


def _of_step(name: str) -> list[str]:
    step = STEPS[name]
    native = ", ".join(code(part) for part in step.native)
    text = f"Makes a dataset of kind [{name}](datasets.md#{name})."
    text += f" Options of the native model in its recipe: {native}."
    if inputs := step.block.model_construct().inputs:  # by its defaults, where they decide
        text += f" Takes the datasets of {', '.join(code(taken) for taken in inputs)}."
    if step.implied:
        text += " It is done, with its defaults, wherever another step takes its dataset."
    return wrapped(text)


def _figures() -> list[str]:
    rows = [
        [code(name), ", ".join(code(need) for need in figure.needs), figure.caption]
        for name, figure in FIGURES.items()
    ]
    return table(["figure", "shows", "caption"], rows)


def _units() -> list[str]:
    rows = [[unit, ", ".join(code(text) for text in texts)] for unit, texts in UNITS.items()]
    return table(["unit of the field", "what may stand behind the number"], rows)


# --- docs/reference/datasets.md -------------------------------------------------------------


def datasets() -> str:
    """The page of dataset kinds."""
    lines = [
        "# Datasets",
        "",
        SIGNATURE.format("`flexscale/datasets/schema.py`"),
        "",
        *wrapped(
            "A dataset is a folder with `data.nc` (netCDF, read as an `xarray.Dataset`) and "
            "`record.json`. Its kind and the version of its schema stand in the attribute "
            "`flexscale_schema`, for instance `sweep/1`. Variables marked *optional* may be "
            "missing. Real values of samples that did not converge are nan; those marked "
            "*partial* may be nan elsewhere too."
        ),
        "",
        "## Of all kinds",
        "",
        "Scalar coordinates, which are also columns of the catalog:",
        "",
        *_variables(SCALARS),
    ]
    for schema in SCHEMAS.values():
        lines += ["", *_of_kind(schema)]
    return "\n".join(lines) + "\n"


def _of_kind(schema: Schema) -> Iterator[str]:
    step = " Made by the step of this name." if schema.kind in STEPS else ""
    yield from (f"## {schema.kind}", "", *wrapped(f"`{schema.name}`: {schema.title}.{step}"))
    for name, variables in (("Coordinates", schema.coordinates), ("Variables", schema.variables)):
        if variables:
            yield from ("", f"{name}:", "", *_variables(variables))


def _variables(variables: tuple[Variable, ...]) -> list[str]:
    head = ["name", "dimensions", "type", "units", "meaning"]
    return table(head, [_variable(item) for item in variables])


def _variable(item: Variable) -> list[str]:
    marks = [name for name in ("optional", "partial") if getattr(item, name)]
    notes = [str(item.attrs[key]) for key in ("method", "comment") if key in item.attrs]
    meaning = "; ".join([item.long_name, *notes])
    if marks:
        meaning += f" (*{', '.join(marks)}*)"
    dims = ", ".join(item.dims) or "scalar"
    return [code(item.name), dims, item.dtype, item.units, meaning]


# --- the floors of docs/architecture.md -----------------------------------------------------


def architecture() -> str:
    """The page of the architecture with its generated part renewed."""
    text = (DOCS / "architecture.md").read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    return before + "\n".join([BEGIN, "", *floors(rules()), "", END]) + after


def rules() -> ModuleType:
    """The test that keeps the floors, loaded from its file."""
    spec = util.spec_from_file_location("floors", ROOT / "tests" / "test_architecture.py")
    assert spec is not None
    assert spec.loader is not None
    module = util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def floors(test: ModuleType) -> Iterator[str]:
    """Drawing and tables of the floors, of the side tower, and of the libraries with one home."""
    yield from ("```", *drawing(test), "```", "", "Rooms, from the roof down:", "")
    order = sorted(test.FLOORS, key=lambda room: (-test.FLOORS[room], room))
    rows = [[str(test.FLOORS[room]), code(room), about(room)] for room in order]
    yield from table(["floor", "room", "what it is"], rows)
    yield from ("", "The side tower, and what each of its rooms may import:", "")
    rows = [[code(room), about(room), _list(test.SIDE[room])] for room in test.SIDE]
    yield from table(["room", "what it is", "may import"], rows)
    yield from ("", "Libraries that few places may import:", "")
    rows = [
        [code(library), _list(homes) or "none: it runs as a program"]
        for library, homes in test.LIBRARY_HOMES.items()
    ]
    yield from table(["library", "imported in"], rows)


def drawing(test: ModuleType) -> Iterator[str]:
    """Floors as lines, the highest first, and what of the side tower they may use."""
    width = 58
    for floor in sorted(set(test.FLOORS.values()), reverse=True):
        rooms = sorted(room for room, at in test.FLOORS.items() if at == floor)
        tower = [room for room in test.SIDE if test.allowed(rooms[0], room)]
        for i, line in enumerate(_lines(rooms, width)):
            label, beside = (" ", "") if i else (str(floor), "  ".join(tower))
            yield f" {label} | {line:<{width}} | {beside}".rstrip()
        yield f"   +{'-' * (width + 2)}+"


def _lines(names: list[str], width: int) -> list[str]:
    lines = [""]
    for name in names:
        longer = f"{lines[-1]}  {name}".strip()
        if len(longer) > width:
            lines.append(name)
        else:
            lines[-1] = longer
    return lines


def about(room: str) -> str:
    """First paragraph of a room's docstring."""
    path = ROOT / "flexscale" / room / "__init__.py"
    path = path if path.is_file() else ROOT / "flexscale" / f"{room}.py"
    doc = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(doc.split("\n\n")[0].split())


def _list(names: object) -> str:
    assert isinstance(names, set)
    return ", ".join(code(name) for name in sorted(names))


PAGES = {
    "reference/experiments.md": experiments,
    "reference/datasets.md": datasets,
    "architecture.md": architecture,
}


def main(arguments: list[str]) -> int:
    """Write what is out of date, or tell it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; 1 if out of date")
    options = parser.parse_args(arguments)
    old = 0
    for name, make in PAGES.items():
        path, text = DOCS / name, make()
        if path.is_file() and path.read_text(encoding="utf-8") == text:
            continue
        old += 1
        if options.check:
            print(f"docs/{name} is out of date: python docs/generate.py", file=sys.stderr)
        else:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
            print(f"docs/{name}")
    return 1 if options.check and old else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
