# SPDX-License-Identifier: BSD-3-Clause
"""The table of a fleet: a row for each atlas, in the order in which they were named and found."""

import csv
import io
import pathlib
from typing import Any, Dict, List, Sequence

import slamdb

from .plan import Plan
from .work import Row

COLUMNS = (
    "input", "bytes", "sha256", "maps", "sensors", "imu", "metric", "keyframes", "points", "landmarks", "observations",
    "trajectory_length", "begin_time", "end_time", "duration_s", "components", "observers_per_point",
    "reprojection_error_px", "sound", "error", "warning", "note", "rules", "warnings", "output", "losses", "page",
    "failure",
)  # fmt: skip


def rows_of(plan: Plan) -> List[Row]:
    """Of all atlases; those that are not done say so, and so do folders that cannot be looked into."""
    rows = [plan.done[item.input]["row"] if item.input in plan.done else _undone(item.input) for item in plan.items]
    return rows + [{"input": name, "failure": failure} for name, failure in plan.failures.items()]


def _undone(input: str) -> Row:
    return {"input": input, "failure": "not done yet"}


def write_csv(path: pathlib.Path, rows: Sequence[Row]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        writer.writerow([_cell(row.get(column)) for column in COLUMNS])
    slamdb.write_file(path, readable(text.getvalue()).encode(), overwrite=True)


def write_parquet(path: pathlib.Path, rows: Sequence[Row]) -> None:
    """Raises ImportError where pyarrow is not there."""
    import pyarrow  # type: ignore[import]
    import pyarrow.parquet  # type: ignore[import]

    columns: Dict[str, List[Any]] = {column: [_plain(row.get(column)) for row in rows] for column in COLUMNS}
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.table(columns), sink)
    slamdb.write_file(path, sink.getvalue().to_pybytes(), overwrite=True)


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return " ".join(map(str, value)) if all(" " not in str(each) for each in value) else "; ".join(map(str, value))
    return str(value)


def _plain(value: Any) -> Any:
    if isinstance(value, str):
        return readable(value)
    return [readable(str(each)) for each in value] if isinstance(value, list) else value


def readable(text: str) -> str:
    """As docs/json.md has it: bytes of names that are not UTF-8 become U+FFFD."""
    return text.encode(errors="surrogateescape").decode(errors="replace")
