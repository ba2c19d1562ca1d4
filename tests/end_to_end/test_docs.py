"""The documentation says what the code says: generated parts, names of functions and tests, links,
and the numbers of the sample that is followed."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import flexscale as fs
from tests.shipped import ROOT

DOCS = sorted((ROOT / "docs").rglob("*.md"))
PAGES = [*DOCS, *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"))]
TEXTS = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in PAGES}
#: `module:name`, the module with or without the package's name; ids of datasets have no dot.
FUNCTION = re.compile(r"`((?:\w+\.)+\w+):((?:\w+\.)?\w+)`")
TEST = re.compile(r"`(?:tests/)?(\w+/\w+\.py)::(\w+)`")
BENCHMARKS = ROOT / "results" / "reference" / "benchmarks"


@cache
def defined(path: Path) -> dict[str, set[str]]:
    """Names that a module defines -> names that these define themselves."""
    body = ast.parse(path.read_text(encoding="utf-8")).body
    return {name: set(_names(node)) for node in body for name in _of(node)}


def _names(node: ast.AST) -> list[str]:
    return [name for inner in getattr(node, "body", []) for name in _of(inner)]


def _of(node: ast.AST) -> list[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    targets = getattr(node, "targets", [getattr(node, "target", None)])
    return [target.id for target in targets if isinstance(target, ast.Name)]


def is_there(module: str, name: str) -> bool:
    """Whether a function, a class, a method, or a field is where a page says it is."""
    parts = module.removeprefix("flexscale.").split(".")
    path = ROOT.joinpath("flexscale", *parts).with_suffix(".py")
    outer, _, inner = name.partition(".")
    if not path.is_file() or outer not in defined(path):
        return False
    return not inner or inner in defined(path)[outer]


def test_generated_pages_are_up_to_date() -> None:
    command = [sys.executable, "docs/generate.py", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("page", TEXTS)
def test_functions_that_a_page_names_exist(page: str) -> None:
    missing = [f"{m}:{n}" for m, n in FUNCTION.findall(TEXTS[page]) if not is_there(m, n)]
    assert missing == []


@pytest.mark.parametrize("page", TEXTS)
def test_tests_that_a_page_names_exist(page: str) -> None:
    missing = [
        f"{file}::{name}"
        for file, name in TEST.findall(TEXTS[page])
        if not (ROOT / "tests" / file).is_file() or name not in defined(ROOT / "tests" / file)
    ]
    assert missing == []


def test_every_equation_has_a_function_and_a_test() -> None:
    rows = [
        [cell.strip() for cell in line.strip("|").split(" | ")]
        for line in TEXTS["docs/equations.md"].splitlines()
        if line.startswith("| ") and "---" not in line
    ]
    rows = [row for row in rows if row[-1] != "test"]
    assert len(rows) > 50
    for *_, function, test in rows:
        assert FUNCTION.fullmatch(function), function
        assert TEST.fullmatch(test), test
    numbers = set(re.findall(r"\d+", " ".join(row[0] for row in rows if row[0][0].isdigit())))
    assert numbers >= {str(number) for number in range(1, 20)} - {"17", "18"}


def test_glossary_has_every_term_once() -> None:
    rows = re.findall(r"^\| ([^|]+) \|", TEXTS["docs/glossary.md"], re.MULTILINE)
    terms = [row for row in rows if row not in ("term", "---")]
    assert len(terms) == len(set(terms)) > 80
    wanted = {"scale", "tile", "gap", "bond", "closing", "opening", "direction", "side", "sample"}
    wanted |= {"line", "sheet", "native model", "macro model", "shell", "substrate", "fit", "kind"}
    wanted |= {"gap model", "tangent", "onset", "step", "recipe", "dataset", "digest", "layer"}
    assert wanted <= set(terms)


def test_a_name_that_is_nowhere_is_noticed() -> None:
    assert is_there("solve.newton", "solve_equilibrium")
    assert is_there("flexscale.homogenize.cell_problem", "BentCell.moment")
    assert is_there("datasets.schema", "SCHEMAS")
    assert not is_there("solve.newton", "solve_nothing")
    assert not is_there("solve.nowhere", "solve_equilibrium")
    assert not is_there("homogenize.cell_problem", "BentCell.nothing")


@pytest.mark.parametrize("page", TEXTS)
def test_links_and_pages_are_there(page: str) -> None:
    folder = (ROOT / page).parent
    for link in re.findall(r"\]\(([^)]+)\)", TEXTS[page]):
        if not link.startswith("https://"):
            assert (folder / link.split("#")[0]).exists(), link
    for name in re.findall(r"`([a-z_]+\.md)`", TEXTS[page]):
        assert (BENCHMARKS / name).is_file(), name


def test_every_page_is_reached_from_readme() -> None:
    linked = re.findall(r"\]\((?:\./)?([^)]+\.md)\)", TEXTS["README.md"])
    assert {*linked, "README.md"} == set(TEXTS)


@pytest.mark.parametrize("page", TEXTS)
def test_lines_are_short_but_for_tables(page: str) -> None:
    lines = TEXTS[page].splitlines()
    assert [line for line in lines if len(line) > 110 and not line.startswith("|")] == []


def test_validation_names_pages_with_their_commits() -> None:
    """A number without the commit that it is of would pass for one of the present code."""
    text = TEXTS["docs/validation.md"]
    found = re.findall(r"`([a-z_]+\.md)`,\s+(\w{7})\b", text)
    assert len(found) == len(re.findall(r"`[a-z_]+\.md`", text)) > 25
    for name, commit in found:
        signed = re.search(r", commit (\w+), sources", (BENCHMARKS / name).read_text())
        assert signed is None or signed[1] == commit, name


def test_numbers_of_the_journey_are_those_stored(shipped_results: Path) -> None:
    text = TEXTS["docs/journey.md"]
    registry = fs.open_registry(shipped_results)
    dataset = registry.load(re.findall(r"`(sweep:[0-9a-f]{12})`", text)[0])
    rows = re.findall(r"\| `(\w+)` \| ([\d.]+) \| (\S+(?: \S+)?) \|", text)
    assert len(rows) == 8
    for name, value, units in rows:
        stored = dataset.fs.sample(name, side="closing", direction=30, curvature=0.01)
        assert float(stored) == pytest.approx(float(value), rel=5e-4), name
        assert stored.attrs["units"] == units
