"""Formats table-netcdf and table-csv: energy and moments on a grid of curvature tensors."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import xarray as xr

from flexscale.arrays import FloatArray
from flexscale.exchange.bending import (
    CONVENTIONS,
    bending_law,
    data_sentence,
    evaluate_bending,
    is_within_data,
)
from flexscale.exchange.subject import Subject

POINTS = 31  # along each axis, odd: the flat sheet is one of them
_MOMENTS = (
    "m_xx = dW/dk_xx, m_yy = dW/dk_yy and m_xy = 1/2 dW/dk_xy are moments per width in N, entries "
    "of a tensor: dW = m_xx dk_xx + m_yy dk_yy + 2 m_xy dk_xy"
)
_WITHIN = (
    "1 where both principal curvatures are within the data of the law, 0 where it extrapolates"
)
_AXES = ("k_xx", "k_yy", "k_xy")


def build_table(subject: Subject) -> xr.Dataset:
    """Energy W and moments m_xx, m_yy, m_xy over (k_xx, k_yy, k_xy), and whether data reach there.

    Each axis goes from minus to plus the largest curvature of the data.
    """
    model = subject.require_model("A table over curvatures")
    half = POINTS // 2
    axis = model.largest_curvature * np.arange(-half, half + 1) / half
    curvatures = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    energy, gradient = evaluate_bending(bending_law(model), curvatures)
    shape = (POINTS,) * 3
    values: dict[str, tuple[FloatArray, str, str]] = {
        "W": (energy, "N mm-1", "bending energy per rest area"),
        "m_xx": (gradient[:, 0], "N", "moment per width, dW/dk_xx"),
        "m_yy": (gradient[:, 1], "N", "moment per width, dW/dk_yy"),
        "m_xy": (0.5 * gradient[:, 2], "N", "twisting moment per width, 1/2 dW/dk_xy"),
        "within_data": (is_within_data(model, curvatures).astype(np.int8), "1", _WITHIN),
    }
    return xr.Dataset(
        {
            name: (_AXES, value.reshape(shape), {"units": units, "long_name": meaning})
            for name, (value, units, meaning) in values.items()
        },
        coords={
            name: (name, axis, {"units": "mm-1", "long_name": f"curvature tensor's {name[2:]}"})
            for name in _AXES
        },
        attrs={
            "Conventions": "CF-1.11",
            "title": "Bending law of a scaled sheet over curvature tensors",
            "source": subject.title(),
            "conventions": "; ".join([*CONVENTIONS, _MOMENTS]),
            "comment": data_sentence(model),
            "largest_curvature": float(model.largest_curvature),
        },
    )


def write_netcdf(subject: Subject, path: Path) -> None:
    """Write the table as netCDF-4."""
    build_table(subject).to_netcdf(path, engine="netcdf4", format="NETCDF4")


def write_csv(subject: Subject, path: Path) -> None:
    """Write one row a tensor, k_xy running fastest, below comments behind #."""
    table = build_table(subject)
    lines = [subject.title(), *CONVENTIONS, _MOMENTS, table.attrs["comment"], f"within: {_WITHIN}"]
    text = io.StringIO()
    text.writelines(f"# {line}\n" for line in lines)
    columns = [
        f"{name} [{item.attrs['units']}]" if item.attrs["units"] != "1" else str(name)
        for name, item in ((name, table[name]) for name in (*_AXES, *table.data_vars))
    ]
    frame = table.to_dataframe().reset_index()[[*_AXES, *table.data_vars]]
    frame.columns = columns
    frame.to_csv(text, index=False, lineterminator="\n")
    path.write_text(text.getvalue(), encoding="utf-8")
