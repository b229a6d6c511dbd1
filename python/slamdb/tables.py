# SPDX-License-Identifier: BSD-3-Clause
"""Points, keyframes, observations and findings as tables: pandas' DataFrame, or a dictionary of columns.

What the tables of `slamdb convert map.osa map.keyframes.csv` have, too, is called as there; `Store.table` lists all.
"""

import importlib
import importlib.util
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Tuple

import numpy as np

from ._slamdb import NONE, Atlas, KeyFrames, Map, Points

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .report import CheckReport

Columns = Dict[str, "NDArray[Any]"]


def has_pandas() -> bool:
    return importlib.util.find_spec("pandas") is not None


def pandas() -> Any:
    """Raises ImportError that says what to install."""
    try:
        return importlib.import_module("pandas")
    except ImportError as error:
        raise ImportError("pandas is not there: apt install python3-pandas, or pip install pandas") from error


def _coordinates(rows: "NDArray[Any]", names: Iterable[str]) -> Columns:
    return {name: rows[:, axis].copy() for axis, name in enumerate(names)}


def keyframe_columns(keyframes: KeyFrames) -> Columns:
    recorded = keyframes.camera_from_world[:, :4].astype(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = recorded / np.linalg.norm(recorded, axis=1, keepdims=True)
    return {
        "id": keyframes.ids.copy(),
        "timestamp": keyframes.timestamps.copy(),
        **_coordinates(keyframes.centers, ("x", "y", "z")),
        **_coordinates(turned * (-1, -1, -1, 1), ("qx", "qy", "qz", "qw")),  # world from camera: the inverse
        "parent": keyframes.parents.copy(),
        "bad": keyframes.bad.copy(),
    }


def point_columns(points: Points) -> Columns:
    return {
        "id": points.ids.copy(),
        **_coordinates(points.positions, ("x", "y", "z")),
        **_coordinates(points.normals, ("nx", "ny", "nz")),
        "observations": points.observation_counts.copy(),
        "reference_keyframe": points.reference_keyframes.copy(),
        "min_distance": points.min_distances.copy(),
        "max_distance": points.max_distances.copy(),
        "bad": points.bad.copy(),
    }


def observation_columns(points: Points) -> Columns:
    seen = points.observations
    return {
        "point": np.repeat(points.ids, points.observation_counts),
        "keyframe": seen.keyframes.copy(),
        "left": seen.left.copy(),
        "right": seen.right.copy(),
    }


_OF_MAPS: Dict[str, Callable[[Map], Columns]] = {
    "keyframes": lambda map: keyframe_columns(map.keyframes),
    "points": lambda map: point_columns(map.points),
    "observations": lambda map: observation_columns(map.points),
}
KINDS = tuple(_OF_MAPS)
_IDS_OR_NONE = ("parent", "reference_keyframe", "map")


def atlas_columns(kind: str, atlases: Iterable[Tuple[str, Atlas]]) -> Columns:
    """The rows of all maps of all atlases, behind the name of the atlas and the id of the map."""
    parts = [_rows_of(kind, "", Atlas().add_map())]  # of no rows, for names and types
    parts += [_rows_of(kind, name, map) for name, atlas in atlases for map in atlas.maps]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _rows_of(kind: str, atlas: str, map: Map) -> Columns:
    columns = _OF_MAPS[kind](map)
    count = len(next(iter(columns.values())))
    id = NONE if map.id is None else map.id
    return {
        "atlas": np.full(count, atlas, dtype=object), "map": np.full(count, id, dtype=np.uint64), **columns,
    }  # fmt: skip


def frame_of_keyframes(keyframes: KeyFrames) -> Any:
    return frame_of(keyframe_columns(keyframes))


def frame_of_points(points: Points) -> Any:
    return frame_of(point_columns(points))


def frame_of(columns: Columns) -> Any:
    """The columns as a DataFrame, in which an id that is none is <NA>."""
    pd = pandas()
    values = {
        name: pd.arrays.IntegerArray(column, column == NONE) if name in _IDS_OR_NONE else column
        for name, column in columns.items()
    }
    return pd.DataFrame(values)


_PLACES = ("map", "keyframe", "point", "camera", "landmark", "feature")
_OF_RULES = ("rule", "severity", "title", "consequence", "fix", "count")


def frame_of_findings(report: "CheckReport") -> Any:
    rows: List[Dict[str, Any]] = []
    for checked in report["inputs"]:
        if "failure" in checked:
            failed = {"rule": "unreadable", "severity": "error", "count": 1, "message": checked["failure"]}
            rows.append({"input": checked["input"], **failed})
        for result in checked.get("results", ()):
            rule = {name: result.get(name) for name in _OF_RULES}
            for finding in result["findings"]:
                told = {"where": finding["where"], "message": finding["message"]}
                place = {name: int(id) for name, id in finding["place"].items()}  # text beyond 53 bits
                rows.append({"input": checked["input"], **rule, **told, **place})
    pd = pandas()
    names = ("input", *_OF_RULES, "where", "message", *_PLACES)
    columns = {name: [row.get(name) for row in rows] for name in names}
    kinds = {**dict.fromkeys(_PLACES, "UInt64"), "count": "int64"}
    return pd.DataFrame({name: pd.array(column, kinds.get(name, "object")) for name, column in columns.items()})
