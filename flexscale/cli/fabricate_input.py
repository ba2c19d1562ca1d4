"""What `flexscale fabricate` was asked for, and the pattern and shape this means."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexscale.cli.tiling_input import read_edges, read_parameters
from flexscale.errors import ConfigError, UnknownNameError, shown, suggest
from flexscale.fabricate import Disc, Rectangle
from flexscale.mesh.options import MeshOptions
from flexscale.patterns import Pattern, named_pattern, named_patterns
from flexscale.tilings import Tiling
from flexscale.tilings.families import families, find_family

_FILES = (".yaml", ".yml")


@dataclass(frozen=True)
class SheetRequest:
    """Options of the command as they were given; those left out are not in the dicts.

    Attributes
    ----------
    pattern, select, parameters, edges, sizes : which pattern, and changes to its sizes (mm).
    shape, size : "rectangle" or "disc", and its size as text.
    rectangle, disc : further options of either shape.
    layout, grooves, printer : arguments of the classes of these names.
    """

    pattern: str
    select: str | None
    parameters: str | None
    edges: tuple[str, ...]
    sizes: dict[str, float]
    shape: str
    size: str | None
    rectangle: dict[str, float]
    disc: dict[str, float]
    layout: dict[str, Any]
    grooves: dict[str, float]
    printer: dict[str, float]


def requested_pattern(request: SheetRequest) -> tuple[Pattern, MeshOptions]:
    """The pattern, and the mesh options with which it is simulated.

    Raises
    ------
    ConfigError : options that do not belong to this kind of pattern, or an unreadable file.
    UnknownNameError : no such pattern.
    PatternError, TilingError : the pattern cannot be built with these sizes.
    """
    text = request.pattern
    of_family = request.parameters is not None or bool(request.edges)
    is_file = text.endswith(_FILES) or Path(text).is_file()
    if request.select is not None and not is_file:
        raise ConfigError(f"--pattern chooses from an experiment file, and {shown(text)} is none.")
    if of_family and (is_file or not _is_family(text)):
        raise ConfigError(
            "--parameters and --edge shape a tiling family, such as IH07, and "
            f"{shown(text)} is none."
        )
    if is_file:
        return _from_file(Path(text), request)
    if _is_family(text):
        kinds = find_family(text).curve_kinds()
        edges = read_edges(request.edges, kinds)
        tiling = Tiling(text, read_parameters(request.parameters), edges)
        return Pattern(tiling).with_(**request.sizes), MeshOptions()
    names = [entry.name for entry in named_patterns()]
    if text not in names:
        raise UnknownNameError(
            f"There is no pattern named {shown(text)}. {suggest(text, names)} A tiling family "
            "(IH01 to IH93) or an experiment file (.yaml) may be given too."
        )
    return named_pattern(text, **request.sizes), MeshOptions()


def _from_file(path: Path, request: SheetRequest) -> tuple[Pattern, MeshOptions]:
    from flexscale.steps.experiment import load_experiment  # loads most of flexscale

    experiment = load_experiment(path)
    names = list(experiment.patterns)
    chosen = request.select
    if chosen is None:
        if len(names) > 1:
            listed = ", ".join(names)
            raise ConfigError(f"{path} has {len(names)} patterns: choose by --pattern: {listed}.")
        chosen = names[0]
    if chosen not in names:
        raise UnknownNameError(f"{path} has no pattern {shown(chosen)}. {suggest(chosen, names)}")
    pattern = experiment.build_patterns()[chosen]
    return pattern.with_(**request.sizes), experiment.mesh


def requested_shape(request: SheetRequest) -> Rectangle | Disc:
    """The shape.

    Raises
    ------
    ConfigError : a size of another form, or options of the other shape.
    """
    foreign = request.disc if request.shape == "rectangle" else request.rectangle
    if foreign:
        flags = {"clearance": "pin-clearance", "barrel_wall": "barrel-wall"}
        option = next(iter(foreign))
        raise ConfigError(f"A {request.shape} has no --{flags.get(option, option)}: leave it out.")
    if request.shape == "rectangle":
        numbers = _numbers(request.size or "100x50")
        if len(numbers) != 2:
            raise _bad_size(request, "LENGTHxWIDTH in mm, such as 100x50")
        options: dict[str, Any] = dict(request.rectangle)
        if options.get("pin") == 0.0:
            options["pin"] = None
        return Rectangle(numbers[0], numbers[1], **options)
    numbers = _numbers(request.size or "100")
    if len(numbers) != 1:
        raise _bad_size(request, "its radius in mm, such as 100")
    hub: dict[str, Any] = dict(request.disc)
    if hub.get("hub") == 0.0:
        hub["hub"] = None
    return Disc(numbers[0], **hub)


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in re.split(r"[x×]", text)]
    except ValueError:
        return []


def _bad_size(request: SheetRequest, form: str) -> ConfigError:
    return ConfigError(
        f"--size {shown(request.size)} is no size of a {request.shape}: write {form}."
    )


def _is_family(text: str) -> bool:
    return text in {family.name for family in families()}
