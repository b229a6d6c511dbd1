#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a map from above: its points, coloured by how many keyframes see them, and the way of the camera (matplotlib)."""

import argparse
import io
import pathlib

import matplotlib
import slamdb

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"


def draw(map: slamdb.Map, title: str) -> pyplot.Figure:
    """ORB-SLAM3's world has y down: x and z are the plan."""
    good = ~map.points.bad
    positions, seen = map.points.positions[good], map.points.observation_counts[good]
    order = map.keyframes.timestamps.argsort()
    centers = map.keyframes.centers[order]
    figure, axes = pyplot.subplots(figsize=(7, 5))
    rare_first = seen.argsort(kind="stable")
    dots = axes.scatter(positions[rare_first, 0], positions[rare_first, 2], c=seen[rare_first], s=3, cmap="viridis")
    axes.plot(centers[:, 0], centers[:, 2], ".-", color="crimson", label=f"{len(centers)} keyframes")
    axes.set(xlabel="x (m)", ylabel="z (m)", title=title, aspect="equal")
    axes.legend(loc="upper right")
    figure.colorbar(dots, label="keyframes that see the point")
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("atlas", nargs="?", default=FIXTURES / "session_small_a" / "session_small_a.osa")
    parser.add_argument("-o", "--output", default="map.png", help="a picture, of any suffix that matplotlib knows")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()
    atlas = slamdb.read(options.atlas)
    picture = io.BytesIO()
    figure = draw(atlas.maps[0], pathlib.Path(options.atlas).name)
    figure.savefig(picture, format=pathlib.Path(options.output).suffix[1:], dpi=90, bbox_inches="tight", metadata={"Software": None})
    slamdb.write_file(options.output, picture.getvalue(), overwrite=options.overwrite)


if __name__ == "__main__":
    main()
