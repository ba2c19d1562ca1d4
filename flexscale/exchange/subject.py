"""What is exported: a dataset, a tangent or a model, as the formats need it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from flexscale.datasets.given import read_labels, require_variables
from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.errors import BadInputError, shown
from flexscale.exchange.laminate import Laminate

if TYPE_CHECKING:
    from flexscale.macro.bending_model import BendingModel
    from flexscale.macro.model import MacroModel

KINDS = ("fit", "gap_model", "tangent", "tensor_model")
_HOW = (
    "give a dataset of kind fit, gap_model, tensor_model or tangent, or what fs.fit, "
    "fs.gap_model, fs.tensor_model or fs.tangent_stiffness returns"
)


@dataclass(frozen=True)
class Subject:
    """A sheet to be written for others.

    Attributes
    ----------
    source : what it is of, for people: "fit:69208323d680".
    labels : pattern, family, sizes [mm], materials [MPa].
    laminate : stiffness at rest; None where it is not known.
    model : law of any curvature; None for a tangent.
    """

    source: str
    labels: Mapping[str, float | str]
    laminate: Laminate | None = None
    model: MacroModel | BendingModel | None = None

    @property
    def name(self) -> str:
        """An identifier of programming languages: flexscale_IH20_hexagon."""
        parts = (str(self.labels.get(key, "custom")) for key in ("family", "pattern"))
        return re.sub(r"\W", "_", "_".join(("flexscale", *parts)), flags=re.ASCII)

    @property
    def thickness(self) -> float | None:
        """mm, of the soft sheet without its scales; None where it is not known."""
        found = self.labels.get("substrate_thickness")
        return None if found is None else float(found)

    def title(self) -> str:
        """What it is, and of which sheet, in one line."""
        sizes = (
            ("gap", "gap", "mm"),
            ("scale_height", "scales high", "mm"),
            ("substrate_thickness", "sheet thick", "mm"),
            ("substrate_young_modulus", "modulus of the sheet", "MPa"),
        )
        told = [
            f"{what} {float(self.labels[key]):g} {unit}"
            for key, what, unit in sizes
            if key in self.labels
        ]
        who = " ".join(str(self.labels[key]) for key in ("family", "pattern") if key in self.labels)
        return ", ".join([f"{self.source}: {who or 'custom'}", *told])

    def require_laminate(self, what: str) -> Laminate:
        """The stiffness at rest, or a refusal."""
        if self.laminate is None:
            raise BadInputError(
                f"{what} needs the stiffness of the flat cell, which {self.source} does not know: "
                "fit it again with fs.fit(sweep, tangent=fs.tangent_stiffness(pattern))."
            )
        return self.laminate

    def require_model(self, what: str) -> MacroModel | BendingModel:
        """The law, or a refusal."""
        if self.model is None:
            raise BadInputError(
                f"{what} needs a law of any curvature, and {self.source} is the stiffness at rest "
                "alone: give a fit, a gap model or a tensor model (fs.fit, fs.gap_model, "
                "fs.tensor_model), or export it as "
                "laminate-json, abaqus or calculix."
            )
        return self.model


def read_subject(given: Any) -> Subject:
    """What a caller wants to export.

    Raises
    ------
    BadInputError : something that is neither a stiffness nor a law, or a stiffness that is not
        positive.
    SchemaError : a dataset of the right kind with values that it cannot have.
    """
    if isinstance(given, xr.Dataset):
        return _of_dataset(given)
    if hasattr(given, "sheet_law"):
        return _of_model(given, f"a {type(given).__name__}")
    if hasattr(given, "matrix") and hasattr(given, "in_plane"):
        return Subject("a tangent", {}, _of_tangent(given, given.coupling))
    raise BadInputError(f"{shown(given)} ({type(given).__name__}) cannot be exported: {_HOW}.")


def _of_dataset(dataset: xr.Dataset) -> Subject:
    kind = str(dataset.attrs.get("flexscale_kind", ""))
    if kind not in KINDS:
        what = f"A dataset of kind {kind}" if kind else "A dataset that says no kind"
        hint = "fit the sweep first; fs.fit(sweep) makes a law; " if kind == "sweep" else ""
        raise BadInputError(f"{what} has neither stiffness nor law to export: {hint}{_HOW}.")
    digest = str(dataset.attrs.get("flexscale_recipe_digest", ""))[:SHORT_DIGEST]
    source = f"{kind}:{digest}" if digest else f"a dataset of kind {kind}"
    if kind == "tangent":
        require_variables(dataset, ("matrix", "in_plane"), "An export", "tangent")
        coupling = dataset["coupling"].values if "coupling" in dataset else None
        return Subject(source, read_labels(dataset), _of_tangent(dataset, coupling))
    if kind == "fit":
        from flexscale.macro.model import MacroModel

        return _of_model(MacroModel.from_dataset(dataset), source)
    if kind == "tensor_model":
        from flexscale.macro.tensor_model import TensorModel

        return _of_model(TensorModel.from_dataset(dataset), source)
    from flexscale.macro.gap_model import GapModel

    return _of_model(GapModel.from_dataset(dataset), source)


def _of_tangent(tangent: Any, coupling: Any) -> Laminate:
    from flexscale.macro.rest_stiffness import read_rest_stiffness

    return _laminate(*read_rest_stiffness(tangent), coupling)


def _of_model(model: Any, source: str) -> Subject:
    known = model.tangent is not None and model.in_plane is not None
    laminate = _laminate(model.tangent, model.in_plane, None) if known else None
    return Subject(source, model.labels, laminate, model)


def _laminate(bending: Any, in_plane: Any, coupling: Any) -> Laminate:
    """From curvatures that close to those of a laminate: B changes its sign."""
    b = None if coupling is None else -np.asarray(coupling, dtype=float)
    return Laminate(np.asarray(in_plane, dtype=float), np.asarray(bending, dtype=float), b)
