"""Every validation page, made where it is missing or older than the code it speaks of.

    python benchmarks/validate.py [PAGE …] [--results DIR] [--dry-run]

`make validate` calls this. Each benchmark writes one page of results/reference/benchmarks; a line
at its end has the commit, the time it took, and a digest of the sources that its numbers depend on.
A page whose digest is still right is not made again, so that an interrupted run goes on where it
stopped; README.md beside the pages lists them all. Benchmarks of sweeps take those of DIR, after
running workflows/named_patterns.yaml there to its end; full characterizations go to a folder beside
DIR. All of it takes hours on two cores.
"""

from __future__ import annotations

import argparse
import ast
import functools
import hashlib
import re
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from flexscale import PUBLIC_HOMES
from flexscale.steps.catalog import STEPS

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "results" / "reference" / "benchmarks"
FOOTER = re.compile(r"\n\*Made by `(.+)` in (\d+) s, commit (\w+), sources (\w+)\.\*\n?$")


@dataclass(frozen=True)
class Page:
    """A benchmark, and what it reads besides what it imports.

    Attributes
    ----------
    reads : the workflow whose sweeps it reads.
    runs : whether it runs the command line, and so depends on the whole package.
    own_output : it keeps its own results, and takes no --output.
    """

    name: str
    reads: str = ""
    runs: bool = False
    own_output: bool = False

    @property
    def script(self) -> Path:
        """The benchmark."""
        return ROOT / "benchmarks" / f"{self.name}.py"

    @property
    def path(self) -> Path:
        """The page."""
        return PAGES / f"{self.name}.md"

    def summary(self) -> str:
        """First line of the benchmark's docstring."""
        return (ast.get_docstring(ast.parse(self.script.read_text())) or "").splitlines()[0]

    def sources(self) -> str:
        """Digest of what its numbers depend on: the code, docstrings and comments apart, of all
        modules that it imports, and of the versions of the steps if it runs or reads their work."""
        digest = hashlib.sha256()
        for path in sorted(imported_files(self.script, everything=self.runs)):
            digest.update(code_of(path).encode())
        if self.reads or self.runs:
            digest.update(str({step.name: step.version for step in STEPS.values()}).encode())
        return digest.hexdigest()[:12]

    def footer(self) -> tuple[str, ...]:
        """Command, seconds, commit and sources of the page as it is; empty without."""
        found = FOOTER.search(self.path.read_text()) if self.path.exists() else None
        return found.groups() if found else ()

    def is_current(self) -> bool:
        """Whether the page was made from the present sources."""
        footer = self.footer()
        return bool(footer) and footer[3] == self.sources()


ALL = (
    Page("tiling_families"),
    Page("mesh_all_families"),
    Page("named_patterns"),
    Page("stiffness_convergence"),
    Page("mesh_convergence", own_output=True),
    Page("scale_elements"),
    Page("substrate_elements"),
    Page("substrate_bending"),
    Page("joint_section"),
    Page("joint_laws"),
    Page("joint_cells"),
    Page("free_ends"),
    Page("joint_sheets"),
    Page("half_turn"),
    Page("hinged_strip"),
    Page("contact_convergence"),
    Page("branches"),
    Page("never_stuck", reads="named_patterns"),
    Page("full_characterization", reads="full_characterization"),
    Page("quickstart_states"),
    Page("newton_iteration"),
    Page("solver_speed"),
    Page("supercells"),
    Page("fit_errors", reads="named_patterns"),
    Page("fitted_sheet", reads="named_patterns"),
    Page("synthesis", reads="named_patterns"),
    Page("rigs", reads="named_patterns"),
    Page("gap_models", reads="named_patterns"),
    Page("laws", reads="printed_tensors"),
    Page("findings"),
    Page("recompute", reads="named_patterns"),
    Page("macro_shell"),
    Page("registry", runs=True),
    Page("kills", runs=True),
    Page("interruptions", runs=True),
    Page("fabricate"),
    Page("fuzz", runs=True),
    Page("exported_files"),
)


def imported_files(script: Path, *, everything: bool = False) -> set[Path]:
    """The script and all modules of flexscale and benchmarks that it imports, directly or not."""
    package = ROOT / "flexscale"
    found: set[Path] = {script, *(package.rglob("*.py") if everything else ())}
    waiting = list(found)
    while waiting:
        for name in _imports_of(waiting.pop()):
            for home in (ROOT, script.parent):
                path = home.joinpath(*name.split("."))
                module = path.with_suffix(".py") if path.with_suffix(".py").is_file() else None
                if module is None and (path / "__init__.py").is_file() and path != package:
                    module = path / "__init__.py"
                if module is not None and module not in found:
                    found.add(module)
                    waiting.append(module)
    return found


@functools.cache
def _imports_of(path: Path) -> set[str]:
    """Dotted names that a module imports, at any depth; public names stand for their homes."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Attribute) and getattr(node.value, "id", "") == "fs":
            names.add(PUBLIC_HOMES.get(node.attr, ""))
    return names - {""}


@functools.cache
def code_of(path: Path) -> str:
    """What a module does, whatever its comments and docstrings say and however it is laid out."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        first = body[0] if isinstance(body, list) and body else None
        if isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str):
            body[0] = ast.Pass()
    return ast.dump(tree)


def run_sweeps(workflow: str, results: Path) -> None:
    """The twelve named patterns to their end; what is there already is not done again."""
    experiment = ROOT / "workflows" / f"{workflow}.yaml"
    command = [sys.executable, "-m", "flexscale.cli", "run", str(experiment)]
    done = subprocess.run([*command, "--results", str(results)], check=False, cwd=ROOT)
    if done.returncode not in (0, 3):  # 3: some samples did not converge, which the page tells
        raise SystemExit(done.returncode)


def make(page: Page, results: Path) -> None:
    """Run a benchmark and sign its page; an old page stays where the benchmark fails."""
    shown = f"python benchmarks/{page.name}.py"
    command = [sys.executable, str(page.script)]
    if page.reads:
        # Other pages look for the one sweep of a pattern: full ones have a folder of their own.
        results = results if page.reads == "named_patterns" else results.with_name(page.reads)
        run_sweeps(page.reads, results)
        command += ["--results", str(results)]
        shown += " --results DIR"
    fresh = page.path.with_suffix(".new")
    if not page.own_output:
        command += ["--output", str(fresh)]
    sources, start = page.sources(), time.monotonic()
    subprocess.run(command, check=True, cwd=ROOT)
    seconds = time.monotonic() - start
    text = FOOTER.sub("", (page.path if page.own_output else fresh).read_text()).rstrip("\n")
    footer = f"\n\n*Made by `{shown}` in {seconds:.0f} s, commit {_commit()}, sources {sources}.*\n"
    fresh.write_text(text + footer)
    fresh.replace(page.path)


def _commit() -> str:
    command = ["git", "rev-parse", "--short", "HEAD"]
    found = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    return found.stdout.strip() or "unknown"


def write_index() -> None:
    """README.md beside the pages."""
    rows = ["# Validation pages", "", "Made by `make validate`; each names its own command.", ""]
    rows += ["| page | what it tells | commit | s | up to date |", "|---|---|---|---|---|"]
    for page in ALL:
        footer = page.footer() or ("", "", "", "")
        state = "yes" if page.is_current() else "no"
        link = f"[{page.name}]({page.path.name})" if page.path.exists() else page.name
        rows.append(f"| {link} | {page.summary()} | {footer[2]} | {footer[1]} | {state} |")
    (PAGES / "README.md").write_text("\n".join(rows) + "\n")


def main() -> None:
    """Make what is asked for and not up to date."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    names = [page.name for page in ALL]
    parser.add_argument("pages", nargs="*", metavar="PAGE", help=f"of {', '.join(names)}")
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="where sweeps are")
    parser.add_argument("--dry-run", action="store_true", help="only say what would be made")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.pages) - set(names))
    if unknown:
        parser.error(f"there is no page {unknown[0]!r}; there are {', '.join(names)}")
    for page in ALL:
        if arguments.pages and page.name not in arguments.pages:
            continue
        if page.is_current():
            print(f"{page.name}: up to date", flush=True)
            continue
        print(f"{page.name}: to be made", flush=True)
        if not arguments.dry_run:
            try:
                make(page, arguments.results)
            except KeyboardInterrupt:
                print("validate: interrupted; finished pages are kept.", file=sys.stderr)
                raise SystemExit(130) from None
            except subprocess.CalledProcessError as error:
                print(f"validate: {page.name} failed, its old page stays.", file=sys.stderr)
                raise SystemExit(error.returncode) from None
            write_index()
    if not arguments.dry_run:
        write_index()


if __name__ == "__main__":
    main()
