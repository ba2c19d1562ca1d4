"""What all benchmarks share: --output FILE, and tables that go to the terminal and to that file."""

from __future__ import annotations

import argparse
from pathlib import Path


def output_file(doc: str) -> Path | None:
    """The file of --output, if given; `doc` is the benchmark's docstring."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    return parser.parse_args().output


def report(rows: list[str], output: Path | None) -> None:
    """Print the rows, and write them if a file was given."""
    print("\n".join(rows))
    if output:
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text("\n".join(rows) + "\n")
