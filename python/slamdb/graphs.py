# SPDX-License-Identifier: BSD-3-Clause
"""The graphs of a map as matrices."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._slamdb import Map


class Connections(NamedTuple):
    """Compressed by rows: the keyframe in row k is covisible with the entries from offsets[k] to offsets[k + 1]."""

    offsets: NDArray[np.uint64]  # (N + 1,)
    keyframes: NDArray[np.uint64]  # ids
    weights: NDArray[np.int32]  # points in common, as recorded


def covisibility(map: Map) -> Any:
    try:
        sparse: Any = importlib.import_module("scipy.sparse")  # of whose types nothing is known
    except ImportError:
        raise ImportError("a sparse matrix needs scipy; KeyFrames.connections has the same as arrays") from None
    keyframes = map.keyframes
    connections = keyframes.connections
    columns = keyframes.rows_of(connections.keyframes)
    size = len(keyframes)
    parts = (connections.weights, columns, connections.offsets.astype("int64"))
    return sparse.csr_matrix(parts, shape=(size, size))


def spanning_tree(map: Map) -> NDArray[np.int64]:
    import numpy as np

    from ._slamdb import NONE

    parents = map.keyframes.parents
    rows = np.full(len(parents), -1, np.int64)
    has_parent = parents != NONE
    rows[has_parent] = map.keyframes.rows_of(parents[has_parent])
    return rows
