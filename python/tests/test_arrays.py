# SPDX-License-Identifier: BSD-3-Clause
import gc
import io
import os
import subprocess

import numpy as np
import pytest
import slamdb


def table(session, kind):
    """A table that the command makes: what arrays must hold."""
    text = subprocess.run(
        [os.environ["SLAMDB"], "convert", session, "-", "--to", kind], stdout=subprocess.PIPE, check=True
    ).stdout.decode()
    return np.genfromtxt(io.StringIO(text), delimiter=",", names=True, dtype=None, encoding="utf-8")


@pytest.fixture(scope="module")
def point_table(session):
    return table(session, "csv")


@pytest.fixture(scope="module")
def keyframe_table(session):
    return table(session, "csv-keyframes")


def test_points_are_those_of_the_commands_table(atlas, point_table):
    points = atlas.maps[0].points
    assert len(points) == len(point_table)
    assert np.array_equal(points.ids, point_table["id"].astype(np.uint64))
    for axis, name in enumerate("xyz"):
        assert np.array_equal(points.positions[:, axis], point_table[name].astype(np.float32))


def test_keyframes_are_those_of_the_commands_table(atlas, keyframe_table):
    keyframes = atlas.maps[0].keyframes
    assert np.array_equal(keyframes.ids, keyframe_table["id"].astype(np.uint64))
    assert np.allclose(keyframes.timestamps, keyframe_table["timestamp"], atol=1e-9, rtol=0)


def test_shapes_and_types(atlas):
    points, keyframes = atlas.maps[0].points, atlas.maps[0].keyframes
    n, k = len(points), len(keyframes)
    assert (n, k) == (3162, 14)
    shapes = {
        "ids": ((n,), np.uint64), "positions": ((n, 3), np.float32), "normals": ((n, 3), np.float32),
        "descriptors": ((n, 32), np.uint8), "min_distances": ((n,), np.float32), "bad": ((n,), np.bool_),
        "reference_keyframes": ((n,), np.uint64), "observation_counts": ((n,), np.int64),
    }  # fmt: skip
    for name, (shape, kind) in shapes.items():
        array = getattr(points, name)
        assert (array.shape, array.dtype) == (shape, kind), name
    assert keyframes.poses.shape == (k, 4, 4)
    assert keyframes.camera_from_world.shape == (k, 7)


def test_poses_are_the_inverse_of_what_is_recorded(atlas):
    keyframes = atlas.maps[0].keyframes
    for pose, recorded in zip(keyframes.poses, keyframes.camera_from_world):
        x, y, z, w = (recorded[:4] / np.linalg.norm(recorded[:4])).astype(np.float64)
        rotation = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        assert np.allclose(rotation @ pose[:3, :3], np.eye(3), atol=1e-5)
        assert np.allclose(rotation @ pose[:3, 3] + recorded[4:], 0, atol=1e-5)
    assert np.allclose(keyframes.poses[:, :3, 3], keyframes.centers, atol=1e-6)


def test_observations_and_slots_of_keyframes_say_the_same(atlas):
    points, keyframes = atlas.maps[0].points, atlas.maps[0].keyframes
    seen = points.observations
    assert seen.offsets[0] == 0 and seen.offsets[-1] == len(seen.keyframes)
    assert np.array_equal(np.diff(seen.offsets.astype(np.int64)), points.observation_counts)
    slots = {row.id: row.features.map_points for row in keyframes}
    ids = np.repeat(points.ids, points.observation_counts)
    same = [slots[k][left] == point for point, k, left in zip(ids, seen.keyframes.tolist(), seen.left)]
    assert np.mean(same) > 0.99  # as `check` notes, ORB-SLAM3 leaves some slots to others
    assert points[0].observations == {
        int(k): (int(l), int(r)) for k, l, r in zip(seen.keyframes[:6], seen.left[:6], seen.right[:6])
    }


def test_arrays_are_views_and_writing_reaches_the_atlas(atlas, tmp_path):
    positions = atlas.maps[0].points.positions
    assert np.shares_memory(positions, atlas.maps[0].points.positions)
    assert np.shares_memory(positions, atlas.maps[0].points[7].position)
    positions += np.float32(1)
    slamdb.write(atlas, tmp_path / "moved.osa")
    assert np.array_equal(slamdb.read(tmp_path / "moved.osa").maps[0].points.positions, positions)
    features = atlas.maps[0].keyframes[0].features
    features.keypoints["x"][5] = 17
    assert atlas.maps[0].keyframes[0].features.keypoints[5]["x"] == 17


def test_computed_arrays_are_read_only(atlas):
    points = atlas.maps[0].points
    for array in (points.bad, points.observation_counts, points.observations.keyframes, atlas.maps[0].keyframes.poses):
        with pytest.raises(ValueError):
            array[0] = 0


def test_arrays_outlive_the_atlas(session):
    expected = slamdb.read(session).maps[0].points.positions.sum(axis=0, dtype=np.float64)
    atlas = slamdb.read(session)
    positions, point = atlas.maps[0].points.positions, atlas.maps[0].points[3]
    keypoints = atlas.maps[0].keyframes[0].features.keypoints
    del atlas
    gc.collect()
    again = [slamdb.read(session) for _ in range(3)]  # memory that was freed would be used again
    assert np.array_equal(positions.sum(axis=0, dtype=np.float64), expected)
    assert point.position.shape == (3,) and len(keypoints) > 0 and len(again) == 3


def test_arrays_show_what_they_showed_when_the_atlas_changes(atlas):
    points = atlas.maps[0].points
    before = points.positions
    copy = before.copy()
    atlas.maps[0].points.positions[::2] = np.nan  # a fault for repair
    slamdb.repair(atlas)
    after = points.positions  # the same map, as it is now
    assert not np.shares_memory(before, after)
    assert np.isnan(before[::2]).all() and np.isfinite(copy).all() and np.isfinite(after).all()


def test_copies_are_apart(atlas):
    copy = atlas.copy()
    copy.maps[0].points.positions[:] = 0
    assert atlas.maps[0].points.positions.any()


def test_rows_and_their_ends(atlas):
    points = atlas.maps[0].points
    assert points[-1].id == points.ids[-1]
    assert [point.id for point in points] == points.ids.tolist()
    with pytest.raises(IndexError):
        points[len(points)]


def test_an_empty_map_has_empty_arrays(session):
    atlas = slamdb.Atlas()
    atlas.add_map()
    points, keyframes = atlas.maps[0].points, atlas.maps[0].keyframes
    assert points.positions.shape == (0, 3) and keyframes.poses.shape == (0, 4, 4)
    assert points.observations.offsets.tolist() == [0]
