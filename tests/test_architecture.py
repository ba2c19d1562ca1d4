"""A module of flexscale imports only from floors below its own, function-level imports included."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "flexscale"

FLOORS = {
    "arrays": 0,
    "errors": 0,
    "sides": 0,
    "units": 0,
    "checks": 0,
    "names": 0,
    "short_repr": 0,
    "status": 0,
    "simplices": 0,
    "kernel_cache": 0,
    "processes": 0,
    "system_failures": 0,
    "gmsh_library": 0,
    "tilings": 1,
    "patterns": 2,
    "mesh": 3,
    "mechanics": 3,
    "embedding": 4,
    "solve": 4,
    "joints": 5,
    "homogenize": 6,
    "macro": 7,
    "sheets": 7,
    "finite": 7,
    "fabricate": 7,
    "exchange": 8,
    "synthesis": 8,
    "steps": 9,
    "cli": 10,
}
#: The side tower: what each of its rooms may use. The floors from 6 on may use all of it.
_GROUND = {"arrays", "errors", "sides", "units", "checks", "names", "status"}
SIDE = {
    "datasets": _GROUND,
    "findings": _GROUND | {"datasets"},
    "plotting": _GROUND | {"datasets"},
}
#: Libraries that few rooms or files may import; the workflow engine only ever runs as a program.
LIBRARY_HOMES: dict[str, set[str]] = {
    "gmsh": {"gmsh_library.py"},
    "snakemake": set(),
    "pypardiso": {"solve"},
    "ipctk": {"mechanics"},
    "manifold3d": {"fabricate", "mesh/prism_surface.py"},
    "pydantic": {"steps", "datasets/record.py"},
    "h5py": {"datasets/containers.py", "datasets/container_attributes.py"},
    "typer": {"cli"},
    "rich": {"cli"},
    "matplotlib": {"plotting"},
}


def room_of(module: str) -> str | None:
    """Room of a dotted name ("flexscale.mesh.torus" -> "mesh"), None outside of flexscale."""
    parts = module.split(".")
    if parts[0] != "flexscale":
        return None
    return parts[1] if len(parts) > 1 else "flexscale"


def imports_of(tree: ast.AST, package: str) -> list[tuple[int, str]]:
    """All (line, dotted name) a module imports, at any depth, relative imports resolved."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package.split(".")[: len(package.split(".")) + 1 - node.level]
            module = ".".join([*base, node.module] if node.module else base)
            module = module if node.level else (node.module or "")
            # "from flexscale import mesh" names a room, "from flexscale.mesh import x" does not.
            names = [alias.name for alias in node.names]
            found += [
                (node.lineno, f"{module}.{name}" if module == "flexscale" else module)
                for name in names
            ]
    return found


def allowed(room: str, target: str) -> bool:
    """Whether a module of `room` may import from `target` (both first-level names)."""
    if room == target or target == "__version__":
        return True
    if room in SIDE:
        return target in SIDE[room]
    if target in SIDE:
        return FLOORS[room] >= 6
    ground = FLOORS[room] == 0 == FLOORS.get(target)
    return ground or (target in FLOORS and FLOORS[target] < FLOORS[room])


def runtime_imports(path: Path) -> set[str]:
    """Modules of flexscale that a module imports when it runs, at any depth."""
    tree = ast.parse(path.read_text())
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            node.body = [ast.Pass()]
    parts = ["flexscale", *path.relative_to(PACKAGE).parent.parts]
    found = set()
    for _, name in imports_of(tree, ".".join(parts)):
        file = PACKAGE.joinpath(*name.split(".")[1:])
        if name.startswith("flexscale.") and file.with_suffix(".py").is_file():
            found.add(name)
    return found


def test_no_modules_import_one_another_in_a_circle() -> None:
    graph = {
        ".".join(("flexscale", *path.relative_to(PACKAGE).with_suffix("").parts)): runtime_imports(
            path
        )
        for path in PACKAGE.rglob("*.py")
        if path.name != "__init__.py"
    }
    while leaves := {name for name, targets in graph.items() if not targets & graph.keys()}:
        for name in leaves:
            del graph[name]
    assert not graph, "each of these imports another of these"


def violations(source: str, path: str) -> list[str]:
    """Sentences about every forbidden import of one module; `path` relative to flexscale/."""
    room = path.split("/")[0].removesuffix(".py")
    package = ".".join(["flexscale", *path.split("/")[:-1]])
    bad = []
    for line, module in imports_of(ast.parse(source), package):
        target = room_of(module)
        if target is not None and not allowed(room, target):
            bad.append(f"flexscale/{path}:{line} imports {module}: upward or sideways")
        homes = LIBRARY_HOMES.get(module.split(".")[0])
        if homes is not None and room not in homes and path not in homes:
            bad.append(f"flexscale/{path}:{line} imports {module}: not its home")
    return bad


def modules() -> list[str]:
    """Every module but the roof, flexscale/__init__.py, which only lists lazy names."""
    paths = (path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py"))
    return sorted(path for path in paths if path != "__init__.py")


@pytest.mark.parametrize("path", modules())
def test_imports_only_from_lower_floors(path: str) -> None:
    assert violations((PACKAGE / path).read_text(), path) == []


def test_every_room_has_a_floor() -> None:
    rooms = {path.split("/")[0].removesuffix(".py") for path in modules()}
    assert rooms <= FLOORS.keys() | SIDE.keys()


@pytest.mark.parametrize(
    ("path", "source"),
    [
        ("mesh/torus.py", "from flexscale.homogenize import sweep"),
        ("mesh/torus.py", "def f():\n    from flexscale.steps.plan import build_plan"),
        ("mesh/torus.py", "import flexscale.mechanics.hct"),
        ("mesh/torus.py", "from ..solve import newton"),
        ("mesh/torus.py", "from flexscale import cli"),
        ("mesh/torus.py", "import flexscale as fs"),
        ("mesh/torus.py", "from flexscale.datasets import store"),
        ("mesh/torus.py", "import gmsh"),
        ("datasets/store.py", "from flexscale.mesh.options import MeshOptions"),
        ("plotting/scene.py", "from flexscale.patterns import Pattern"),
        ("errors.py", "from flexscale.tilings import families"),
        ("solve/newton.py", "from flexscale.embedding.cell import Cell"),
    ],
)
def test_guard_sees_a_forbidden_import(path: str, source: str) -> None:
    assert len(violations(source, path)) == 1


def test_light_rooms_stay_light() -> None:
    """Reading datasets and asking for help never load the heavy libraries."""
    code = (
        "import sys, flexscale, flexscale.cli.main\n"
        "heavy = {'numpy', 'gmsh', 'numba', 'xarray', 'matplotlib', 'snakemake', 'pydantic'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
