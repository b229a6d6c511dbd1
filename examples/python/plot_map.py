#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws maps from above: points, coloured by how many keyframes see them, and the way of the camera (matplotlib)."""

import argparse
import io
import pathlib
import sys
from typing import Any

import matplotlib
import numpy as np
import slamdb

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"


def plan_axes(up: np.ndarray) -> np.ndarray:
    """Right and forward, (2, 3): x of the map as far as it is level, or z where x is up; and what is left of both."""
    start = np.eye(3)[0 if abs(up[0]) < 0.9 else 2]
    right = start - up * (up @ start)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(up, right)])


def name_of(axis: np.ndarray, map: slamdb.Map) -> str:
    """Of the axis of the map that it is, nearly; in metres, unless one camera leaves the scale open."""
    nearest = np.abs(axis).argmax()
    metric = map.imu_initialized or not map.sensor.startswith("monocular")
    return f"{'-' if axis[nearest] < 0 else ''}{'xyz'[nearest]} ({'m' if metric else 'units of the map'})"


def draw(map: slamdb.Map, up: np.ndarray, axes: pyplot.Axes) -> Any:
    """The dots, for a scale of their colours."""
    plan = plan_axes(up)
    good = ~map.points.bad
    positions, seen = map.points.positions[good] @ plan.T, map.points.observation_counts[good]
    centers = map.keyframes.centers[map.keyframes.timestamps.argsort()] @ plan.T
    rare_first = seen.argsort(kind="stable")
    dots = axes.scatter(*positions[rare_first].T, c=seen[rare_first], s=3, cmap="viridis")
    axes.plot(*centers.T, ".-", color="crimson", label=f"{len(centers)} keyframes")
    axes.set(xlabel=name_of(plan[0], map), ylabel=name_of(plan[1], map), aspect="equal")
    axes.legend(loc="upper right")
    return dots


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("atlas", nargs="?", default=FIXTURES / "session_small_a" / "session_small_a.osa")
    parser.add_argument("--map", type=int, help="only the map of this id; by default all, side by side")
    parser.add_argument("-o", "--output", default="map.png", help="a picture, of any suffix that matplotlib knows")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()
    atlas, told = slamdb.read(options.atlas), slamdb.info(options.atlas)
    drawn = [row for row, map in enumerate(atlas.maps) if options.map in (None, map.id)]
    if not drawn:
        sys.exit(f"plot_map.py: there is no map {options.map} in {options.atlas}")
    figure, axes = pyplot.subplots(1, len(drawn), figsize=(7 * len(drawn), 5), squeeze=False)
    for row, each in zip(drawn, axes[0]):
        dots = draw(atlas.maps[row], np.array(told.maps[row].up), each)
        name = pathlib.Path(options.atlas).name
        each.set_title(f"{name}, map {atlas.maps[row].id}" if len(atlas.maps) > 1 else name)
        figure.colorbar(dots, ax=each, label="keyframes that see the point")
    picture = io.BytesIO()
    kind = pathlib.Path(options.output).suffix[1:]
    figure.savefig(picture, format=kind, dpi=90, bbox_inches="tight", metadata={"Software": None})
    slamdb.write_file(options.output, picture.getvalue(), overwrite=options.overwrite)


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"plot_map.py: {str(error).replace('overwrite=True', '-O')}")
