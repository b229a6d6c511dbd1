#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Hands a map over to COLMAP: writes its model as text, and reads it back, with pycolmap where that is there."""

import argparse
import pathlib
import sys

import numpy as np
import slamdb

FIXTURES = pathlib.Path(__file__).parents[2] / "fixtures"


def centers_by_pycolmap(model: pathlib.Path) -> "dict[str, np.ndarray]":
    import pycolmap

    images = pycolmap.Reconstruction(model).images.values()
    return {image.name: np.array(image.projection_center()) for image in images}


def centers_by_hand(model: pathlib.Path) -> "dict[str, np.ndarray]":
    """Of each image the line `id qw qx qy qz tx ty tz camera name`, the pose of the world in the camera."""
    lines = [line for line in (model / "images.txt").read_text().split("\n") if not line.startswith("#")]
    centers = {}
    for line in filter(None, lines[::2]):  # in between: its keypoints
        _, *pose, _, name = line.split()
        w, x, y, z, *translation = map(float, pose)
        rotation = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        centers[name] = -rotation.T @ np.array(translation)
    return centers


def distance(map: slamdb.Map, name: str, center: np.ndarray) -> float:
    """To the camera of that image: TIME.png, of a fisheye pair left/TIME.png and right/TIME.png."""
    away = np.abs(map.keyframes.timestamps - float(pathlib.PurePath(name).stem))
    keyframe = map.keyframes[int(away.argmin())]
    pose = keyframe.pose @ keyframe.left_from_right if name.startswith("right/") else keyframe.pose
    return float(np.linalg.norm(pose[:3, 3] - center))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("atlas", nargs="?", default=FIXTURES / "session_small_a" / "session_small_a.osa")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("model"), help="folder of the model")
    parser.add_argument("-O", "--overwrite", action="store_true")
    options = parser.parse_args()
    atlas = slamdb.read(options.atlas)
    slamdb.write(atlas, options.output, format="colmap-text", overwrite=options.overwrite)
    for row, map in enumerate(atlas.maps):  # of several, each is a model in a folder of its own
        model = options.output / str(row) if len(atlas.maps) > 1 else options.output
        try:
            centers, by = centers_by_pycolmap(model), "pycolmap"
        except ImportError:
            centers, by = centers_by_hand(model), "numpy"
        away = max((distance(map, name, center) for name, center in centers.items()), default=0)
        print(f"{model}: {len(centers)} images by {by}, their centres at most {away:.1e} from the map's")


if __name__ == "__main__":
    try:
        main()
    except slamdb.Error as error:
        sys.exit(f"colmap_handover.py: {str(error).replace('overwrite=True', '-O')}")
