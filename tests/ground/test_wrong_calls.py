"""A short share of benchmarks/fuzz.py: wrong calls and wrong files get a sentence of ours."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import pytest

BENCHMARKS = str(Path(__file__).resolve().parents[2] / "benchmarks")
ANSWERED = {"succeeds", "refused"}


@pytest.fixture
def fuzz(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> object:
    """The benchmark, in a folder of its own."""
    monkeypatch.syspath_prepend(BENCHMARKS)
    monkeypatch.chdir(tmp_path)
    import fuzz

    yield fuzz
    for name in [name for name in sys.modules if name.startswith("fuzz")]:
        del sys.modules[name]


def test_wrong_calls(fuzz, capsys: pytest.CaptureFixture[str]) -> None:
    from fuzz_calls import light_calls

    counts = fuzz.try_calls(light_calls(), 400, seed=2)
    kinds = _kinds(counts)
    assert kinds.keys() <= ANSWERED, capsys.readouterr().err
    assert kinds["refused"] > 300
    assert kinds["succeeds"] > 10


def test_wrong_files(fuzz, capsys: pytest.CaptureFixture[str]) -> None:
    kinds = _kinds(fuzz.try_files(60, seed=2))
    assert kinds.keys() <= ANSWERED, capsys.readouterr().err
    assert kinds["refused"] > 30


def test_the_benchmark_sees_faults(fuzz, capsys: pytest.CaptureFixture[str]) -> None:
    """A function without checks is told apart from one with them."""
    from fuzz_calls import Call

    def careless(gap: float) -> float:
        return 2.0 * gap + 0.0

    counts = fuzz.try_calls([Call("careless", careless, {"gap": 0.4})], 60, seed=1)
    kinds = _kinds(counts)
    assert kinds["foreign exception"] > 5
    assert kinds["took nan or infinity"] > 2
    assert "careless({'gap':" in capsys.readouterr().err


def _kinds(counts: Counter[tuple[str, str]]) -> Counter[str]:
    kinds: Counter[str] = Counter()
    for (_, kind), number in counts.items():
        kinds[kind] += number
    return kinds
