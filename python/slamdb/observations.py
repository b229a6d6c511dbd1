# SPDX-License-Identifier: BSD-3-Clause
"""Which keyframe sees which point."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Observations(NamedTuple):
    """Compressed by rows: point r is seen in the entries from offsets[r] to offsets[r + 1] of the others."""

    offsets: NDArray[np.uint64]  # (N + 1,)
    keyframes: NDArray[np.uint64]  # ids
    left: NDArray[np.int32]  # rows of the keyframe's features; -1: not seen in the left image
    right: NDArray[np.int32]  # of a fisheye pair; -1: not seen in the right image. These stand behind the left ones:
    # row r of map_points and descriptors is r - len(keypoints) of right_keypoints
