# SPDX-License-Identifier: BSD-3-Clause
"""The IMU of keyframes that are to be made."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Optional, Sequence

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class ImuArrays(NamedTuple):
    """What an IMU says of N new keyframes: row r is keyframe r. All behind measurements may be left out.

    Measurements of a keyframe begin at the one before it in time, and end at it; of none, nothing leads to it. A
    keyframe that comes between two takes its part of what led to the later one, if it has none of its own.
    """

    body_from_camera: ArrayLike  # (4, 4), of the left camera
    noise: ArrayLike  # (6,) variances of one measurement: gyroscope (rad/s)^2, accelerometer (m/s^2)^2; density^2 * rate
    walk_noise: ArrayLike  # (6,) and of what their biases gain with each; density^2 / rate
    measurements: Sequence[Optional[ArrayLike]]  # (M, 7) each: acceleration m/s^2, angular velocity rad/s, duration s
    velocities: Optional[ArrayLike] = None  # (N, 3) m/s, world; by default unknown
    accelerometer_biases: Optional[ArrayLike] = None  # (N, 3) m/s^2; by default 0
    gyroscope_biases: Optional[ArrayLike] = None  # (N, 3) rad/s; by default 0
    integration_biases: Optional[ArrayLike] = None  # (N, 6) accelerometer, gyroscope; by default the two above
    previous: Optional[ArrayLike] = None  # (N,) ids, NONE where a chain begins; by default those before in time
