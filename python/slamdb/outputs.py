# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that write what is to be looked at, or used elsewhere. Files appear whole or not at all."""

from typing import Dict, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from . import _slamdb
from ._slamdb import Atlas
from .calls import Source, Texts, listed, made, reported, several
from .files import Box, Path, Progress, Range, told
from .report import Report



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
    origin: Optional[str] = None,
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

    output: a path, or STORE.db#NAME; in a store without a name it gets that of a source that is a path

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
    told(notices)
    return data


class Page(NamedTuple):
    """A page about an atlas, or the index of the pages of several."""

    html: str  # a whole file; empty where the one atlas could not be read
    report: Report
    thumbnail: bytes  # of one atlas its plan, PNG, 120 x 75; empty where slamdb was built without Cairo


def report(
    sources: Union[Source, Sequence[Source]],
    output: Optional[Path] = None,
    *,
    recursive: bool = False,
    name: str = "",
    format: str = "",
    layout: Optional[Path] = None,
    overwrite: bool = False,
    ignore: Texts = (),
    note: Texts = (),
    warn: Texts = (),
    error: Texts = (),
    strict: bool = False,
    gates: Optional[Mapping[str, float]] = None,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Page:
    """Pages about atlases: numbers, plots, findings (docs/report.md).

    sources: an atlas, a file, a folder, a store, or a sequence of them
    output: of one atlas the page, an .html, or none is written; of several the folder of pages and index.html
    recursive: look into folders of folders, too
    name: what the page calls an atlas in memory; any text
    format, layout: of files, as `read` takes them
    overwrite: replace pages that are there, and write into a folder that holds other files
    ignore, note, warn, error, strict, gates: as for `check`
    wait: seconds, for other programs that write to stores

    What cannot be read is a row of the index and an entry of the report with its failure.
    Raises NotFoundError where there is no atlas, UsageError where several have no folder, AlreadyExistsError.
    """
    given: Dict[str, object] = dict(locals())
    given["sources"] = several(sources)
    for severity, rules in (("ignore", ignore), ("note", note), ("warn", warn), ("error", error)):
        given[severity] = listed(rules)
    page, text, thumbnail, notices = _slamdb.report(given)
    told(notices)
    return Page(page, Report.parse(text), thumbnail)


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
