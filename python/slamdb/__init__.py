# SPDX-License-Identifier: BSD-3-Clause
"""Maps of visual SLAM: read, checked, repaired, merged and written, of ORB-SLAM3 and many other programs.

    atlas = slamdb.read("map.osa")
    points = atlas.maps[0].points.positions     # (N, 3) float32, over the memory of the atlas
    points *= 2                                 # writes to the atlas
    slamdb.write(atlas, "twice.osa")

Arrays are views: they share the memory of the atlas and keep it alive. A verb that changes the atlas (repair, ...)
gives it new memory; arrays taken before keep showing the old one, and writing to them reaches the atlas no more.
Threads may read one atlas at the same time. The live map (slamdb::live) is for C++ alone.
"""

from ._slamdb import NONE, Atlas, Features, KeyFrame, KeyFrames, Map, MapPoint, Points
from ._slamdb import version as __version__
from .errors import (
    AccessDeniedError,
    AlreadyExistsError,
    DamagedError,
    Error,
    InternalError,
    LockedError,
    LossWarning,
    NotFoundError,
    NotPossibleError,
    OutOfResourcesError,
    SlamdbWarning,
    UnsupportedError,
    UsageError,
)
from .files import decode, encode, info, read, write
from .many import FoundAtlas, find_atlases, list_atlases, summarize, write_file
from .observations import Observations
from .report import CheckReport, Report
from .store import Store
from .verbs import check, diff, merge, recover, repair

__all__ = [
    "NONE", "Atlas", "Features", "KeyFrame", "KeyFrames", "Map", "MapPoint", "Points",
    "AccessDeniedError", "AlreadyExistsError", "DamagedError", "Error", "InternalError", "LockedError", "LossWarning",
    "NotFoundError", "NotPossibleError", "OutOfResourcesError", "SlamdbWarning", "UnsupportedError", "UsageError",
    "CheckReport", "Observations", "Report", "Store", "check", "decode", "diff", "encode", "info", "merge", "read", "recover", "repair", "write",
    "FoundAtlas", "find_atlases", "list_atlases", "summarize", "write_file",
]  # fmt: skip
