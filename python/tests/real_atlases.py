# SPDX-License-Identifier: BSD-3-Clause
"""Real atlases of ORB-SLAM3: those of the fixtures, and those of SLAMDB_ATLASES where that is set."""

import os
import pathlib
from typing import Dict, List

_LAB2 = ("i1", "i2")  # of SLAMDB_LAB2, with an IMU
_NAMES = (
    "fisheye_stereo", "mono_dist", "mono_small", "mono_small_newmap", "mono_small_twice", "multimap_rgbd", "race_mono",
    "session_a", "session_b", "session_small_a", "session_small_b", "stereo_inertial",
)  # fmt: skip


def real_atlases() -> List[str]:
    """Names; each is there or is to be skipped by name."""
    return list(_NAMES)


def path_of(name: str) -> pathlib.Path:
    """Where an atlas is; it may not be there."""
    if name in _LAB2:
        return pathlib.Path(os.environ.get("SLAMDB_LAB2", "")) / f"{name}.osa"
    fixture = pathlib.Path(os.environ["SLAMDB_FIXTURES"]) / name / f"{name}.osa"
    return fixture if fixture.exists() else pathlib.Path(os.environ.get("SLAMDB_ATLASES", "")) / f"{name}.osa"


def imu_of(map):
    """What an IMU says of the keyframes of a map; None without one."""
    import slamdb

    keyframes, calibration = map.keyframes, map.keyframes[0].imu_calibration
    if not map.inertial:
        return None
    return slamdb.ImuArrays(
        **calibration, measurements=[row.imu_measurements for row in keyframes], velocities=keyframes.velocities,
        accelerometer_biases=keyframes.accelerometer_biases, gyroscope_biases=keyframes.gyroscope_biases,
        integration_biases=keyframes.integration_biases, previous=keyframes.previous,
    )  # fmt: skip


def taken_apart(map) -> Dict[str, object]:
    """The arguments of add_keyframes and add_points that make this map of one camera anew.

    Of what both sides say: ORB-SLAM3 leaves some keypoints to other points than those that observe them.
    """
    import numpy as np

    keyframes, points, first = map.keyframes, map.points, map.keyframes[0]
    slots = {row.id: row.features.map_points for row in keyframes}
    seen = points.observations
    rows = np.repeat(np.arange(len(points)), points.observation_counts)
    triples = [
        (row, keyframe, keypoint)
        for left_or_right in (seen.left, seen.right)
        for row, keyframe, keypoint in zip(rows.tolist(), seen.keyframes.tolist(), left_or_right.tolist())
        if keypoint >= 0 and slots[keyframe][keypoint] == points.ids[row]
    ]
    observed = sorted({row for row, _, _ in triples})
    new_row = {row: new for new, row in enumerate(observed)}
    bounds, pair = first.image_bounds, first.right_camera is not None
    size = (640, 480) if first.distortion.size else (bounds[2] - bounds[0], bounds[3] - bounds[1])
    return {
        "keyframes": {
            "timestamps": keyframes.timestamps, "camera_from_world": keyframes.camera_from_world, "ids": keyframes.ids,
            "features": [row.features for row in keyframes], "camera": first.camera, "image_size": size,
            "distortion": first.distortion, "baseline": 0 if pair else first.intrinsics["baseline"],
            "depth_threshold": first.intrinsics["depth_threshold"], "right_camera": first.right_camera,
            "left_from_right": first.left_from_right if pair else None, "levels": first.levels,
            "scale_factor": first.scale_factor, "imu": imu_of(map),
        },
        "points": {
            "ids": points.ids[observed], "positions": points.positions[observed],
            "observations": [(new_row[row], keyframe, keypoint) for row, keyframe, keypoint in triples],
        },
    }  # fmt: skip


def built_anew(atlas):
    """An atlas of the same content, made of arrays."""
    import slamdb

    new = slamdb.Atlas(vocabulary=(atlas.vocabulary_name, atlas.vocabulary_checksum))
    for camera in atlas.cameras:
        new.add_camera(camera["model"], *camera["parameters"].values(), id=camera["id"])
    for map in atlas.maps:
        made = new.add_map(id=map.id)
        if len(map.keyframes) > 0:
            arrays = taken_apart(map)
            made.add_keyframes(**arrays["keyframes"])
            made.add_points(**arrays["points"])
            if map.inertial:
                made.set_imu_stage("ba2" if map.imu_ba2 else "ba1" if map.imu_ba1 else "initialized")
    return new
