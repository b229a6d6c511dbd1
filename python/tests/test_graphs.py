# SPDX-License-Identifier: BSD-3-Clause
"""Rows, look-ups and graphs say the same as the columns."""

import sys

import numpy as np
import pytest
import slamdb
from real_atlases import path_of, real_atlases


@pytest.fixture(scope="module", params=real_atlases())
def maps(request):
    if not path_of(request.param).exists():
        pytest.skip(f"{request.param}.osa is not there")
    return [map for map in slamdb.read(path_of(request.param)).maps if len(map.keyframes) > 0]


def test_covisibility_is_what_the_rows_say(maps):
    pytest.importorskip("scipy", reason="scipy is not there")
    for map in maps:
        matrix = map.covisibility()
        assert matrix.shape == (len(map.keyframes),) * 2
        for row, keyframe in enumerate(map.keyframes):
            columns = map.keyframes.rows_of(list(keyframe.connections))
            assert matrix[row].toarray()[0, columns].tolist() == list(keyframe.connections.values())
        assert matrix.nnz == sum(len(keyframe.connections) for keyframe in map.keyframes)


def test_without_scipy_the_error_says_so(atlas, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.sparse", None)
    with pytest.raises(ImportError, match="needs scipy; KeyFrames.connections"):
        atlas.maps[0].covisibility()


def test_the_tree_and_the_essential_graph(maps):
    for map in maps:
        rows, parents = map.spanning_tree(), map.keyframes.parents
        ids = map.keyframes.ids
        assert [slamdb.NONE if row < 0 else int(ids[row]) for row in rows] == parents.tolist()
        edges = {tuple(edge) for edge in map.essential_graph().tolist()}
        tree = {tuple(sorted((int(a), int(b)))) for a, b in zip(ids, parents) if b != slamdb.NONE}
        loops = {tuple(edge) for edge in map.loop_edges.tolist()}
        strong = {
            tuple(sorted((row.id, other)))
            for row in map.keyframes for other, weight in row.connections.items() if weight >= 100
        }  # fmt: skip
        inertial = {tuple(sorted((row.id, row.previous))) for row in map.keyframes if row.previous is not None}
        assert edges == tree | loops | strong | (inertial if map.inertial or map.imu_initialized else set())
        assert len(map.essential_graph(min_weight=10**6)) <= len(edges)


def test_looking_up_by_id(maps):
    for map in maps:
        for entities in (map.keyframes, map.points):
            order = np.random.default_rng(0).permutation(len(entities))
            assert np.array_equal(entities.rows_of(entities.ids[order]), order)
            assert entities.by_id(int(entities.ids[-1])).id == entities.ids[-1]
            for unknown in (int(entities.ids.max()) + 1, slamdb.NONE):
                with pytest.raises(slamdb.NotFoundError):
                    entities.by_id(unknown)
                with pytest.raises(slamdb.NotFoundError, match=f"ids: row 1 is {unknown}, which map"):
                    entities.rows_of([entities.ids[0], unknown])


def test_rows_have_what_the_columns_have(maps):
    for map in maps:
        keyframes = map.keyframes
        for row, keyframe in enumerate(keyframes):
            assert np.array_equal(keyframe.pose, keyframes.poses[row])
            assert np.shares_memory(keyframe.velocity, keyframes.velocities)
            assert np.shares_memory(keyframe.accelerometer_bias, keyframes.accelerometer_biases)
            assert np.shares_memory(keyframe.gyroscope_bias, keyframes.gyroscope_biases)
            assert keyframe.camera == keyframes.cameras[row] and keyframe.origin_map == keyframes.origin_maps[row]
            assert keyframe.not_erase == keyframes.not_erase[row]
            assert all(keyframes.by_id(int(child)).parent == keyframe.id for child in keyframe.children)
            features = keyframe.features
            assert len(features.words) == len(features.word_weights) and len(features.word_nodes) == len(features)
            fisheye = keyframe.right_camera is not None
            assert (len(features.right_of_left) == len(features.keypoints)) == fisheye or len(features.keypoints) == 0
        quaternions = keyframes.poses_quaternion
        assert np.allclose(quaternions[:, :3], keyframes.poses[:, :3, 3])
        assert np.allclose(np.linalg.norm(quaternions[:, 3:], axis=1), 1, atol=1e-6)


def test_an_imu_is_calibrated_or_not_there(maps):
    for map in maps:
        for keyframe in map.keyframes:
            calibration = keyframe.imu_calibration
            assert (calibration is not None) == ("IMU" in map.sensor)
            if calibration is not None:
                assert np.allclose(np.linalg.det(calibration["body_from_camera"][:3, :3]), 1, atol=1e-4)
                assert (calibration["noise"] > 0).all() and keyframe.imu_measurements.shape[1:] == (7,)


def test_landmarks(atlas, fixtures):
    assert len(atlas.maps[0].landmarks) == 0 and atlas.maps[0].landmarks.means.shape == (0, 3)
    landmarks = slamdb.read(fixtures / "mrpt" / "fuse_a.mrpt.gz").maps[0].landmarks
    assert len(landmarks) == len(landmarks.ids) > 0
    assert np.allclose(landmarks.covariances, landmarks.covariances.transpose(0, 2, 1))
    landmarks.means[0] = (1, 2, 3)
    assert landmarks.means[0].tolist() == [1, 2, 3] and landmarks.seen_counts.shape == (len(landmarks),)
