"""The native model by name, with all its options: one object from file to computation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from flexscale import checks
from flexscale.checks import checked, choice
from flexscale.errors import BadInputError, ConfigError, shown
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.solid_options import SolidOptions
from flexscale.solve.solver_options import SolverOptions

NATIVE_MODELS = ("shell", "solid")


@checked(
    name=choice("native model", NATIVE_MODELS),
    mesh=checks.MESH,
    substrate=checks.SUBSTRATE,
    scales=checks.SCALES,
    contact=checks.CONTACT,
    solver=checks.SOLVER,
    solid=checks.SOLID,
)
@dataclass(frozen=True)
class NativeModel:
    """How a pattern's scales and substrate are modeled, and how equilibria are sought.

    Attributes
    ----------
    name : "shell", the paper's: a shell in the gaps, clamped to scales of finite elements; or
        "solid": a solid everywhere, bonded to the scales' bases. Slow, and what others are held
        against.
    mesh : element sizes.
    substrate : elements of the substrate, if it is a shell.
    scales : how scales are modeled.
    contact : how scales touch.
    solver : how equilibria are sought.
    solid : how the substrate is graded, if it is a solid.
    """

    name: str = "shell"
    mesh: MeshOptions = field(default_factory=MeshOptions)
    substrate: SubstrateOptions = field(default_factory=SubstrateOptions)
    scales: ScaleOptions = field(default_factory=ScaleOptions)
    contact: ContactOptions = field(default_factory=ContactOptions)
    solver: SolverOptions = field(default_factory=SolverOptions)
    solid: SolidOptions = field(default_factory=SolidOptions)

    @property
    def solid_options(self) -> SolidOptions | None:
        """How a solid substrate is graded; None for a shell."""
        return self.solid if self.name == "solid" else None

    @property
    def without_contact(self) -> NativeModel:
        """The same with scales that pass through one another."""
        return replace(self, contact=ContactOptions(enabled=False))

    def to_config(self, *parts: str) -> dict[str, Any]:
        """Plain numbers and text by part, `parts` alone if given; `from_config` is the inverse.

        A shell's has neither its name nor what it does not use, as before there were others.
        """
        named = {} if self.name == "shell" else {"native": self.name}
        asked = [part for part in parts or PARTS if part != "solid"]
        used = asked if self.solid_options is None else [*asked, "solid"]
        return named | {part: getattr(self, part).to_config() for part in used}

    @classmethod
    def from_config(cls, config: Mapping[str, Any]) -> NativeModel:
        """The model of a configuration; parts that it does not name are the default.

        Raises
        ------
        ConfigError, UnitRangeError, UnknownNameError : an option is unknown or out of range.
        """
        if not isinstance(config, Mapping):
            raise ConfigError(
                f"A native model's configuration must be a dict, not {shown(config)}."
            )
        parts: dict[str, Any] = {}
        if "native" in config:
            parts["name"] = config["native"]
        for part in PARTS:
            if part in config:
                try:
                    parts[part] = PARTS[part](**config[part])
                except TypeError as error:  # a name that the options do not have, or no mapping
                    raise ConfigError(f"{part} is {shown(config[part])}: {error}.") from error
        return cls(**parts)


#: Options of a native model -> their class.
PARTS: dict[str, type[Any]] = {
    item.name: item.default_factory  # type: ignore[misc]
    for item in fields(NativeModel)
    if item.name != "name"
}


def native_model(value: Any, label: str = "model") -> NativeModel:
    """Check of a native model, which a name stands for with its default options."""
    if isinstance(value, NativeModel):
        return value
    if isinstance(value, str):
        return NativeModel(value)
    raise BadInputError(
        f'{label} must be a native model, not {shown(value)}: write model="shell", or '
        "model=fs.NativeModel(…)."
    )


def require_finite_sheet(model: NativeModel) -> None:
    """Refuse what a finite sheet does not compute, before anything is meshed.

    Raises
    ------
    ConfigError : a model, scales or a substrate that only a periodic cell has.
    """
    if model.name != "shell":
        raise ConfigError(
            f"A native sheet or stage is a shell, not a {model.name!r}: leave the native model at "
            "'shell'."
        )
    if model.scales.model != "modes":
        raise ConfigError(
            f"A native sheet or stage has scales of few modes, not {model.scales.model!r}: leave "
            "the model of the scales at 'modes'."
        )
    if model.substrate.element != "c1":
        raise ConfigError(
            f"A native sheet or stage has a substrate of smooth triangles, not "
            f"{model.substrate.element!r}: leave the element of the substrate at 'c1'."
        )
