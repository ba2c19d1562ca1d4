"""Validation pages know whether they are current: by the code they depend on, not by its words."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def validate() -> ModuleType:
    sys.path.insert(0, str(BENCHMARKS))
    try:
        import validate as module
    finally:
        sys.path.remove(str(BENCHMARKS))
    return module


def test_every_benchmark_page_has_a_script_and_a_digest(validate: ModuleType) -> None:
    for page in validate.ALL:
        assert page.script.is_file()
        assert page.summary()
        assert len(page.sources()) == 12


def test_pages_depend_on_what_they_import(validate: ModuleType) -> None:
    files = validate.imported_files(BENCHMARKS / "tiling_families.py")
    names = {path.relative_to(BENCHMARKS.parent).as_posix() for path in files}
    assert "benchmarks/report.py" in names
    assert "flexscale/tilings/tiling.py" in names
    assert not any(name.startswith("flexscale/macro") for name in names)
    gaps = validate.imported_files(BENCHMARKS / "gap_models.py")
    assert BENCHMARKS.parent / "flexscale" / "homogenize" / "flat_contact.py" in gaps


def test_words_do_not_make_a_page_old_and_code_does(validate: ModuleType, tmp_path: Path) -> None:
    one, other, changed = (tmp_path / f"{name}.py" for name in ("one", "other", "changed"))
    one.write_text('"""A."""\ndef f(x):\n    """B."""\n    return x + 1  # C\n')
    other.write_text('"""D."""\n\n\ndef f(\n    x,\n):\n    """E."""\n    return x + 1\n')
    changed.write_text('"""A."""\ndef f(x):\n    """B."""\n    return x + 2\n')
    assert validate.code_of(one) == validate.code_of(other) != validate.code_of(changed)
