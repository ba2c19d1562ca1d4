"""What datasets of whole sheets hold: sheets bent between end strips, and the testing devices."""

from __future__ import annotations

from dataclasses import replace

from flexscale.datasets.variables import STATUS_ATTRS, Schema, Variable

Measured = tuple[Variable, ...]

_SIDE = Variable("side", ("side",), "text", "", "side to which the sheet is bent")
_BENT = ("side", "curvature")
_TURNED = ("variant", "side", "direction")
_SHORTENED = ("side", "shortening")
_COUNTS = (
    ("newton_iterations", "Newton iterations"),
    ("negative_eigenvalues", "negative eigenvalues of the Hessian"),
)


def _number(name: str, dims: tuple[str, ...], units: str, long_name: str) -> Variable:
    return Variable(name, dims, "float64", units, long_name)


def _count(name: str, dims: tuple[str, ...], long_name: str) -> Variable:
    return Variable(name, dims, "int32", "1", long_name)


def _strips(curvature: tuple[str, ...], direction: tuple[str, ...]) -> Measured:
    """Sheet and strips; curvature and direction are axes, or the same for all sheets."""
    return (
        _SIDE,
        _number("curvature", curvature, "mm-1", "curvature of the end strips"),
        Variable("side_sign", ("side",), "int8", "1", "sign of the curvature, scales on +n"),
        _number("signed_curvature", ("side", *curvature), "mm-1", "curvature, closing > 0"),
        _number("length", (), "mm", "length of the sheet, along which it is bent"),
        _number("width", (), "mm", "width of the sheet"),
        _number(
            "direction", direction, "degree", "direction of the length in the pattern's coordinates"
        ),
    )


def _response(dims: tuple[str, ...]) -> Measured:
    return (
        _number("energy", dims, "N mm", "elastic energy of the sheet"),
        _number("energy_density", dims, "N mm-1", "energy per rest area"),
        _number("moment", dims, "N", "mean bending moment per width, to its side"),
        _number("slide", dims, "mm", "slide of the free strip along the arc, away from the other"),
        *(_count(name, dims, long_name) for name, long_name in _COUNTS),
        Variable("status", dims, "int8", "1", "end of the solve", attrs=STATUS_ATTRS),
    )


def _steepest(dims: tuple[str, ...]) -> Variable:
    return _number("largest_curvature", dims, "mm-1", "largest principal curvature in the sheet")


_SIZES = (
    Variable("n_scales", (), "int32", "1", "scales, cut ones included"),
    Variable("n_unknowns", (), "int32", "1", "unknowns of the model"),
)

SHEET = Schema(
    "sheet",
    1,
    "Rectangular sheet of a macro model, bent between two end strips",
    coordinates=_strips(("curvature",), ()),
    variables=(*_response(_BENT), _steepest(_BENT)),
)

TURNED_SHEET = Schema(
    "turned_sheet",
    1,
    "Rectangular sheets of macro models between end strips, with the pattern turned on them",
    coordinates=(
        Variable("variant", ("variant",), "text", "", "energy of a curvature tensor"),
        *_strips((), ("direction",)),
    ),
    variables=(
        *_response(_TURNED),
        _steepest(_TURNED),
        _number(
            "law_energy_density",
            _TURNED,
            "N mm-1",
            "energy per area of the model bent to the cylinder everywhere",
        ),
    ),
)

NATIVE_SHEET = Schema(
    "native_sheet",
    1,
    "Rectangular sheet of whole and cut scales, bent between two end strips",
    coordinates=_strips(("curvature",), ()),
    variables=(
        *_response(_BENT),
        _number("min_gap", _BENT, "mm", "smallest distance between scales"),
        _count("contact_pairs", _BENT, "active contact pairs"),
        *_SIZES,
    ),
)


def _of_device(device: str, part: str, axis: str, *own: tuple[str, str, str]) -> Measured:
    """Variables of one device over side and its own axis; a dataset has all of them or none."""
    dims = ("side", axis)
    common = (
        ("energy", "N mm", f"elastic energy of the {part}"),
        ("largest_curvature", "mm-1", f"largest principal curvature in the {part}"),
    )
    numbers = tuple(
        Variable(f"{device}_{name}", dims, "float64", units, long_name, True)
        for name, units, long_name in (*own, *common)
    )
    counts = tuple(
        Variable(f"{device}_{name}", dims, "int32", "1", f"{long_name}, {part}", True)
        for name, long_name in _COUNTS
    )
    end = f"end of the solve, {part}"
    status = Variable(f"{device}_status", dims, "int8", "1", end, True, STATUS_ATTRS)
    return (*numbers, *counts, status)


def _size(name: str, units: str, long_name: str) -> Variable:
    return Variable(name, (), "float64", units, long_name, True)


_STRIP = (
    _number("stage_length", (), "mm", "length of the strip between its hinges"),
    _number("stage_width", (), "mm", "width of the strip"),
    _number(
        "stage_direction", (), "degree", "direction of the length in the pattern's coordinates"
    ),
)
#: Device -> its axis, sizes and variables; a dataset of kind rig has one device or both.
DEVICE_COORDINATES = {
    "mandrel": (
        Variable("angle", ("angle",), "float64", "degree", "angle around the rim", True),
        _size("mandrel_radius", "mm", "radius of the disc"),
        _size("mandrel_hub", "mm", "radius of the hub that holds the disc"),
        _size("mandrel_indentation", "mm", "indentation of the rim, normal to the disc"),
    ),
    "stage": (
        Variable("shortening", ("shortening",), "float64", "mm", "shortening of the strip", True),
        *(replace(item, optional=True) for item in _STRIP),
    ),
}
DEVICE_VARIABLES = {
    "mandrel": _of_device("mandrel", "disc", "angle", ("force", "N", "force of the probe")),
    "stage": _of_device(
        "stage",
        "strip",
        "shortening",
        ("force", "N", "force on the hinges"),
        ("deflection", "mm", "deflection of the middle, to the outer side of the arc"),
    ),
}

RIG = Schema(
    "rig",
    1,
    "Macro model on the testing devices: disc on the mandrel, strip on the stage",
    coordinates=(_SIDE, *DEVICE_COORDINATES["mandrel"], *DEVICE_COORDINATES["stage"]),
    variables=(*DEVICE_VARIABLES["mandrel"], *DEVICE_VARIABLES["stage"]),
)

NATIVE_RIG = Schema(
    "native_rig",
    1,
    "Strip of whole and cut scales on the stage",
    coordinates=(
        _SIDE,
        _number("shortening", ("shortening",), "mm", "shortening of the strip"),
        *_STRIP,
    ),
    variables=(
        _number("stage_force", _SHORTENED, "N", "force on the hinges"),
        _number("stage_energy", _SHORTENED, "N mm", "elastic energy of the strip"),
        _number(
            "stage_deflection", _SHORTENED, "mm",
            "deflection of the middle, to the outer side of the arc",
        ),
        _number("stage_min_gap", _SHORTENED, "mm", "smallest distance between scales"),
        *(
            Variable(f"stage_{name}", _SHORTENED, "int32", "1", f"{long_name}, strip")
            for name, long_name in (*_COUNTS, ("contact_pairs", "active contact pairs"))
        ),
        Variable(
            "stage_status", _SHORTENED, "int8", "1", "end of the solve, strip", attrs=STATUS_ATTRS
        ),
        *_SIZES,
    ),
)  # fmt: skip
