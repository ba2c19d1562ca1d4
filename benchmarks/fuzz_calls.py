"""Calls of the public functions with arguments that are right, ready to be changed."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

import flexscale as fs
from flexscale import fabricate

COARSE = fs.MeshOptions(scale_layers=2, scale_size=6, scale_strips=1, across=2)
SQUARE = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]


class StoppedError(Exception):
    """All checks are passed; what follows is meshing and solving."""


@contextmanager
def stopped_before_meshing() -> Iterator[None]:
    """Sweeps and tangents end where their checks are done and meshing begins, whole sheets of
    scales where their pattern is laid, tensor sweeps where joints are."""

    def stop(*_: Any, **__: Any) -> Any:
        raise StoppedError

    places = (
        "flexscale.mesh.torus.build_tile_mesh",
        "flexscale.homogenize.joint_cell.find_joints",
        "flexscale.finite.native_sheet.lay_pattern",
        "flexscale.finite.native_stage.lay_pattern",
        "flexscale.finite.native_disc.lay_pattern",
    )
    with ExitStack() as stack:
        for place in places:
            stack.enter_context(mock.patch(place, stop))
        yield


@dataclass(frozen=True)
class Call:
    """A public function or method, and arguments it takes, by name. `weight`: how often."""

    name: str
    function: Callable[..., Any]
    arguments: dict[str, Any]
    weight: float = 1.0

    def with_changes(self, chance: random.Random, mutate: Callable[..., Any]) -> dict[str, Any]:
        """The arguments, one or two of them changed."""
        names = chance.sample(list(self.arguments), min(len(self.arguments), chance.choice([1, 2])))
        return self.arguments | {name: mutate(self.arguments[name], chance) for name in names}


SIZES: dict[str, Any] = {
    "gap": 0.4, "scale_height": 4.0, "substrate_thickness": 0.4, "bond_radius": 0.8,
    "scale_material": fs.PETG, "substrate_material": fs.TPU, "name": "bent",
}  # fmt: skip


def light_calls() -> list[Call]:
    """Patterns, options, and what ends where meshing begins: nothing is compiled or drawn."""
    return [*_shapes(), *_options(), *_native()]


def all_calls(results: Path) -> list[Call]:
    """Every public entry point."""
    registry = fs.open_registry(results)
    datasets = {
        kind: registry.load(registry.find(kind=kind)[0])
        for kind in ("sweep", "fit", "tangent", "shape", "sheet", "rig", "turned_sheet")
    }
    return [
        *light_calls(),
        *_models(datasets),
        *_registry(registry, datasets),
        *_plots(datasets),
        *_printing(),
    ]


def _shapes() -> list[Call]:
    tiling = fs.Tiling("IH64", [-0.2])
    pattern = fs.Pattern(tiling)
    polygons = fs.Pattern.from_polygons([SQUARE], (10, 0), (0, 10))
    edges = {"b": [[0.0, 0.0], [0.5, 0.1]]}
    own: dict[str, Any] = {"tiles": [SQUARE], "t1": [10.0, 0.0], "t2": [0.0, 10.0]}
    return [
        Call("NeoHookean", fs.NeoHookean, {"young_modulus": 26.0, "poisson_ratio": 0.48}),
        Call("Tiling", fs.Tiling, {"family": "IH64", "parameters": [-0.2], "edges": edges}, 3),
        Call("Pattern", fs.Pattern, {"tiling": tiling, "tile_area": 100.0, **SIZES}, 3),
        Call("Pattern.from_polygons", fs.Pattern.from_polygons, own | SIZES, 3),
        Call("Pattern.with_", pattern.with_, {"tile_area": 90.0, **SIZES}),
        Call("Pattern.with_ of polygons", polygons.with_, dict(SIZES)),
        Call("Pattern.from_config", fs.Pattern.from_config, {"config": pattern.to_config()}, 2),
        Call("Pattern.from_config of polygons", fs.Pattern.from_config,
             {"config": polygons.to_config()}, 2),
        Call("named_pattern", fs.named_pattern, {"name": "chevron", "gap": 0.5, "tile_area": 90.0}),
    ]  # fmt: skip


def _options() -> list[Call]:
    classes = (fs.MeshOptions, fs.SolverOptions, fs.ContactOptions, fs.ScaleOptions)
    calls = [Call(one.__name__, one, one().to_config(), 2) for one in classes]
    return [
        *calls,
        Call("MeshOptions.finer", COARSE.finer, {"factor": 2.0}),
        Call("SubstrateOptions", fs.SubstrateOptions, fs.SubstrateOptions().to_config()),
        Call("NativeModel", fs.NativeModel, {
            "name": "shell", "mesh": COARSE, "solver": fs.SolverOptions(),
            "contact": fs.ContactOptions(), "substrate": fs.SubstrateOptions(),
            "scales": fs.ScaleOptions(),
        }),
        Call("NativeModel.from_config", fs.NativeModel.from_config,
             {"config": fs.NativeModel("shell", mesh=COARSE).to_config()}),
        Call("RigOptions", fs.RigOptions, {"element": "c1", "size": 5.0, "steps": 2}),
        Call("SheetOptions", fs.SheetOptions,
             {"element": "c1", "size": 5.0, "strip": 0.0, "turning": False}),
    ]  # fmt: skip


def _native() -> list[Call]:
    pattern = fs.named_pattern("square")
    options: dict[str, Any] = {"model": fs.NativeModel("shell", mesh=COARSE)}
    joints: dict[str, Any] = {"model": fs.NativeModel(solver=fs.SolverOptions())}
    both = ("closing", "opening")
    bends: dict[str, Any] = {"pattern": pattern, "curvatures": [0.0, 0.01]}
    sizes: dict[str, Any] = {
        "length": 60.0, "width": 30.0, "direction": 0.0, "offset": (0.0, 0.0),
    }  # fmt: skip
    rest = {"checkpoint": None, "on_sample": None}
    whole = joints | rest | {"pattern": pattern}
    return [
        Call("sweep", fs.sweep,
             bends | options | rest
             | {"sides": both, "directions": [0.0, 45.0], "symmetry": True, "workers": 1}, 6),
        Call("tensor_sweep", fs.tensor_sweep,
             bends | joints | rest
             | {"directions": [0.0, 45.0], "shapes": [-45.0, 0.0], "in_plane": "free",
                "symmetry": True, "workers": 1}, 3),
        Call("tangent_stiffness", fs.tangent_stiffness,
             options | {"pattern": pattern}, 2),
        Call("simulate_native_sheet", fs.simulate_native_sheet,
             whole | bends | sizes
             | {"side": both, "outline": [[0, 0], [60, 0], [60, 30], [30, 25], [0, 30]]}, 3),
        Call("simulate_native_stage", fs.simulate_native_stage,
             whole | sizes | {"shortenings": [1.0, 2.0], "sides": ("closing",)}, 3),
        Call("simulate_native_mandrel", fs.simulate_native_mandrel,
             whole | {"radius": 30.0, "hub": 10.0, "indentation": 2.0, "angles": [0.0, 45.0],
                      "sides": both}, 3),
        Call("gap_model", fs.gap_model,
             options | {"pattern": pattern, "w_biaxial": 0.0}, 2),
    ]  # fmt: skip


def _models(datasets: dict[str, Any]) -> list[Call]:
    model = fs.MacroModel.from_dataset(datasets["fit"])
    tangent = fs.tangent_stiffness(
        fs.named_pattern("square"), model=fs.NativeModel("shell", mesh=COARSE)
    )
    gaps = fs.gap_model(fs.named_pattern("square"), model=fs.NativeModel("shell", mesh=COARSE))
    sheet = fs.simulate_sheet(model, length=40.0, width=20.0, curvature=0.01,
                              options=fs.SheetOptions(size=10.0))  # fmt: skip
    bend: dict[str, Any] = {"curvature": 0.01, "direction": [0.0, 30.0], "side": "closing"}
    tensor = {"curvature": [[0.01, 0.0], [0.0, 0.002]]}
    rig: dict[str, Any] = {
        "model": model, "options": fs.RigOptions(size=25.0), "solver": fs.SolverOptions(),
    }  # fmt: skip
    calls = [
        Call("TangentStiffness.stiffness", tangent.stiffness, {"direction": 30.0}),
        Call("MacroModel.parameters", model.parameters, {"direction": 30.0, "side": "closing"}),
        Call("MacroModel.from_dataset", fs.MacroModel.from_dataset, {"dataset": datasets["fit"]}),
        Call("GapModel.onset", gaps.onset, {"direction": 30.0, "side": "opening"}),
        Call("GapModel.tensor_onset", gaps.tensor_onset, tensor),
        Call("GapModel.fitted", gaps.fitted, {"sweep": datasets["sweep"]}, 0.5),
        Call("GapModel.errors", gaps.errors, {"sweep": datasets["sweep"]}, 0.5),
        Call("fit", fs.fit,
             {"sweep": datasets["sweep"], "tangent": datasets["tangent"], "variant": "tangent",
              "weighting": "relative", "w_biaxial": 0.0}, 2),
        Call("simulate_sheet", fs.simulate_sheet,
             {"model": model, "length": 40.0, "width": 20.0, "curvature": 0.01, "direction": 0.0,
              "options": fs.SheetOptions(size=10.0), "solver": fs.SolverOptions()}, 3),
        Call("simulate_mandrel", fs.simulate_mandrel,
             rig | {"radius": 100.0, "hub": 10.0, "indentation": 5.0, "angles": [0.0],
                    "side": "closing"}, 3),
        Call("simulate_stage", fs.simulate_stage,
             rig | {"length": 100.0, "width": 50.0, "shortenings": [1.0], "direction": 0.0,
                    "side": "closing"}, 3),
        Call("synthesize_scales", fs.synthesize_scales,
             {"pattern": fs.named_pattern("square"), "sheet": sheet, "remove_overlap": True,
              "clearance": 0.01, "turn_weight": 1.0, "center": (0.0, 0.0)}, 2),
    ]  # fmt: skip
    for name, one in (("MacroModel", model), ("GapModel", gaps)):
        calls += [
            Call(f"{name}.moment", one.moment, bend),
            Call(f"{name}.energy", one.energy, bend),
            Call(f"{name}.tensor_energy", one.tensor_energy, tensor),
            Call(f"{name}.tensor_moment", one.tensor_moment, tensor),
        ]
    kept = gaps.to_dataset()
    calls += [
        Call("GapModel.to_dataset", gaps.to_dataset, {"directions": [0.0, 90.0]}),
        Call("GapModel.from_dataset", fs.GapModel.from_dataset, {"dataset": kept}),
        Call("plot.gap_model", fs.plot.gap_model, {"model": kept}, 0.5),
    ]
    scaled = fs.synthesize_scales(fs.named_pattern("square"), sheet)
    calls.append(Call("ScaledSheet.write", scaled.write, {"path": "scaled.obj"}))
    calls.append(Call("plot.scaled_sheet", fs.plot.scaled_sheet,
                      {"shape": scaled, "view": (-118.0, 35.0)}, 0.5))  # fmt: skip
    return calls


def _registry(registry: Any, datasets: dict[str, Any]) -> list[Call]:
    first = registry.find(kind="tangent")[0].id
    sample = {"name": "moment", "side": "closing", "direction": 0.0, "curvature": 0.0}
    return [
        Call("open_registry", fs.open_registry, {"root": "nowhere"}, 0.5),
        Call("between", fs.between, {"low": 0.3, "high": 0.5, "unit": "mm"}),
        Call("Registry.find", registry.find, {"kind": "tangent", "gap": [0.4, 0.5]}, 2),
        Call("Registry.one", registry.one, {"kind": "tangent", "pattern": "square"}),
        Call("Registry.get", registry.get, {"identifier": first}),
        Call("Registry.load", registry.load, {"dataset": first}),
        Call("Registry.record", registry.record, {"dataset": first}),
        Call("Registry.lineage", registry.lineage, {"dataset": first}),
        Call("Registry.diff", registry.diff, {"first": first, "second": first}),
        Call("Registry.stack", registry.stack, {"along": "pattern", "kind": "tangent"}, 0.3),
        Call("contact_onset", fs.contact_onset, {"sweep": datasets["sweep"]}),
        Call("dataset.fs.sample", datasets["sweep"].fs.sample, sample),
    ]


def _plots(datasets: dict[str, Any]) -> list[Call]:
    both = ("closing", "opening")
    sweep, fit = datasets["sweep"], datasets["fit"]
    figure = fs.plot.stiffness(datasets["tangent"])
    return [
        Call("plot.polar", fs.plot.polar,
             {"sweep": sweep, "side": both, "curvatures": [0.01]}, 0.7),
        Call("plot.stiffness", fs.plot.stiffness, {"tangent": [datasets["tangent"]]}, 0.7),
        Call("plot.curves", fs.plot.curves,
             {"sweep": sweep, "directions": [0.0], "sides": both, "variable": "moment", "fit": fit},
             0.7),
        Call("plot.fit", fs.plot.fit, {"model": fit, "sweep": sweep, "direction": 0.0}, 0.5),
        Call("plot.macro_polar", fs.plot.macro_polar,
             {"model": fit, "sweep": sweep, "sides": both, "curvatures": [0.01]}, 0.5),
        Call("plot.sheet", fs.plot.sheet, {"bent": datasets["sheet"], "sides": both}, 0.5),
        Call("plot.rig", fs.plot.rig, {"tests": datasets["rig"], "sides": both}, 0.5),
        Call("plot.turned_sheet", fs.plot.turned_sheet,
             {"turned": datasets["turned_sheet"], "sweep": sweep, "sides": both}, 0.5),
        Call("plot.cell", fs.plot.cell,
             {"shape": datasets["shape"], "samples": [0], "n_cells": 1, "view": (0.0, 30.0)}, 0.5),
        Call("plot.save_figure", fs.plot.save_figure,
             {"figure": figure, "folder": "figures", "stem": "polar", "sources": ["sweep:1"],
              "facts": {"caption": "none"}}, 0.5),
    ]  # fmt: skip


def _printing() -> list[Call]:
    pattern, disc = fs.named_pattern("square"), {"radius": 30.0, "hub": 8.0}
    rectangle = {"length": 30.0, "width": 20.0, "pin": 3.0, "clearance": 0.2, "barrel_wall": 1.2}
    layout = {"direction": 0.0, "center": (0.0, 0.0), "border": "cut", "smallest_area": 5.0}
    printer = {"layer_height": 0.1, "nozzle": 0.4, "smallest_wall": 0.4, "scale_density": 1.27}
    grooves = {"width": 0.8, "pitch": 1.6, "depth": 0.2, "margin": 0.8}
    classes = {
        "shape": (fabricate.Rectangle, rectangle), "layout": (fabricate.Layout, layout),
        "grooves": (fabricate.Grooves, grooves), "printer": (fabricate.Printer, printer),
    }  # fmt: skip
    made = {name: one(**arguments) for name, (one, arguments) in classes.items()}

    def sheet_with(name: str) -> Callable[..., Any]:
        one = fabricate.Disc if name == "disc" else classes[name][0]

        def make(**arguments: Any) -> Any:
            part = {"shape" if name == "disc" else name: one(**arguments)}
            return fabricate.printable_sheet(pattern, **(made | part))

        return make

    return [
        Call("printable_sheet", fabricate.printable_sheet, {"pattern": pattern, **made}, 0.7),
        *(Call(f"printable_sheet of {one.__name__}", sheet_with(name), arguments)
          for name, (one, arguments) in classes.items()),
        Call("printable_sheet of Disc", sheet_with("disc"), disc),
    ]  # fmt: skip


def results_are_finite(result: Any) -> bool:
    """Whether numbers that a call returned are finite; of other results nothing is known."""
    if isinstance(result, float | np.ndarray) and np.asarray(result).dtype.kind == "f":
        return bool(np.isfinite(result).all())
    return True
