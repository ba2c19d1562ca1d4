"""Where an outline crosses or touches itself."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray, IntArray

TOUCH = 1e-9  # closer points touch; outlines have about unit size


def outline_contacts(outline: FloatArray) -> tuple[IntArray, FloatArray]:
    """All pairs of segments that meet other than end to start.

    Segment i runs from point i to the next. Two of them cross where the ends of each lie on both
    sides of the other, and touch where an end of one, no end of the other, lies on it.

    Parameters
    ----------
    outline : (n, 2) points of a closed outline.

    Returns
    -------
    (k, 2) numbers of the segments, and (k, 2) points where they meet.
    """
    along = np.roll(outline, -1, axis=0) - outline
    arms = outline[None, :] - outline[:, None]  # [i, j]: from the start of segment i to point j
    crossed = along[:, None, 0] * arms[..., 1] - along[:, None, 1] * arms[..., 0]
    here = np.arange(len(outline))
    after = (here + 1) % len(outline)

    lengths = np.maximum(np.einsum("ij,ij->i", along, along), TOUCH**2)
    places = np.clip(np.einsum("ijk,ik->ij", arms, along) / lengths[:, None], 0.0, 1.0)
    apart = np.linalg.norm(arms - places[..., None] * along[:, None], axis=2)
    apart[here, here] = apart[here, after] = np.inf
    touching = np.argwhere(apart < TOUCH)

    splits = crossed * np.roll(crossed, -1, axis=1) < 0.0
    crossing = splits & splits.T
    crossing[here, here] = crossing[here, after] = crossing[after, here] = False
    pairs = np.argwhere(np.triu(crossing))
    first, second = pairs.T
    ends = crossed[first, second], crossed[first, after[second]]
    share = ends[0] / (ends[0] - ends[1])
    points = outline[second] + share[:, None] * along[second]
    return np.concatenate([touching, pairs]), np.concatenate([outline[touching[:, 1]], points])
