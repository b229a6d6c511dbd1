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

from ._slamdb import NONE, Atlas, Edit, Features, Journal, KeyFrame, KeyFrames, Landmarks, Map, MapPoint, Points
from ._slamdb import version as __version__
from .aligning import align, locate, merge
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
from .evaluating import evaluate
from .features import FeatureArrays
from .files import encode, info, read, write
from .frames import transform
from .graphs import Connections
from .ids import reassign_origin, renumber
from .imu import ImuArrays
from .landmarks import landmarks_from_points, landmarks_to_points
from .layouts import layouts_from_source, layouts_infer, layouts_list, layouts_show
from .many import FoundAtlas, find_atlases, list_atlases, summarize, sync, write_file
from .memory import set_memory_limit, spilled
from .notebook import View, view
from .observations import Observations
from .optimizing import close_loops, optimize
from .outputs import Page, convert, plot, report, synthesize
from .parts import cull, extract, fragments, shrink, split
from .report import CheckReport, Report
from .store import Store
from .verbs import check, diff, edit_tables, recover, repair
from .vocabulary import vocabulary_recompute, vocabulary_set, vocabulary_show, vocabulary_verify

__all__ = [
    "NONE", "Atlas", "Edit", "FeatureArrays", "Features", "ImuArrays", "Journal", "KeyFrame", "KeyFrames", "Landmarks", "Map",
    "MapPoint", "Points",
    "AccessDeniedError", "AlreadyExistsError", "DamagedError", "Error", "InternalError", "LockedError", "LossWarning",
    "NotFoundError", "NotPossibleError", "OutOfResourcesError", "SlamdbWarning", "UnsupportedError", "UsageError",
    "CheckReport", "Connections", "FoundAtlas", "Observations", "Page", "Report", "Store", "View",
    "encode", "find_atlases", "info", "list_atlases", "read", "set_memory_limit", "spilled", "summarize", "view", "write",
    "write_file",
    "align", "check", "close_loops", "convert", "cull", "diff", "edit_tables", "evaluate", "extract", "fragments",
    "landmarks_from_points", "landmarks_to_points", "layouts_from_source", "layouts_infer", "layouts_list", "layouts_show",
    "locate", "merge", "optimize", "plot", "reassign_origin", "recover", "renumber", "repair", "report", "shrink", "split",
    "sync", "synthesize", "transform", "vocabulary_recompute", "vocabulary_set", "vocabulary_show", "vocabulary_verify",
]  # fmt: skip
