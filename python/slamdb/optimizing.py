# SPDX-License-Identifier: BSD-3-Clause
"""Bundle adjustment and pose graphs. NotPossibleError where slamdb was built without Ceres."""

from typing import Optional

from . import _slamdb
from ._slamdb import Atlas
from .calls import Ids, changed
from .files import Path, Progress
from .report import Report


def optimize(
    atlas: Atlas,
    *,
    method: Optional[str] = None,
    map: Ids = None,
    constraints: Optional[Path] = None,
    iterations: Optional[int] = None,
    fix_poses: bool = False,
    fix_points: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Bundle adjustment of maps, in place (docs/optimize.md).

    method: "full", the default; "seam", around merge and loop edges; "pose-graph", the constraints alone
    map: only maps of these ids
    constraints: table of how keyframes really lie to each other: first,second,tx,ty,tz,qx,qy,qz,qw[,scale]
    iterations: at most so many steps in each round, 50 by default
    fix_poses: points alone move; fix_points: keyframes alone
    """
    return changed(_slamdb.optimize, locals())


def close_loops(
    atlas: Atlas,
    *,
    optimize: str = "full",
    map: Ids = None,
    own_vocabulary: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Find and close loops that SLAM missed, in place (docs/close-loops.md); what is not sure is reported alone.

    optimize: behind the pose graph, which closes them: "full" bundle adjustment, or "pose-graph", nothing more
    map: only in maps of these ids
    own_vocabulary: recognise places by a vocabulary trained on the map, not by the recorded words
    """
    return changed(_slamdb.close_loops, locals())
