"""Laws as code of other languages: compiled, run, and held against our kernels."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import BadInputError
from flexscale.homogenize.flat_contact import FlatContact
from flexscale.macro.gap_model import GapModel
from flexscale.macro.model import MacroModel
from tests.exchange.exchange_samples import (
    derivatives_of,
    model_of,
    random_curvatures,
    touching_share,
)
from tests.macro.law_samples import IN_PLANE, TANGENT

CLOSE = 1e-12
COMPILER = shutil.which("cc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler (cc) on this machine")
NAME = "flexscale_IH01_4_8_8"
MAIN = """#include <stdio.h>
#include "{header}"
int main(void) {{
    double k[3], g[3], h[9];
    int i;
    while (scanf("%lf %lf %lf", k, k + 1, k + 2) == 3) {{
        printf("%.17g", {name}_energy(k, g, h));
        for (i = 0; i < 3; ++i) printf(" %.17g", g[i]);
        for (i = 0; i < 9; ++i) printf(" %.17g", h[i]);
        printf(" %.17g %d\\n", {name}_energy(k, NULL, NULL), {name}_within_data(k));
    }}
    return 0;
}}
"""


def run_c(model: Any, k: np.ndarray, folder: Path, name: str = NAME) -> np.ndarray:
    """(n, 15) of energy, gradient, Hessian, energy alone and within_data."""
    header = fs.export(model, to="c-header", path=folder / "law.h")
    source, program = folder / "main.c", folder / "main"
    source.write_text(MAIN.format(header=header.name, name=name))
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror"]
    subprocess.run([str(COMPILER), *flags, "-o", program, source, "-lm"], check=True)
    text = "\n".join(" ".join(map(repr, map(float, row))) for row in k)
    done = subprocess.run([program], input=text, capture_output=True, text=True, check=True)
    return np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])


def load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def require_same(found: tuple[Any, Any, Any], model: MacroModel, k: np.ndarray) -> None:
    """Energy, gradient and Hessian within 1e-12 of their sizes. A gradient at the flat sheet is 0
    up to the rounding of its two directions, of the size of H times δ = 1e-6 mm-1."""
    energy, gradient, hessian = derivatives_of(model, k)
    assert np.abs(found[0] - energy).max(initial=0.0) <= CLOSE * np.abs(energy).max()
    assert (np.abs(found[0] - energy) <= CLOSE * np.abs(energy)).all()
    size = np.abs(hessian).max(axis=(1, 2))
    assert (np.abs(found[2] - hessian).max(axis=(1, 2)) <= CLOSE * size).all()
    steep = np.abs(gradient).max(axis=1) + 1e-6 * size
    assert (np.abs(found[1] - gradient).max(axis=1) <= CLOSE * steep).all()


@needs_compiler
@pytest.mark.parametrize("variant", ["tangent", "paper"])
def test_c_header_is_our_law(variant: str, tmp_path: Path) -> None:
    model, k = model_of(variant), random_curvatures()
    assert 0.2 < touching_share(model, k) < 0.8
    rows = run_c(model, k, tmp_path)
    require_same((rows[:, 0], rows[:, 1:4], rows[:, 4:13].reshape(-1, 3, 3)), model, k)
    assert (rows[:, 13] == rows[:, 0]).all()
    principal = np.linalg.eigvalsh(k[:, [0, 2, 2, 1]].reshape(-1, 2, 2))
    assert (rows[:, 14] == (np.abs(principal) <= 0.02 * (1 + 1e-9)).all(axis=1)).all()


@needs_compiler
@pytest.mark.parametrize("compiler", ["c++"])
def test_c_header_is_c_plus_plus_too(compiler: str, tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        pytest.skip("no C++ compiler (c++) on this machine")
    header = fs.export(model_of(), to="c-header", path=tmp_path / "law.h")
    source = tmp_path / "main.cpp"
    source.write_text(MAIN.format(header=header.name, name=NAME))
    command = [compiler, "-std=c++11", "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only"]
    subprocess.run([*command, source], check=True)


@needs_compiler
def test_c_header_of_every_stored_fit(shipped_results: Path, tmp_path: Path) -> None:
    """The laws that ship, at curvatures around their own onsets."""
    registry = fs.open_registry(shipped_results)
    entries = list(registry.find(kind="fit", pattern=["square", "hexagon", "chevron"]))
    assert len(entries) >= 3
    for i, entry in enumerate(entries):
        folder = tmp_path / str(i)
        folder.mkdir()
        dataset = registry.load(entry)
        model = MacroModel.from_dataset(dataset)
        k = random_curvatures(400, model.largest_curvature)
        name = f"flexscale_{entry.row['family']}_{entry.row['pattern']}"
        rows = run_c(dataset, k, folder, name)
        require_same((rows[:, 0], rows[:, 1:4], rows[:, 4:13].reshape(-1, 3, 3)), model, k)


@pytest.mark.parametrize("variant", ["tangent", "paper"])
def test_python_function_is_our_law(variant: str, tmp_path: Path) -> None:
    model, k = model_of(variant), random_curvatures()
    code = load(fs.export(model, to="python-function", path=tmp_path / "law.py"))
    require_same(code.energy_gradient_hessian(*k.T), model, k)
    assert code.energy(*k.T).tolist() == code.energy_gradient_hessian(*k.T)[0].tolist()
    assert code.hessian(0.01, 0.0, 0.0).shape == (3, 3)
    assert code.gradient(k[:6, 0].reshape(2, 3), 0.0, 0.001).shape == (2, 3, 3)
    principal = np.linalg.eigvalsh(k[:, [0, 2, 2, 1]].reshape(-1, 2, 2))
    expected = (np.abs(principal) <= 0.02 * (1 + 1e-9)).all(axis=1)
    assert (code.within_data(*k.T) == expected).all()


class Traced(np.ndarray):
    """As arrays are while JAX traces a function: never changed, and of no truth value."""

    def __setitem__(self, *_: Any) -> None:
        raise AssertionError("written in place")

    def __bool__(self) -> bool:
        raise AssertionError("what is done depends on a value")

    __iadd__ = __isub__ = __imul__ = __itruediv__ = __setitem__  # type: ignore[assignment]


def test_python_function_writes_nothing_in_place(tmp_path: Path) -> None:
    code = load(fs.export(model_of(), to="python-function", path=tmp_path / "law.py"))
    k = random_curvatures(50)
    found = code.energy_gradient_hessian(*(np.array(x).view(Traced) for x in k.T))
    require_same(tuple(map(np.asarray, found)), model_of(), k)
    one = np.array(0.01).view(Traced)
    assert np.asarray(code.gradient(one, one, one)).shape == (3,)


def test_python_function_takes_jax(tmp_path: Path) -> None:
    """Traced, and differentiated by JAX itself."""
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    jax.config.update("jax_enable_x64", True)
    model, k = model_of(), random_curvatures(100)
    code = load(fs.export(model, to="python-function", path=tmp_path / "law.py"))
    require_same(jax.jit(code.energy_gradient_hessian)(*map(jax.numpy.asarray, k.T)), model, k)
    found = jax.vmap(jax.grad(lambda x: code.energy(x[0], x[1], x[2])))(jax.numpy.asarray(k))
    assert np.asarray(found) == pytest.approx(derivatives_of(model, k)[1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("to", ["c-header", "python-function"])
def test_a_law_that_is_no_closed_form_is_refused(to: str, tmp_path: Path) -> None:
    contact = FlatContact(np.array([0.1]), np.array([[-9.0, 0.0, 0.0]]), np.array([[0.01]]))
    gaps = GapModel(TANGENT, IN_PLANE, contact)
    with pytest.raises(BadInputError, match=r"closed form, and a GapModel .* table-netcdf"):
        fs.export(gaps, to=to, path=tmp_path / "law")
    with pytest.raises(BadInputError, match=r"closed form, which the energy 'new' .* is not"):
        fs.export(Other(**vars(model_of("paper"))), to=to, path=tmp_path / "law")
    assert not list(tmp_path.iterdir())


class Other(MacroModel):
    """A model of an energy that came later."""

    variant = "new"  # type: ignore[assignment]

    def __getattribute__(self, name: str) -> Any:
        return "new" if name == "variant" else super().__getattribute__(name)
