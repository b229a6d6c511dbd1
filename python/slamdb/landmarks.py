# SPDX-License-Identifier: BSD-3-Clause
"""MRPT's landmarks: of map points, and back (docs/landmarks.md)."""

from typing import Optional

from . import _slamdb
from ._slamdb import Atlas
from .calls import Source, changed
from .errors import UsageError
from .files import Progress
from .report import Report


def landmarks_from_points(
    atlas: Atlas, *, sigma: float = 1, threads: int = 0, progress: Progress = None
) -> Report:
    """Make a landmark of every map point, with its covariance, in place.

    sigma: standard deviation of a keypoint at full size, pixels
    """
    return changed(_slamdb.landmarks_from_points, locals())


def landmarks_to_points(source: Source, *, into: Optional[Atlas] = None, add: bool = False) -> Report:
    """Make map points of landmarks, in place; points without observations are for viewers and exports.

    into: lay the landmarks of the source onto this atlas instead, of whose points they were made: it is changed
    add: with into: make points of landmarks that it does not have
    """
    if into is not None:
        return changed(_slamdb.lay_landmarks, {"landmarks": source, "add": add, "atlas": into})
    if add:
        raise UsageError("add= goes with into=")
    if not isinstance(source, Atlas):
        raise TypeError("without into=, an Atlas is changed in place: read it first")
    return changed(_slamdb.landmarks_to_points, {"atlas": source})
