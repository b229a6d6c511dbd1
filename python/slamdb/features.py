# SPDX-License-Identifier: BSD-3-Clause
"""The features of a keyframe that is to be made."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Optional

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class FeatureArrays(NamedTuple):
    """What is known of the features of a new keyframe: row r is keypoint r. All but keypoints may be left out.

    N: how many keypoints there are; M: in the right image of a fisheye pair, otherwise 0.
    """

    keypoints: ArrayLike  # (N, 2) x, y as detected, pixels; or structured as Features.keypoints
    descriptors: Optional[ArrayLike] = None  # (N + M, 32) uint8, ORB: right keypoints behind the left ones
    octaves: Optional[ArrayLike] = None  # (N,) levels of the pyramid, 0 = full size
    angles: Optional[ArrayLike] = None  # (N,) degrees
    undistorted: Optional[ArrayLike] = None  # as keypoints; by default by the lens
    right_x: Optional[ArrayLike] = None  # (N,) columns in the right image of a rectified pair, less than x; -1: none
    depth: Optional[ArrayLike] = None  # (N,) metres; -1: none
    right_keypoints: Optional[ArrayLike] = None  # (M, 2) of the right camera of a fisheye pair, as keypoints
    right_octaves: Optional[ArrayLike] = None  # (M,)
    right_of_left: Optional[ArrayLike] = None  # (N,) matching rows of right_keypoints; -1: none
    left_of_right: Optional[ArrayLike] = None  # (M,) matching rows of keypoints; -1: none
