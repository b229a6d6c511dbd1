# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that keep a part of an atlas, and close what leads out of it: references, the spanning tree, the graph."""

from typing import Dict, Optional, Sequence, Tuple

from . import _slamdb
from ._slamdb import Atlas
from .calls import Ids, Source, changed
from .files import Box, Path, Progress, Range, told
from .report import Report


def extract(
    atlas: Atlas,
    *,
    map: Optional[int] = None,
    keyframes: Optional[Tuple[int, int]] = None,
    time: Range = None,
    box: Box = None,
    keyframe: Ids = None,
    polygon: Optional[Sequence[Tuple[float, float]]] = None,
    plane: str = "auto",
    region: str = "both",
    session: Optional[int] = None,
    component: Optional[int] = None,
    every: int = 1,
    except_: bool = False,
    border: str = "smart",
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Keep a part of the atlas, in place (docs/extract.md). What is selected is what all of these allow.

    map: of this id; keyframes: ids from the first to the last; keyframe: exactly these ids
    time: keyframes from the first to the last second
    box: inside ((x, y, z), (x, y, z)) in the world of the map
    polygon: inside this outline on the plan, [(x, y), ...], three corners or more
    plane: of the polygon: "auto" (level, as the map tells), "xy", "xz" or "yz"
    region: whether box and polygon cut by "cameras", by "points", or "both"
    session: keyframes made in the map of this id; component: of the covisibility graph, 1 the largest
    every: the first of so many keyframes, by time
    except_: everything but that
    border: of points that are seen from outside, too: "smart", "strict" or "complete-points"

    Raises NotFoundError and NotPossibleError where nothing is in the part, UsageError.
    """
    return changed(_slamdb.extract, locals())


def cull(
    atlas: Atlas,
    *,
    redundant: Optional[float] = None,
    observers: int = 3,
    min_observations: Optional[int] = None,
    max_error: Optional[float] = None,
    min_parallax: Optional[float] = None,
    unseen_since: Optional[float] = None,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Remove redundant keyframes and poor points, in place (docs/cull.md); without a rule, by ORB-SLAM3's.

    redundant: keyframes of whose points more than this share is seen by `observers` others; 0: the sensor's usual share
    min_observations: points with fewer; 0: the sensor's usual number
    max_error: points with a larger reprojection error, root mean square, pixels of the keypoint's octave
    min_parallax: points without depth that no two keyframes see from directions so many degrees apart
    unseen_since: points that no keyframe observes at or after this second
    """
    return changed(_slamdb.cull, locals())


def shrink(
    atlas: Atlas,
    *,
    target_mb: Optional[float] = None,
    target_keyframes: Optional[int] = None,
    for_: Optional[str] = None,
    largest_map: bool = False,
    min_points: int = 50,
    vocabulary: Optional[Path] = None,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Make the atlas small and keep the places that it covers, in place (docs/cull.md).

    target_mb: at most so many millions of bytes as .osa file; target_keyframes: at most so many
    for_: "localization" drops what only mapping needs; "mapping" keeps it, however few bytes are asked for
    largest_map: only the map with most keyframes stays
    min_points: with which a camera is found, and a place covered
    vocabulary: file of the words; those that cannot be of it are computed anew

    `report.coverage` and `report.found` tell what is still found. Raises UsageError where nothing is asked for.
    """
    return changed(_slamdb.shrink, locals())


def fragments(
    atlas: Atlas,
    *,
    min_keyframes: int = 1,
    largest: Optional[int] = None,
    order: str = "as-is",
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Drop empty and small maps, and order the others, in place (docs/fragments.md).

    min_keyframes: maps with fewer go; largest: only so many stay, those with most keyframes
    order: "as-is", "size" (most keyframes first), "time" (earliest first) or "id"
    """
    return changed(_slamdb.fragments, locals())


def split(
    source: Source,
    *,
    by: str = "map",
    min_keyframes: int = 1,
    border: str = "smart",
    threads: int = 0,
    progress: Progress = None,
) -> Tuple[Dict[str, Atlas], Report]:
    """Each map, session or component as an atlas of its own, by name ("map-0", ...); the source stays as it is.

    by: "map", "session" (the map in which keyframes were made) or "component" (of the covisibility graph)
    min_keyframes: parts with fewer are left out
    border: of points that several parts observe, as for `extract`
    """
    atlases, report, notices = _slamdb.split(locals())
    told(notices)
    return atlases, Report.parse(report)
