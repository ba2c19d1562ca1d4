"""Public functions check what they are given, in one way."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale import checks
from flexscale.errors import BadInputError, FlexScaleError, UnitRangeError, UnknownNameError

SIDES = ("closing", "opening")
COARSE = fs.NativeModel(
    "shell",
    mesh=fs.MeshOptions(along=4, corner=1, scale_size=10, scale_layers=1, scale_order=1, across=2),
)


@checks.checked(
    length=checks.length("sheet length"),
    sides=checks.choices("side", SIDES),
    kappa=checks.series("mm-1"),
    mesh=checks.MESH,
)
def simulated(length: float, sides: Any = SIDES, *, kappa: Any = (0.0,), mesh: Any = None) -> Any:
    """Gives back what it is given."""
    return length, sides, kappa, mesh


def test_checked_arguments_arrive_as_what_the_function_works_with() -> None:
    assert simulated(100) == (100.0, SIDES, (0.0,), None)
    assert simulated(np.array(50), "opening", kappa=0.01) == (50.0, ("opening",), (0.01,), None)
    assert simulated(1, np.array(["closing"]), kappa=np.array([0, 0.1]))[1:3] == (
        ("closing",),
        (0.0, 0.1),
    )
    mesh = fs.MeshOptions()
    assert simulated(1.0, mesh=mesh)[3] is mesh
    assert list(inspect.signature(simulated).parameters) == ["length", "sides", "kappa", "mesh"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("100",), "sheet length must be a number in mm, not '100' \\(str\\)"),
        ((None,), "sheet length must be a number in mm"),
        ((1.0, "c"), "no side 'c'. Known: 'closing', 'opening'"),
        ((1.0, 3), "no side 3"),
        ((1.0, []), "one or more names"),
        ((1.0, ["closing", "closing"]), "each once"),
        ((1.0, None), "no side None"),
    ],
)
def test_wrong_arguments_get_a_sentence(arguments: Any, words: str) -> None:
    with pytest.raises(BadInputError, match=words):
        simulated(*arguments)


def test_options_of_another_kind_are_refused_with_the_way_to_make_them() -> None:
    for mesh in (0, "", {}, fs.SolverOptions()):
        with pytest.raises(BadInputError, match=r"mesh must be a MeshOptions.*fs\.MeshOptions"):
            simulated(1.0, mesh=mesh)


def test_arity_is_python_s_own_matter() -> None:
    with pytest.raises(TypeError, match="missing a required argument"):
        simulated()


#: Materials, modules, and what takes nothing.
OTHERS = {"PETG", "RIGID", "TPU", "TPU_MEASURED", "plot", "families", "named_patterns"}


def test_every_public_function_checks_its_arguments() -> None:
    """Whatever is public and can be called is wrapped; families and catalogs take nothing."""
    results = {
        "GapModel",
        "JointLaw",
        "MacroModel",
        "ScaledSheet",
        "TensorModel",
    }  # made by functions, not by callers
    for name in set(fs.__all__) - OTHERS - results:
        target = getattr(fs, name)
        made = target.__init__ if isinstance(target, type) else target
        own = {"Tiling", "named_pattern"}  # their errors name the family, the pattern
        assert hasattr(made, "__wrapped__") or name in own, name
    for name in set(fs.plot.__all__) - {"flexscale_style"}:
        assert hasattr(getattr(fs.plot, name), "__wrapped__") or name == "stiffness", name


WRONG: dict[str, tuple[Any, dict[str, Any]]] = {
    "sweep: text": (fs.sweep, {"directions": "0", "curvatures": [0.0]}),
    "sweep: sides": (fs.sweep, {"directions": 0, "curvatures": 0.01, "sides": "c"}),
    "sweep: nan": (fs.sweep, {"directions": [np.nan], "curvatures": [0.0]}),
    "sweep: order": (fs.sweep, {"directions": [0], "curvatures": [0.01, 0.0]}),
    "sweep: twice": (fs.sweep, {"directions": [0, 0], "curvatures": [0.0]}),
    "sheet: direction": (
        fs.simulate_native_sheet,
        {"length": 60, "width": 30, "curvatures": 0.0, "direction": 1e300},
    ),
    "sweep: workers": (fs.sweep, {"directions": 0, "curvatures": 0.0, "workers": 0}),
    "sweep: checkpoint": (fs.sweep, {"directions": 0, "curvatures": 0.0, "checkpoint": 3}),
    "tangent: model": (fs.tangent_stiffness, {"model": 3}),
    "tangent: name": (fs.tangent_stiffness, {"model": "shel"}),
    "native sheet": (fs.simulate_native_sheet, {"length": "60", "width": 3, "curvatures": 0}),
    "native sheet: model": (fs.simulate_native_sheet, {"curvatures": 0, "model": COARSE}),
    "native sheet: end": (fs.simulate_native_sheet, {"length": 100, "curvatures": 0.07}),
    "native stage": (fs.simulate_native_stage, {"length": 60, "width": np.inf}),
    "native stage: model": (fs.simulate_native_stage, {"model": "solid"}),
    "native stage: offset": (fs.simulate_native_stage, {"offset": (1.0, 2.0, 3.0)}),
    "native mandrel: hub": (fs.simulate_native_mandrel, {"radius": 20, "hub": 20}),
    "native mandrel: angles": (fs.simulate_native_mandrel, {"angles": [0, 360]}),
    "native mandrel: model": (fs.simulate_native_mandrel, {"model": "shell"}),
    "gap model": (fs.gap_model, {"w_biaxial": -1.0}),
    "gap model: sweep": (fs.gap_model, {"sweep": xr.Dataset(), "model": COARSE}),
}


@pytest.mark.parametrize("case", WRONG)
def test_functions_on_patterns_refuse_before_meshing(
    case: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    function, arguments = WRONG[case]
    if case != "gap model: sweep":  # a sweep is looked at when the model is there

        def never(*_: Any) -> None:
            raise AssertionError("meshed or laid before all was checked")

        monkeypatch.setattr("flexscale.mesh.torus.build_tile_mesh", never)
        monkeypatch.setattr("flexscale.homogenize.joint_cell.find_joints", never)
        for sheet in ("native_sheet", "native_stage", "native_disc"):
            monkeypatch.setattr(f"flexscale.finite.{sheet}.lay_pattern", never)
    with pytest.raises(FlexScaleError):
        function(fs.named_pattern("square"), **arguments)


def test_a_pattern_is_a_pattern() -> None:
    for function in (fs.sweep, fs.tangent_stiffness, fs.gap_model):
        arguments = {"directions": 0, "curvatures": 0} if function is fs.sweep else {}
        with pytest.raises(BadInputError, match=r"pattern must be a Pattern, not 'square' \(str\)"):
            function("square", **arguments)


@pytest.mark.parametrize(
    ("family", "arguments"),
    [
        (["IH76"], {}),
        (76, {}),
        ("IH64", {"parameters": ["a"]}),
        ("IH64", {"parameters": [np.nan]}),
        ("IH64", {"parameters": [1e300]}),
        ("IH64", {"edges": [1]}),
        ("IH64", {"edges": {3: [[0, 0], [1, 0]]}}),
        ("IH64", {"edges": {"b": [["0", "0"], ["1", "0"]]}}),
        ("IH64", {"edges": {"b": [[0, 0], [0.5, 1e300]]}}),
    ],
)
def test_tilings(family: Any, arguments: dict[str, Any]) -> None:
    with pytest.raises(BadInputError):
        fs.Tiling(family, **arguments)


def test_curvatures_and_directions_go_together() -> None:
    model = fs.gap_model(fs.named_pattern("square"), model=COARSE)
    assert model.moment([0.001, 0.002], [[0.0], [45.0]]).shape == (2, 2)
    with pytest.raises(UnitRangeError, match=r"shape \(2,\) and directions of shape \(3,\)"):
        model.moment([0.001, 0.002], [0.0, 1.0, 2.0])
    with pytest.raises(UnitRangeError, match=r"radius below 0\.001 mm"):
        model.energy(1e300, 0.0)
    for wrong in ("0", None, [[1, 2], [3]], np.nan, 1j):
        with pytest.raises(UnitRangeError, match="directions must be numbers in degree"):
            model.onset(wrong)
        with pytest.raises(UnitRangeError):
            model.tensor_energy(wrong)
    with pytest.raises(UnknownNameError, match="no side 'c'"):
        model.moment(0.001, 0.0, "c")
