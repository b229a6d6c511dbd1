# SPDX-License-Identifier: BSD-3-Clause
"""How far trajectories and maps are from the truth."""

from typing import Dict, Optional, Sequence, Union

from . import _slamdb
from .calls import Ids, Source, reported
from .files import Path, Progress
from .report import Report


def evaluate(
    estimate: Source,
    truth: Source,
    *,
    map: Ids = None,
    reference_map: Optional[int] = None,
    joint: bool = False,
    body: bool = False,
    layout: Optional[Path] = None,
    max_dt: float = 0.01,
    time_offset: float = 0,
    estimate_time_offset: bool = False,
    by_index: bool = False,
    time_unit: Optional[str] = None,
    times: Optional[Path] = None,
    align: Optional[str] = None,
    align_first: int = 0,
    delta: Union[str, Sequence[str], None] = None,
    delta_tolerance: float = 0.1,
    all_pairs: bool = False,
    pairs_from_reference: bool = False,
    max_ate_rmse: Optional[float] = None,
    max_ate: Optional[float] = None,
    max_rotation_rmse: Optional[float] = None,
    max_rpe_rmse: Optional[float] = None,
    min_paired: Optional[float] = None,
    min_coverage: Optional[float] = None,
    errors: bool = False,
    output: Optional[Path] = None,
    aligned: Optional[Path] = None,
    overwrite: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> Report:
    """Absolute and relative errors of every map, and coverage, as evo has them (docs/evaluate.md).

    estimate, truth: trajectories (TUM, EuRoC, KITTI, tables of ROS) or atlases
    map: evaluate only maps of these ids; reference_map: of a truth with several
    joint: all maps are in one frame, and one; body: poses of atlases are the IMU's, not the camera's
    layout: of the estimate, a fork's .osa file

    max_dt: seconds that poses of a pair may be apart; by_index: pair the first with the first, whatever the times
    time_offset: seconds that the clock of the truth is ahead; estimate_time_offset: find it
    time_unit: of the truth: "s", "ms", "us", "ns"; times: the file of times of a KITTI trajectory

    align: "none", "origin", "scale", "se3" or "sim3"; by default sim3 where the scale is open, se3 else
    align_first: by the first so many pairs only
    delta: relative errors over these: "1m", "2s", "10f" (frames), "90deg"
    delta_tolerance: share of the delta that a distance may be off; all_pairs: from every pose
    pairs_from_reference: distances are the truth's

    max_ate_rmse, max_ate, max_rpe_rmse: metres; max_rotation_rmse: degrees; min_paired, min_coverage: percent:
        limits; what is broken is in `report.breaches`
    errors: the report has those of every pose, too
    output: write them as CSV; aligned: write the aligned estimate as TUM; overwrite: replace them
    """
    given: Dict[str, object] = dict(locals())
    if isinstance(delta, str):
        given["delta"] = [delta]
    return Report.parse(reported(_slamdb.evaluate, given))
