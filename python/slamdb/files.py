# SPDX-License-Identifier: BSD-3-Clause
"""Reading and writing atlases in every format of slamdb."""

import os
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


def _told(notices: List[Tuple[str, str]], depth: int = 3) -> None:
    kinds = {"loss": LossWarning, "warning": SlamdbWarning}
    for kind, text in notices:
        if kind in kinds:
            warnings.warn(in_python_words(text), kinds[kind], stacklevel=depth)


def _part(map: Optional[int], keyframes: Optional[Tuple[int, int]], time: Range, box: Box) -> _slamdb.Part:
    part = _slamdb.Part()
    part.map, part.keyframes, part.time = map, keyframes, time
    part.box = None if box is None else (list(box[0]), list(box[1]))
    return part


def read(
    source: Union[Path, bytes],
    *,
    format: str = "",
    map: Optional[int] = None,
    keyframes: Optional[Tuple[int, int]] = None,
    time: Range = None,
    box: Box = None,
    threads: int = 0,
    progress: Progress = None,
) -> Atlas:
    """Read an atlas: of ORB-SLAM3 and its forks, of a store (`maps.db#lab`), or of another program.

    source: a path, or the bytes of a file, as `encode` gives them
    format: its id (docs/formats.md); by default the content tells
    map: only the map of this id
    keyframes: only those with ids from the first to the last
    time: only keyframes from the first to the last second
    box: only points inside, ((x, y, z), (x, y, z)) in the world
    threads: 0: every core
    progress: called as progress(stage, fraction) now and then

    A part of an atlas is for looking at: references to what was left out stay.
    Warns of what is unusual (SlamdbWarning). Raises Error: NotFoundError, DamagedError, UnsupportedError, ...
    """
    part = _part(map, keyframes, time, box)
    if isinstance(source, bytes):
        atlas, notices = _slamdb.decode(source, format, part, threads, progress)
    else:
        atlas, notices = _slamdb.read(os.fspath(source), format, part, threads, progress)
    _told(notices)
    return atlas


def write(
    atlas: Atlas,
    path: Path,
    *,
    format: str = "",
    overwrite: bool = False,
    strict: bool = False,
    sync: bool = True,
    threads: int = 0,
    progress: Progress = None,
) -> None:
    """Write an atlas, whole or not at all.

    format: its id; by default the suffix tells (.osa, .db, .ply, .tum, ...)
    overwrite: replace what is there
    strict: raise NotPossibleError, and write nothing, where the format cannot hold all of the atlas;
        otherwise what is lost is named (LossWarning)
    sync: wait for the disk
    """
    _told(_slamdb.write(atlas, os.fspath(path), format, overwrite, strict, sync, threads, progress))


def encode(
    atlas: Atlas, *, format: str = "orbslam3", strict: bool = False, threads: int = 0, progress: Progress = None
) -> bytes:
    """The bytes of the file that `write` would write."""
    data, notices = _slamdb.encode(atlas, format, strict, threads, progress)
    _told(notices)
    return data


def info(path: Path, *, format: str = "", threads: int = 0, progress: Progress = None) -> Report:
    """What is in an atlas, as `slamdb info --json` tells: maps, sensors, distributions, sizes."""
    report, notices = _slamdb.info(os.fspath(path), format, threads, progress)
    _told(notices)
    return Report.parse(report)
