"""Pictures of the cell: bent in space with its lattice images, and the flat pattern from above.

A dataset holds one cell; its lattice images are rigid motions of it (`cell_geometry`), so a
picture shows as many as one likes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from flexscale.checks import DATASET, checked, point, whole
from flexscale.errors import BadInputError
from flexscale.plotting.cell_geometry import (
    SHAPE_VARIABLES,
    cell_offsets,
    pattern_surfaces,
    shape_surfaces,
)
from flexscale.plotting.raster import Surfaces, View, render
from flexscale.plotting.selection import require_variables, subject
from flexscale.plotting.style import (
    COLUMN_WIDTH,
    CONTACT_COLOR,
    FAILED_COLOR,
    PAGE_WIDTH,
    SCALE_COLOR,
    SUBSTRATE_COLOR,
    flexscale_style,
    new_figure,
    unit_text,
)
from flexscale.units import require_series, require_whole

# Camera beside the cylinder's axis: the arc is seen from its end, the scales from above.
BESIDE_AXIS = -62.0  # degree from the bending direction
ELEVATION = 30.0  # degree
_PIXELS_PER_INCH = 300.0
_MAX_PANELS = 4


@checked(shape=DATASET, n_cells=whole(1, 100, "n_cells"), view=point("degree"))
def cell(
    shape: xr.Dataset,
    samples: int | Sequence[int] | None = None,
    *,
    n_cells: int = 3,
    view: tuple[float, float] | None = None,
) -> Figure:
    """Deformed cell with its lattice images in 3-D, one panel per sample.

    Parameters
    ----------
    shape : dataset of kind shape/1.
    samples : positions along the dataset's `sample` axis, for instance [0, 2] for two curvatures
        side by side; None takes all, four at most.
    n_cells : number of cells drawn along each lattice vector.
    view : azimuth and elevation of the camera in degree; None looks beside the cylinder's axis
        of the first sample, so that its arc is seen. All panels share view and length scale.

    Returns
    -------
    Figure; equal lengths on both axes, with a bar for scale.

    Raises
    ------
    BadInputError : a sample the dataset does not have, or more than four; n_cells below 1.
    SchemaError : not a shape dataset.
    """
    require_variables(shape, SHAPE_VARIABLES, "A picture of the deformed cell")
    chosen = _pick_samples(shape, samples)
    offsets = cell_offsets(n_cells)
    direction = float(shape["sample_direction"].values[chosen[0]])
    camera = View(*view) if view is not None else View(direction + BESIDE_AXIS, ELEVATION)
    panels = [shape_surfaces(shape, sample, offsets, camera) for sample in chosen]
    half = half_window(panels)
    with flexscale_style():
        width = min(PAGE_WIDTH, COLUMN_WIDTH * len(chosen))
        panel_width = width / len(chosen)
        figure = new_figure(width, panel_width * half[1] / half[0] + 0.85)
        for column, (sample, surfaces) in enumerate(zip(chosen, panels, strict=True)):
            axes = figure.add_subplot(1, len(chosen), column + 1)
            draw_panel(axes, surfaces, half, panel_width)
            axes.set_title(sample_title(shape, sample))
            if column == 0:
                draw_ruler(axes, camera, half)
        handles = [
            Patch(color=SCALE_COLOR, label="scales"),
            Patch(color=SUBSTRATE_COLOR, label="substrate"),
        ]
        if "contact_force" in shape:
            handles.append(Patch(color=CONTACT_COLOR, label="pressed by another scale"))
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=len(handles),
            title=f"strong: one unit cell; pale: {len(offsets) - 1} lattice images of it",
            title_fontsize=6,
        )
        figure.suptitle(subject(shape))
    return figure


def draw_pattern(axes: Axes, cell_dataset: xr.Dataset, n_cells: int = 3) -> None:
    """Flat pattern from above, scales on substrate, with the x direction pointing right.

    Parameters
    ----------
    axes : plain axes; their frame is removed.
    cell_dataset : dataset of kind cell/1.
    n_cells : number of cells along each lattice vector.
    """
    surfaces = pattern_surfaces(cell_dataset, n_cells)
    flat = surfaces.corners
    low, high = flat.min(axis=(0, 1))[:2], flat.max(axis=(0, 1))[:2]
    window = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
    pixels_per_mm = 600.0 / float(np.max(high - low))
    _show(axes, render(surfaces, window, pixels_per_mm, shaded=False), window)


def _pick_samples(shape: xr.Dataset, samples: int | Sequence[int] | None) -> list[int]:
    n_samples = shape.sizes["sample"]
    if samples is None:
        return list(range(min(n_samples, _MAX_PANELS)))
    asked = require_series(samples, "samples", "1")
    chosen = [require_whole(sample, "sample", -n_samples, n_samples) for sample in asked]
    bad = [sample for sample in chosen if not -n_samples <= sample < n_samples]
    if bad or not chosen or len(chosen) > _MAX_PANELS:
        listed = "; ".join(f"{i}: {sample_title(shape, i)}" for i in range(min(n_samples, 12)))
        raise BadInputError(
            f"Cannot draw the samples {chosen}: choose one to {_MAX_PANELS} of the dataset's "
            f"{n_samples} ({listed})."
        )
    return [sample % n_samples for sample in chosen]


def sample_title(shape: xr.Dataset, sample: int) -> str:
    """Side, curvature and direction of a sample, as "closing 0.02 mm⁻¹, direction 90°"."""
    curvature = float(shape["sample_curvature"].values[sample])
    unit = unit_text(str(shape["sample_curvature"].attrs.get("units", "mm-1")))
    if curvature == 0.0:
        return "flat"
    direction = float(shape["sample_direction"].values[sample])
    side = "closing" if curvature > 0.0 else "opening"
    return f"{side} {abs(curvature):g} {unit}, direction {direction:g}°"


def half_window(panels: Sequence[Surfaces]) -> tuple[float, float]:
    """Half width and height (mm) of a window that holds any of the panels, centered."""
    sizes = [
        np.ptp(panel.corners[..., :2].reshape(-1, 2), axis=0)
        for panel in panels
        if len(panel.corners)
    ]
    width, height = 0.52 * np.max(sizes, axis=0) if sizes else (1.0, 1.0)
    return float(width), float(height)


def draw_panel(
    axes: Axes, surfaces: Surfaces, half: tuple[float, float], panel_width: float
) -> None:
    """Surfaces in a window of half sizes `half` (mm) around their middle, a cross without any.

    `panel_width` is in inch: about the width of the axes, for the resolution.
    """
    center = np.zeros(2)
    if len(surfaces.corners):
        flat = surfaces.corners[..., :2].reshape(-1, 2)
        center = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
        window = (-half[0], half[0], -half[1], half[1])
        corners = surfaces.corners - np.append(center, 0.0)
        centered = Surfaces(corners, surfaces.colors, surfaces.body, surfaces.solid)
        image = render(centered, window, _PIXELS_PER_INCH * panel_width / (2.0 * half[0]))
        _show(axes, image, window)
    else:
        axes.set_axis_off()
        axes.set_aspect("equal")
        axes.set(xlim=(-half[0], half[0]), ylim=(-half[1], half[1]))
        axes.text(0.0, 0.0, "×\nnot converged", color=FAILED_COLOR, ha="center", va="center")


def _show(axes: Axes, image: np.ndarray, window: tuple[float, float, float, float]) -> None:
    axes.imshow(np.clip(image, 0.0, 1.0), extent=window, interpolation="antialiased")
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_ruler(axes: Axes, camera: View, half: tuple[float, float]) -> None:
    """Bar of a round length and the three coordinate directions, in the lower left corner."""
    length = float(10.0 ** np.floor(np.log10(half[0])))
    corner = np.array([-half[0], -half[1]])
    axes.plot(corner[0] + np.array([0.0, length]), [corner[1]] * 2, color="0.2", linewidth=1.5)
    axes.text(
        corner[0] + length / 2,
        corner[1],
        f"{length:g} mm\n",
        ha="center",
        va="center",
        size=6,
        color="0.2",
    )
    # Low enough that the upward one ends inside of the window, however flat that is.
    low = min(0.78 * half[1], half[1] - 0.17 * half[0])
    origin = np.array([-0.92 * half[0], low])
    look = {"arrowstyle": "-|>", "lw": 0.6, "color": "0.2", "mutation_scale": 5}
    look |= {"shrinkA": 0, "shrinkB": 0}
    for name, direction in zip("xyz", camera.axes[:2].T, strict=True):
        tip, text = (origin + reach * half[0] * direction for reach in (0.11, 0.16))
        axes.annotate("", tuple(tip), tuple(origin), annotation_clip=False, arrowprops=look)
        axes.text(text[0], text[1], name, size=6, ha="center", va="center", color="0.2")
