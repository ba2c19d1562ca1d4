"""What all benchmarks share: --results DIR, --output FILE, tables that go to terminal and file."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import flexscale as fs
from flexscale.datasets.registry import Registry


def output_file(doc: str) -> Path | None:
    """The file of --output, if given; `doc` is the benchmark's docstring."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    return parser.parse_args().output


def datasets_and_output(doc: str) -> tuple[Registry, Path | None]:
    """The registry of --results, which must be given, and the file of --output, if given."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--results", type=Path, required=True, help="folder of the datasets")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    options = parser.parse_args()
    return fs.open_registry(options.results), options.output


def heading(title: str, doc: str) -> list[str]:
    """Title, and what the benchmark's docstring says below its command."""
    return [f"# {title}", "", "\n\n".join(doc.split("\n\n")[2:]).rstrip(), ""]


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """Lines of a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(line)} |" for line in lines] + [""]


def report(rows: list[str], output: Path | None) -> None:
    """Print the rows, and write them if a file was given."""
    print("\n".join(rows))
    if output:
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text("\n".join(rows) + "\n")


def peak_memory() -> float:
    """MB, of this process, not of the one that it was forked from."""
    status = Path("/proc/self/status").read_text()
    return int(re.findall(r"VmHWM:\s+(\d+) kB", status)[0]) / 1024.0
