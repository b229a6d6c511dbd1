#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Removes points by a rule of one's own, a mask of numpy, and writes the atlas: here those far from every camera."""

import argparse
import pathlib
import sys

import numpy as np
import slamdb

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"


def far_from_cameras(map: slamdb.Map, limit: float) -> np.ndarray:
    """Of each point, whether the nearest camera is farther away."""
    nearest = np.full(len(map.points), np.inf)
    for center in map.keyframes.centers:
        np.minimum(nearest, np.linalg.norm(map.points.positions - center, axis=1), out=nearest)
    return nearest > limit


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("atlas", nargs="?", default=FIXTURES / "session_small_a" / "session_small_a.osa")
    parser.add_argument("-o", "--output", default="filtered.osa")
    parser.add_argument("--limit", type=float, default=3.0, help="metres, or units of the map")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()
    atlas = slamdb.read(options.atlas)
    with atlas.edit() as edit:
        for map in edit.maps:
            report = map.remove_points(far_from_cameras(map, options.limit))
            print(f"map {map.id}: {report.before.points} -> {report.after.points} points")
    slamdb.write(atlas, options.output, overwrite=options.overwrite)
    print("sound" if slamdb.check(atlas).sound else "not sound: `slamdb check` tells why")


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"filter_points.py: {str(error).replace('overwrite=True', '-O')}")
