# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that write what is to be looked at, or used elsewhere. Files appear whole or not at all."""

import os
from typing import Dict, Mapping, Optional, Sequence, Tuple

from . import _slamdb
from ._slamdb import Atlas
from .calls import Source, held, made, name, reported
from .files import Box, Path, Progress, Range, _told
from .report import Report

_TOLD_AT = 3  # from the warning to who called


def convert(
    source: Source,
    output: Path,
    *,
    format: str = "",
    layout: Optional[Path] = None,
    to: str = "",
    text: bool = False,
    overwrite: bool = False,
    strict: bool = False,
    sync: bool = True,
    dry_run: bool = False,
    onto: Optional[Path] = None,
    map: Optional[int] = None,
    keyframes: Optional[Tuple[int, int]] = None,
    time: Range = None,
    box: Box = None,
    to_layout: Optional[Path] = None,
    boost_version: Optional[str] = None,
    long_bytes: Optional[int] = None,
    sanitize: bool = False,
    ascii: bool = False,
    body: bool = False,
    sim3: bool = False,
    time_unit: Optional[str] = None,
    times: Optional[Path] = None,
    color: Optional[str] = None,
    cameras: bool = False,
    origin: str = "",
    most_points: Optional[int] = None,
    images: Optional[Path] = None,
    with_database: bool = False,
    colmap_schema: Optional[str] = None,
    database: Optional[Path] = None,
    mrpt_own_slots: bool = False,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Write an atlas in another format, or as part (docs/formats.md). What the output cannot hold is a LossWarning.

    format, layout: of a source that is a path, which is told by its content; to: of the output, told by its suffix;
        text: short for to="orbslam3-text"
    overwrite: replace what is there; strict: refuse what does not hold all; sync: wait for the disk
    dry_run: say what would be written and lost, and write nothing
    onto: write this atlas with the poses and points of the source
    map, keyframes, time, box: of a source that is a path, as `read` takes them

    Archives of ORB-SLAM3: to_layout: of a fork; boost_version: that is to load it, "1.71", "noetic", "17";
        long_bytes: 4 for Windows; sanitize: repair what ORB-SLAM3 crashes on
    Points and poses: ascii: PLY and PCD as text; color: of points, by "map", "error", "observations", "height", "age";
        cameras: into PLY, too; body: trajectories of the IMU; sim3: g2o with scales; time_unit, times: of a trajectory
    Places: origin: "LAT,LON[,ALT]", where the frame begins; most_points: into KML and GeoJSON
    Reconstructions: images: folder or list of the picture files; with_database, colmap_schema ("old", "new"): COLMAP's
        database; database: of a model that is read
    mrpt_own_slots: ORB descriptors where MRPT 2 itself writes them
    wait: seconds, for another program that writes to the store
    """
    return Report.parse(reported(_slamdb.convert, locals()))


def plot(
    source: Source,
    output: Optional[Path] = None,
    *,
    kind: Optional[str] = None,
    picture: Optional[str] = None,
    width: int = 800,
    scale: float = 1,
    dark: bool = False,
    together: bool = False,
    overwrite: bool = False,
    format: str = "",
    layout: Optional[Path] = None,
    map: Optional[int] = None,
    keyframes: Optional[Tuple[int, int]] = None,
    time: Range = None,
    box: Box = None,
    with_: Optional[Source] = None,
    max_dt: Optional[float] = None,
    time_offset: float = 0,
    estimate_time_offset: bool = False,
    by_index: bool = False,
    time_unit: Optional[str] = None,
    times: Optional[Path] = None,
    align: Optional[str] = None,
    joint: bool = False,
    body: bool = False,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> bytes:
    """Draw a map (docs/plot.md); gives the bytes of the picture, and writes them where an output is named.

    kind: "overview", "plan", "side", "covisibility", "tracks", "observations", "reprojection", "timeline" or
        "trajectory"; by default overview, and trajectory with with_
    picture: "svg" or "png"; by default as the suffix of the output says, or svg
    width: pixels, 320 to 4000; scale: of a PNG, so many pixels for one; dark: light ink on a dark page
    together: all maps in one frame, for maps that something aligned
    overwrite: replace the output; an atlas is never replaced
    format, layout, map, keyframes, time, box: of a source that is a path, as `read` takes them
    wait: seconds, for another program that writes to the store
    with_: a trajectory or an atlas that the trajectory is laid onto and coloured by its error; max_dt, time_offset,
        estimate_time_offset, by_index, time_unit, times, align, joint and body are as for `evaluate`
    """
    given: Dict[str, object] = dict(locals())
    data, notices = _slamdb.plot(given)
    _told(notices, _TOLD_AT)
    return data


def report(
    source: Source,
    output: Optional[Path] = None,
    *,
    overwrite: bool = False,
    ignore: Sequence[str] = (),
    note: Sequence[str] = (),
    warn: Sequence[str] = (),
    error: Sequence[str] = (),
    strict: bool = False,
    gates: Optional[Mapping[str, float]] = None,
    threads: int = 0,
    progress: Progress = None,
) -> Tuple[str, Report]:
    """A page about one atlas: numbers, plots, findings (docs/report.md): the HTML, and the report.

    output: write it there, too; overwrite: replace it
    ignore, note, warn, error, strict, gates: as for `check`
    """
    given: Dict[str, object] = dict(locals())
    path = name(source)
    bytes = os.path.getsize(path) if path and os.path.isfile(path) else None
    given.update(source=held(source), name=path, bytes=bytes, gates=gates or {})
    page, told, _ = _slamdb.report(given)
    return page, Report.parse(told)


def synthesize(
    *,
    sensor: str = "monocular",
    inertial: bool = False,
    maps: int = 1,
    keyframes: Optional[int] = None,
    points: Optional[int] = None,
    features: int = 500,
    noise: float = 0.5,
    outliers: float = 0,
    flipped_bits: int = 8,
    seed: int = 1,
    size: Optional[int] = None,
    vocabulary: Optional[Path] = None,
    overlap: Optional[float] = None,
    common: Optional[float] = None,
    look_alike: bool = False,
    truth: Optional[Path] = None,
    overwrite: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Atlas:
    """A sound atlas of any size and sensor, geometrically consistent; equal options give equal atlases.

    sensor: "monocular", "stereo", "rgbd" or "fisheye"; inertial: with an IMU
    maps: how many; keyframes, points: in each map, 20 and 1000; features: keypoints in a keyframe, at most
    seed: another number, another atlas
    size: keyframes and points for an .osa of about so many bytes, instead
    noise: of keypoints, standard deviation, pixels; outliers: share of them that show something else
    flipped_bits: at most, in which a look at a point differs from its descriptor
    vocabulary: make the words of this file; by default they are made up
    overlap: the maps are sessions in one room that share so much of their arc; common: share of points that both have, 0.7
    look_alike: the maps are of rooms that look alike
    truth: write how each map lies in its room to this file; overwrite: replace it
    """
    return made(_slamdb.synthesize, locals())[0]
