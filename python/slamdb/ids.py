# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that change ids."""

from typing import Mapping, Optional, Sequence

from . import _slamdb
from ._slamdb import Atlas
from .calls import changed
from .files import Path, Progress
from .report import Report


def renumber(
    atlas: Atlas,
    *,
    kinds: Optional[Sequence[str]] = None,
    start: Optional[int] = None,
    offset: Optional[int] = None,
    order: Optional[str] = None,
    id_map: Optional[Path] = None,
    apply: Optional[Path] = None,
    undo: Optional[Path] = None,
    of: str = "",
    overwrite: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Give entities new ids, in place: dense ones, or the old ones plus an offset (docs/renumber.md).

    kinds: of "map", "keyframe", "point", "frame", "camera", "all"; by default all but frames
    start: the first of the dense ids, 0; order: of them, "id" (the default), "time" or "as-is"; offset: added to every id instead
    id_map: write which id became which to this .csv or .json; overwrite: replace it
    apply, undo: change ids as such a table says, or back; of: which of its inputs it is about
    """
    return changed(_slamdb.renumber, locals())


def reassign_origin(
    atlas: Atlas,
    *,
    from_map: bool = False,
    set: Optional[int] = None,
    map: Optional[Mapping[int, int]] = None,
    shift: int = 0,
    compact: bool = False,
) -> Report:
    """Change in which map keyframes were made, in place (docs/renumber.md), in this order:

    from_map: in the map that they are in now; set: in the map of this id
    map: {from: to}, all at once; shift: added to every origin; compact: 0, 1, 2, ... in their order
    Raises UsageError where there is nothing to do.
    """
    return changed(_slamdb.reassign_origin, locals())
