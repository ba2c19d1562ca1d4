"""The native model by name, with all its options: one object from file to computation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

from flexscale import checks
from flexscale.checks import checked, choice, instance, optional
from flexscale.errors import BadInputError, ConfigError, shown
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.solid_options import SolidOptions
from flexscale.solve.solver_options import SolverOptions

if TYPE_CHECKING:
    from flexscale.mechanics.joint_law import JointLaw

NATIVE_MODELS = ("joints", "shell", "solid")
#: Options that a native model does not have: they must be left at their defaults.
_WITHOUT = {
    "joints": ("mesh", "substrate", "scales", "solid"),
    "shell": ("solid",),
    "solid": ("substrate",),
}
NAME = "native"  # what a configuration and an experiment file call a model's name


_LAW = instance("flexscale.mechanics.joint_law:JointLaw", "take fs.joint_law(pattern)")


def _laws(value: Any, label: str) -> Any:
    """Check of the law of joints, or of those of several gaps."""
    if isinstance(value, list | tuple) and value:
        return tuple(_LAW(item, label) for item in value)
    return _LAW(value, label)


@checked(
    name=choice("native model", NATIVE_MODELS),
    mesh=checks.MESH,
    substrate=checks.SUBSTRATE,
    scales=checks.SCALES,
    contact=checks.CONTACT,
    solver=checks.SOLVER,
    law=optional(_laws),
    solid=checks.SOLID,
)
@dataclass(frozen=True)
class NativeModel:
    """How a pattern's scales and substrate are modeled, and how equilibria are sought.

    Attributes
    ----------
    name : "joints", of what is printed: rigid scales on joints, whose law comes from a solid
        cross-section of the sheet between them; "shell", the paper's: a shell in the gaps,
        clamped to scales of finite elements, two to ten times stiffer where the gap is as wide as
        the sheet is thick; or "solid": a solid everywhere, bonded to the scales' bases, which is
        slow, and what others are held against.
    mesh : element sizes; not of joints.
    substrate : elements of the substrate, if it is a shell.
    scales : how scales are modeled; not of joints, whose law has the scales' rims.
    contact : how scales touch.
    solver : how equilibria are sought.
    solid : how the substrate is graded, if it is a solid.
    law : of joints, in place of that which gap, sheet and materials of the pattern make; of a
        pattern of several gaps a tuple, of the narrowest gap first.
    """

    name: str = "joints"
    mesh: MeshOptions = field(default_factory=MeshOptions)
    substrate: SubstrateOptions = field(default_factory=SubstrateOptions)
    scales: ScaleOptions = field(default_factory=ScaleOptions)
    contact: ContactOptions = field(default_factory=ContactOptions)
    solver: SolverOptions = field(default_factory=SolverOptions)
    solid: SolidOptions = field(default_factory=SolidOptions)
    law: JointLaw | tuple[JointLaw, ...] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if self.law is not None and self.name != "joints":
            raise ConfigError(f"The native model {self.name!r} has no joints: leave law out.")
        for part in _WITHOUT.get(self.name, ()):
            if getattr(self, part) != PARTS[part]():
                others = [name for name in NATIVE_MODELS[1:] if part not in _WITHOUT[name]]
                raise ConfigError(
                    f"The native model {self.name!r} has no {part}: leave {part} out, or say "
                    f'native "{others[0]}" (NativeModel("{others[0]}", {part}=…) in Python).'
                )

    @property
    def laws(self) -> tuple[JointLaw, ...]:
        """Of joints; none if those of the pattern are to be taken."""
        return self.law if isinstance(self.law, tuple) else (self.law,) if self.law else ()

    @property
    def input(self) -> str:
        """Step whose dataset it is made of."""
        return "joint" if self.name == "joints" else "cell"

    @property
    def solid_options(self) -> SolidOptions | None:
        """How a solid substrate is graded; None for a shell."""
        return self.solid if self.name == "solid" else None

    @property
    def without_contact(self) -> NativeModel:
        """The same with scales that pass through one another."""
        return replace(self, contact=ContactOptions(enabled=False))

    def to_config(self, parts: Sequence[str] | None = None) -> dict[str, Any]:
        """Name, and options by part, those of `parts` alone if given; plain numbers and text.

        Options that the model does not have are left out; so is the law, whose digest results tell.

        `from_config` is the inverse.
        """
        kept = [part for part in PARTS if part not in _WITHOUT.get(self.name, ())]
        kept = [part for part in kept if parts is None or part in parts]
        options = {part: getattr(self, part).to_config() for part in kept}
        return {NAME: self.name, **options}

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
        parts = {"name": config[NAME]} if NAME in config else {}
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
    if item.name not in ("name", "law")
}


def native_model(value: Any, label: str = "model") -> NativeModel:
    """Check of a native model, which a name stands for with its default options."""
    if isinstance(value, NativeModel):
        return value
    if isinstance(value, str):
        return NativeModel(value)
    raise BadInputError(
        f'{label} must be a native model, not {shown(value)}: write model="joints", or '
        "model=fs.NativeModel(…)."
    )


def require_joints(model: NativeModel, what: str = "Native sheets, stages and discs") -> None:
    """Refuse native models that something is not computed of, before anything is built.

    Parameters
    ----------
    what : for the message, several things.

    Raises
    ------
    ConfigError : a model other than that of joints.
    """
    if model.name != "joints":
        raise ConfigError(
            f"{what} are of scales on joints, not of the native model "
            f'{model.name!r}: say native: joints (model="joints" in Python).'
        )
