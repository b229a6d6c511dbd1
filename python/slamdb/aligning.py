# SPDX-License-Identifier: BSD-3-Clause
"""Verbs that bring maps, or pictures and maps, together."""

import os
from typing import Dict, Optional, Sequence, Tuple, Union

from . import _slamdb
from ._slamdb import Atlas
from .calls import Source, made, reported
from .files import Path, Progress
from .frames import Transform, transform_text
from .report import Report


def align(
    *sources: Source,
    own_vocabulary: bool = False,
    save: Optional[Path] = None,
    plot: Optional[Path] = None,
    overwrite: bool = False,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Find how maps that nobody aligned lie to each other (docs/align.md). Every map is compared with every other.

    sources: atlases; a store without #NAME: those of its maps in which something looks like the others
    own_vocabulary: recognise places by a vocabulary trained on the maps, not by the recorded words
    save, plot: of two maps: write how the second lies in the first, as `merge` takes it; draw it (.svg, .png)
    overwrite: replace those; wait: seconds, for another program that writes to the store

    `report.links` are the pairs, each with its verdict, "aligned", "doubtful" or "no-overlap", and the transform.
    Raises NotPossibleError where there is nothing to compare.
    """
    return Report.parse(reported(_slamdb.align, locals()))


def merge(
    *sources: Source,
    on_conflict: Optional[str] = None,
    ignore_vocabulary: bool = False,
    force: bool = False,
    vocabulary: Optional[Path] = None,
    id_map: Optional[Path] = None,
    overwrite: bool = False,
    base: Optional[Source] = None,
    geometry: Optional[str] = None,
    prefer: Optional[str] = None,
    align: bool = False,
    optimize: Optional[str] = None,
    join: bool = False,
    transform: Optional[Transform] = None,
    anchors: Union[Path, Sequence[Tuple[int, int]], None] = None,
    maps: Optional[Tuple[int, int]] = None,
    scale: Optional[bool] = None,
    outliers: Optional[float] = None,
    fuse: Optional[bool] = None,
    fuse_radius: Optional[float] = None,
    fuse_hamming: Optional[int] = None,
    threads: int = 0,
    progress: Progress = None,
) -> Tuple[Atlas, Report]:
    """Bring the maps of all atlases into a new one, side by side, with ids that do not clash (docs/merge.md).

    on_conflict: what becomes of a map that comes twice: "renumber" keeps both, "keep-first" (the default with align),
        "error"
    ignore_vocabulary: keep the first vocabulary though another atlas has a different one
    force: merge or join all the same what is refused
    vocabulary: file of the words; those that cannot be of it are computed anew
    id_map: write which id of which atlas became which to this .csv or .json; overwrite: replace it

    base: what both sources, ours and theirs, were made of: their changes are merged, each thing where it changed. Of two
        branches in a store a warning tells which it is, where it is not given: "maps.db#lab@1"
    geometry: where that is which both have: "align" (the default), what both changed, weighed; "ours", "theirs";
        "optimize", align and then the bundle adjusted
    prefer: whose change stands where both changed the same: "ours" (the default) or "theirs"

    align: make one map of those that overlap; NotPossibleError where none does for sure
    optimize: behind that: "none", "pose-graph", "seam" (the default) or "full"

    join: make one map of two, the second moved into the first
    transform: how it lies there, as `slamdb.transform(by=)` takes it; anchors: or solved from keyframes taken at one
        place, [(first, second), ...], or a file
    maps: which, ids in the first and the second atlas
    scale: solve for it from anchors; by default only of monocular maps
    outliers: leave out anchors that lie farther apart, units of the first map
    fuse: points that both maps have; by default with align and base, and of maps of landmarks
    fuse_radius: how far apart, pixels of uncertainty, 3; fuse_hamming: in how many bits descriptors may differ, 50
    """
    given = locals()
    given["transform"] = transform_text(transform)
    if anchors is not None and not isinstance(anchors, (str, os.PathLike)):
        given["anchors"] = ",".join(f"{first}:{second}" for first, second in anchors)
    return made(_slamdb.merge, given)


def locate(
    source: Source,
    *pictures: Path,
    camera: Optional[Path] = None,
    vocabulary: Optional[Path] = None,
    features: int = 2000,
    against: Optional[Path] = None,
    benchmark: bool = False,
    most: int = 500,
    output: Optional[Path] = None,
    overwrite: bool = False,
    wait: float = 5,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Find where pictures were taken, by what they show (docs/locate.md), or tell how good a map is for that.

    source: an atlas; a store without #NAME: all its atlases
    pictures: files, folders of them, or lists (.txt, .csv)
    camera: settings of the camera that took them, as ORB-SLAM3 reads them (YAML); by default the map's own
    vocabulary: file of the words; features: that are looked for in a picture, 100 to 100,000
    against: a trajectory of true poses, paired by time: errors are told
    benchmark: instead of pictures, leave each keyframe out in turn and locate it; most: at most so many
    output: write the poses that were found to this file (TUM); overwrite: replace it
    wait: seconds, for another program that writes to the store

    `report.pictures` has a verdict for each: "found", "doubtful", "not-found", "unreadable".
    """
    given: Dict[str, object] = dict(locals())
    return Report.parse(reported(_slamdb.locate, given))
