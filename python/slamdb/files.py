# SPDX-License-Identifier: BSD-3-Clause
"""Reading and writing atlases in every format of slamdb."""

import os
import sys
import warnings
from typing import Callable, List, Optional, Sequence, Tuple, Union

from . import _slamdb
from ._slamdb import Atlas
from .errors import LossWarning, SlamdbWarning
from .report import Report
from .words import in_python_words

Path = Union[str, "os.PathLike[str]"]
Progress = Optional[Callable[[str, float], object]]  # progress(stage, fraction)
Range = Optional[Tuple[float, float]]
Box = Optional[Tuple[Sequence[float], Sequence[float]]]


def told(notices: List[Tuple[str, str]]) -> None:
    """Warns of losses and warnings where the package was called."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        level, frame = level + 1, frame.f_back
    kinds = {"loss": LossWarning, "warning": SlamdbWarning}
    for kind, text in notices:
        if kind in kinds:
            warnings.warn(in_python_words(text), kinds[kind], stacklevel=level)


def read(
    source: Union[Path, bytes],
    *,
    format: str = "",
    layout: Optional[Path] = None,
    map: Optional[int] = None,
    keyframes: Optional[Tuple[int, int]] = None,
    time: Range = None,
    box: Box = None,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Atlas:
    """Read an atlas: of ORB-SLAM3 and its forks, of a store (`maps.db#lab`), or of another program.

    source: a path, `postgresql://user@host/database#name` as a str, or the bytes of a file, as `encode` gives them
    format: its id (docs/formats.md); by default the content tells
    layout: of an .osa file of a fork of ORB-SLAM3, by id or as a JSON file; by default the content tells
    map: only the map of this id
    keyframes: only those with ids from the first to the last
    time: only keyframes from the first to the last second
    box: only points inside, ((x, y, z), (x, y, z)) in the world
    wait: seconds, for another program that writes to the store
    threads: 0: every core
    progress: called as progress(stage, fraction) now and then

    A part of an atlas is for looking at: references to what was left out stay, and writing it is a LossWarning.
    Warns of what is unusual (SlamdbWarning). Raises Error: NotFoundError, DamagedError, UnsupportedError, ...
    """
    given = locals()
    atlas, notices = _slamdb.read(given.pop("source"), given)
    told(notices)
    return atlas


def write(
    atlas: Atlas,
    path: Path,
    *,
    format: str = "",
    layout: Optional[Path] = None,
    overwrite: bool = False,
    strict: bool = False,
    sync: bool = True,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> None:
    """Write an atlas, whole or not at all.

    format: its id; by default the suffix tells (.osa, .db, .ply, .tum, ...); `convert` has options of formats
    layout: write an .osa file of a fork of ORB-SLAM3, "v1.0" that of ORB-SLAM3; by default as it was read
    overwrite: replace what is there
    strict: raise NotPossibleError, and write nothing, where the format cannot hold all of the atlas;
        otherwise what is lost is named (LossWarning), but of exports, which are meant to leave out the rest:
        points, scenes, tables, graphs and trajectories (docs/formats.md; .ply, .glb, .csv, .g2o, .tum, ...)
    sync: wait for the disk; wait: seconds, for another program that writes to the store
    """
    given = locals()
    told(_slamdb.write(given.pop("atlas"), given.pop("path"), given))


def encode(
    atlas: Atlas,
    *,
    format: str = "orbslam3",
    layout: Optional[Path] = None,
    strict: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> bytes:
    """The bytes of the file that `write` would write."""
    given = locals()
    data, notices = _slamdb.encode(given.pop("atlas"), given)
    told(notices)
    return data


def info(
    path: Path, *, format: str = "", layout: Optional[Path] = None, threads: int = 0, progress: Progress = None
) -> Report:
    """What is in an atlas, as `slamdb info --json` tells: maps, sensors, distributions, sizes.

    format, layout: as for `read`
    """
    given = locals()
    report, notices = _slamdb.info(given.pop("path"), given)
    told(notices)
    return Report.parse(report)
