# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that move maps into another world frame."""

import os
from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple, Union

from . import _slamdb
from ._slamdb import Atlas
from .calls import Ids, Source, changed
from .files import Path, Progress
from .report import Report

if TYPE_CHECKING:
    import numpy as np

Transform = Union[Path, Sequence[float], "np.ndarray[Any, Any]"]


def transform_text(transform: Optional[Transform]) -> Optional[Path]:
    """Numbers as text; a text, or the path of one, as it is."""
    if transform is None or isinstance(transform, (str, os.PathLike)):
        return transform
    import numpy as np

    return " ".join(repr(float(number)) for number in np.asarray(transform, dtype=float).ravel())


def transform(
    atlas: Atlas,
    *,
    by: Optional[Transform] = None,
    scale: Optional[float] = None,
    axes: str = "",
    gravity: Optional[str] = None,
    onto: Optional[Source] = None,
    georeference: Optional[Path] = None,
    map: Ids = None,
    max_dt: Optional[float] = None,
    robust: Optional[float] = None,
    time_offset: float = 0,
    estimate_time_offset: bool = False,
    time_unit: Optional[str] = None,
    times: Optional[Path] = None,
    with_scale: bool = False,
    without_scale: bool = False,
    body: bool = False,
    origin: Union[str, Tuple[float, ...], None] = None,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Move, turn, scale, align or georeference maps, in place (docs/transform.md). One of these:

    by: x' = scale R x + t, as (tx, ty, tz, qx, qy, qz, qw[, scale]), a (3, 4) or (4, 4) matrix, text or
        a file of these
    scale: multiplies all lengths; axes: "camera:ros" and the like, or "x,-z,y"
    gravity: turn up to +z; told by "inertia", "cameras", "path", or "auto", the best of them
    onto: a trajectory or another atlas, by time
    georeference: a file of GPS fixes; the result is east, north, up in metres from `report.georeference`

    map: only maps of these ids
    For onto and georeference:
    max_dt: seconds that a keyframe and a position may be apart; 0.02, or 1 for GPS, by default
    robust: leave out pairs that end up farther apart, metres; by default gross outliers alone
    time_offset: seconds that the clock of the reference is ahead; estimate_time_offset: find it
    time_unit: of the reference: "s", "ms", "us", "ns"; times: the file of times of a KITTI trajectory
    with_scale, without_scale: solve for the scale, or not; by default where the sensor leaves it open
    body: the positions are the IMU's, not the camera's
    origin: of the georeferenced frame, "LAT,LON[,ALT]" or (lat, lon[, alt]), degrees and metres
    """
    given = locals()
    given["by"] = transform_text(by)
    if isinstance(origin, tuple):
        given["origin"] = ",".join(repr(float(number)) for number in origin)
    return changed(_slamdb.transform, given)
