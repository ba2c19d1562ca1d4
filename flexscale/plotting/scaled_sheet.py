"""A deformed sheet with its scales, in space."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from flexscale.checks import checked, having, point
from flexscale.plotting.raster import Surfaces, View
from flexscale.plotting.scene import draw_panel, draw_ruler, half_window
from flexscale.plotting.style import (
    FAILED_COLOR,
    PAGE_WIDTH,
    SCALE_COLOR,
    SUBSTRATE_COLOR,
    flexscale_style,
    new_figure,
)

_VIEW = (-118.0, 35.0)  # degree: into the arc, which is bent along x and rises where it closes
_TALLEST = 0.75  # height of a picture over the width of the page


class SurfacesOfScales(Protocol):
    """What `fs.synthesize_scales` and `fs.deform_native_sheet` give.

    vertices (n, 3) mm; triangles (m, 3); triangle_scale (m,), -1 of the sheet; overlapping (k,)
    scales; title.
    """

    @property
    def vertices(self) -> np.ndarray: ...
    @property
    def triangles(self) -> np.ndarray: ...
    @property
    def triangle_scale(self) -> np.ndarray: ...
    @property
    def overlapping(self) -> np.ndarray: ...
    @property
    def title(self) -> str: ...


@checked(
    shape=having("write", remedy="what fs.synthesize_scales or fs.deform_native_sheet gives"),
    view=point("degree"),
)
def scaled_sheet(shape: SurfacesOfScales, *, view: tuple[float, float] = _VIEW) -> Figure:
    """Deformed sheet with its scales in 3-D; scales that overlap stand out.

    Parameters
    ----------
    shape : as `fs.synthesize_scales` or `fs.deform_native_sheet` gives it.
    view : azimuth and elevation of the camera, degree.

    Returns
    -------
    Figure; equal lengths on both axes, with a bar for scale.
    """
    camera = View(*view)
    scale = shape.triangle_scale
    kind = np.where(scale < 0, 0, np.where(np.isin(scale, shape.overlapping), 2, 1))
    palette = np.array([to_rgb(c) for c in (SUBSTRATE_COLOR, SCALE_COLOR, FAILED_COLOR)])
    corners = camera.project(shape.vertices)[shape.triangles]
    surfaces = Surfaces(corners, palette[kind], scale, scale >= 0)
    half = half_window([surfaces])
    with flexscale_style():
        width = PAGE_WIDTH * min(1.0, _TALLEST * half[0] / half[1])
        figure = new_figure(PAGE_WIDTH, width * half[1] / half[0] + 0.7)
        axes = figure.add_subplot()
        draw_panel(axes, surfaces, half, width)
        draw_ruler(axes, camera, half)
        labels = ("substrate", "scales", "scales that overlap")
        shown = [Patch(color=palette[k], label=labels[k]) for k in np.unique(kind)]
        figure.legend(handles=shown, loc="outside lower center", ncols=len(shown))
        figure.suptitle(shape.title)
    return figure
