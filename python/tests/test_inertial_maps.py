# SPDX-License-Identifier: BSD-3-Clause
"""Maps of sessions with an IMU from arrays; observations that are added later."""

import numpy as np
import pytest
import slamdb
from real_atlases import built_anew, imu_of, path_of, taken_apart
from test_building import atlas_of, world

CALIBRATION = {"body_from_camera": np.eye(4), "noise": np.full(6, 1e-4), "walk_noise": np.full(6, 1e-8)}
REST = np.tile([0, 0, 9.81, 0, 0, 0, 0.01], (10, 1))  # 0.1 s in which nothing moves


def inertial_world(keyframes=5):
    arrays = world(np.random.default_rng(2), keyframes)
    arrays["keyframes"]["imu"] = {**CALIBRATION, "measurements": [None] + [REST] * (keyframes - 1)}
    return arrays


@pytest.fixture(scope="module", params=["stereo_inertial", "i1", "i2"])
def inertial(request):
    if not path_of(request.param).exists():
        pytest.skip(f"{request.param}.osa is not there")
    return slamdb.read(path_of(request.param))


def test_preintegrations_are_those_of_orbslam3(inertial):
    built = built_anew(inertial)
    for old, new in zip(inertial.maps, built.maps):
        assert (new.inertial, new.imu_initialized, new.imu_ba1, new.imu_ba2) == (
            old.inertial, old.imu_initialized, old.imu_ba1, old.imu_ba2,
        )  # fmt: skip
        assert np.array_equal(new.keyframes.previous, old.keyframes.previous)
        assert np.array_equal(new.keyframes.next, old.keyframes.next)
        assert np.array_equal(new.keyframes.velocities, old.keyframes.velocities)
        for one, other in zip(new.keyframes, old.keyframes):
            assert np.array_equal(one.imu_measurements, other.imu_measurements)
            if other.previous is None:
                continue
            for name, number in other.preintegration.items():
                largest = np.abs(number).max()
                assert np.abs(np.asarray(one.preintegration[name]) - number).max() <= 1e-5 * largest, name


def test_real_sessions_grow_keyframe_by_keyframe(inertial):
    old = inertial.maps[0]
    arrays = taken_apart(old)["keyframes"]
    order = [next(row for row, each in enumerate(old.keyframes) if each.previous is None and each.next is not None)]
    while len(order) < 12:
        order += old.keyframes.rows_of([old.keyframes.next[order[-1]]]).tolist()
    atlas = slamdb.Atlas()
    for camera in inertial.cameras:
        atlas.add_camera(camera["model"], *camera["parameters"].values(), id=camera["id"])
    map, whole = atlas.add_map(), imu_of(old)
    for row in order:
        one = {
            name: value[row : row + 1] if name in ("timestamps", "camera_from_world", "features", "ids") else value
            for name, value in arrays.items()
        }
        one["imu"] = slamdb.ImuArrays(
            **old.keyframes[0].imu_calibration, measurements=[whole.measurements[row]],
            velocities=whole.velocities[row : row + 1],
        )  # fmt: skip
        map.add_keyframes(**one)
    ids = old.keyframes.ids[order]
    assert map.keyframes.previous.tolist() == [slamdb.NONE, *ids[:-1].tolist()]
    assert map.keyframes.next.tolist() == [*ids[1:].tolist(), slamdb.NONE]


def test_an_inertial_world_is_sound_and_read_byte_for_byte():
    atlas = atlas_of(inertial_world())
    map = atlas.maps[0]
    assert map.inertial and not map.imu_initialized and "IMU" in map.sensor
    map.set_imu_stage("ba1")
    assert slamdb.check(atlas).sound and map.imu_ba1 and not map.imu_ba2
    data = slamdb.encode(atlas)
    again = slamdb.read(data)
    assert slamdb.encode(again) == data and again.maps[0].imu_initialized
    motion = map.keyframes[1].preintegration
    assert motion["duration"] == pytest.approx(0.1) and np.allclose(motion["rotation"], np.eye(3))
    assert np.allclose(motion["velocity"], (0, 0, 0.981)) and np.allclose(motion["position"], (0, 0, 0.04905))
    assert map.keyframes[0].preintegration is None and map.keyframes[0].imu_calibration is not None


def test_a_keyframe_in_the_middle_takes_its_part_of_the_measurements():
    arrays = inertial_world()
    atlas = atlas_of(arrays)
    map = atlas.maps[0]
    middle = {name: value for name, value in arrays["keyframes"].items() if name not in ("timestamps", "poses", "features")}
    middle["imu"] = {**CALIBRATION, "measurements": [[]]}
    with atlas.edit() as edit:
        edit.maps[0].add_keyframes(
            timestamps=[0.135], poses=[np.eye(4)], features=[slamdb.FeatureArrays(keypoints=[])], **middle
        )
    row = map.keyframes[5]
    assert (row.previous, row.next) == (1, 2) and map.keyframes[1].next == 5 and map.keyframes[2].previous == 5
    assert row.preintegration["duration"] == pytest.approx(0.035, abs=1e-5)
    assert map.keyframes[2].preintegration["duration"] == pytest.approx(0.065, abs=1e-5)
    assert row.imu_measurements[:, 6].tolist() == pytest.approx([0.01, 0.01, 0.01, 0.005], abs=1e-5)
    with atlas.edit() as removed:
        removed.maps[0].remove_keyframes([5])
    assert map.keyframes[2].previous == 1 and map.keyframes[2].preintegration["duration"] == pytest.approx(0.1)
    removed.undo()
    edit.undo()
    assert slamdb.encode(atlas) == slamdb.encode(atlas_of(arrays))


BAD_IMU = {
    "no calibration": ({"measurements": [None] * 5}, "imu: has no body_from_camera"),
    "a body that scales": ({"body_from_camera": 2 * np.eye(4)}, "imu.body_from_camera .*rotation"),
    "a body of nothing": ({"body_from_camera": []}, r"imu.body_from_camera: has shape \(0,\), expected \(4, 4\)"),
    "noise of two": ({"noise": [1, 2]}, r"imu.noise: has shape \(2,\), expected \(6,\)"),
    "no noise": ({"noise": np.zeros(6)}, "imu.noise: "),
    "too few measurements": ({"measurements": [REST]}, "imu.measurements: has 1 rows"),
    "measurements of six": ({"measurements": [REST[:, :6]] * 5}, r"imu.measurements: row 0: has shape \(10, 6\)"),
    "measurements that are no list": ({"measurements": 7}, "imu.measurements: is no list"),
    "time that stands": ({"measurements": [REST * (1, 1, 1, 1, 1, 1, 0)] * 5}, "imu.measurements: row 0 .*lasts 0"),
    "measurements of another time": ({"measurements": [None] + [REST[:5]] * 4}, "imu.measurements: row 1 lasts 0.05 s"),
    "velocities of nothing": ({"velocities": np.full((5, 3), np.nan)}, "imu.velocities: row 0"),
    "biases of two lengths": (
        {"accelerometer_biases": np.zeros((5, 3)), "gyroscope_biases": np.zeros((4, 3))}, "imu.gyroscope_biases: has 4",
    ),
    "a predecessor that is not there": (
        {"previous": [slamdb.NONE, 0, 77, 2, 3]}, "imu.previous: row 2 is 77, which the map does not have",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", BAD_IMU)
def test_bad_imu_data_is_refused_by_name_and_changes_nothing(what):
    change, message = BAD_IMU[what]
    arrays = inertial_world()
    given = arrays["keyframes"]["imu"]
    arrays["keyframes"]["imu"] = change if what == "no calibration" else {**given, **change}
    atlas = slamdb.Atlas()
    atlas.add_camera("pinhole", 400, 400, 320, 240)
    map = atlas.add_map()
    before = slamdb.encode(atlas)
    with pytest.raises(slamdb.UsageError, match=message):
        map.add_keyframes(**arrays["keyframes"])
    assert slamdb.encode(atlas) == before


def test_an_imu_is_of_all_keyframes_of_a_map_or_of_none(atlas):
    arrays = inertial_world()
    arrays["keyframes"]["timestamps"] = arrays["keyframes"]["timestamps"] + 1e9
    before = slamdb.encode(atlas)
    with pytest.raises(slamdb.UsageError, match="imu: the keyframes of map 0 have none"):
        atlas.maps[0].add_keyframes(**arrays["keyframes"])
    with pytest.raises(slamdb.UsageError, match="stage: map 0 has no keyframes with an IMU"):
        atlas.maps[0].set_imu_stage("initialized")
    with pytest.raises(slamdb.UsageError, match="stage: 'ready' is none of"):
        atlas.maps[0].set_imu_stage("ready")
    assert slamdb.encode(atlas) == before


# ---- Observations


def test_observations_that_are_added_later_are_as_good_as_at_once():
    arrays = world(np.random.default_rng(6))
    whole = atlas_of(arrays)
    triples = arrays["points"]["observations"]
    arrays["points"]["observations"] = triples[:40] + triples[60:90]
    grown = atlas_of(arrays)
    later = np.array(triples[40:60] + triples[90:])
    grown.maps[0].add_observations(points=later[:, 0], keyframes=later[:, 1], keypoints=later[:, 2])
    assert slamdb.encode(grown) == slamdb.encode(whole)


def test_added_observations_are_taken_back(atlas):
    before = slamdb.encode(atlas)
    map = atlas.maps[0]
    point = map.points[0]
    other = next(row for row in map.keyframes if row.id not in point.observations)
    free = int(np.flatnonzero(other.features.map_points == slamdb.NONE)[0])
    with atlas.edit() as edit:
        edit.maps[0].add_observations([point.id], [other.id], [free])
    seen = map.points.by_id(point.id)
    assert seen.observations[other.id] == (free, -1)
    assert map.keyframes.by_id(other.id).features.map_points[free] == point.id
    assert map.points.weights[0] > 0 and slamdb.encode(atlas) != before
    assert edit.undo() > 0 and slamdb.encode(atlas) == before


@pytest.mark.parametrize(
    "given, message",
    [
        (([99], [0], [1]), "points: row 0 is 99, which the map does not have; .*add_points"),
        (([0], [77], [1]), "keyframes: row 0 is by keyframe 77, which the map does not have"),
        (([0], [0], [4000]), "keypoints: row 0 is keypoint 4000 of keyframe 0, which has 40"),
        (([0], [0], [2**63]), "keypoints: row 0 is keypoint 9223372036854775808"),
        (([0], [0], [-1]), "keypoints: row 0 is -1, which is out of range"),
        (([0], [0], [0.5]), "keypoints: row 0 is 0.5, expected a whole number"),
        (([0, 1], [0], [1]), r"points: has shape \(2,\), expected \(1,\)"),
        ((None, [0], [1]), "points: "),
        (([0], None, [1]), "keyframes: "),
    ],
)
def test_observations_that_cannot_be(given, message):
    atlas = atlas_of(world(np.random.default_rng(8)))
    before = slamdb.encode(atlas)
    with pytest.raises(slamdb.UsageError, match=message):
        atlas.maps[0].add_observations(*given)
    assert slamdb.encode(atlas) == before


def test_a_keypoint_is_one_point_and_a_point_one_keypoint_of_a_picture(atlas):
    map, before = atlas.maps[0], slamdb.encode(atlas)
    row = map.keyframes[0]
    taken = int(np.flatnonzero(row.features.map_points != slamdb.NONE)[0])
    free = int(np.flatnonzero(row.features.map_points == slamdb.NONE)[0])
    stranger = next(point for point in map.points if row.id not in point.observations)
    with pytest.raises(slamdb.UsageError, match="keypoints: row 0 is keypoint .* another point already; a keypoint is"):
        map.add_observations([stranger.id], [row.id], [taken])
    with pytest.raises(slamdb.UsageError, match="points: row 1 is point .* once more"):
        map.add_observations([stranger.id] * 2, [row.id] * 2, [free, free])
    with pytest.raises(slamdb.UsageError, match="points: row 0 is point .* once more"):
        map.add_observations([row.features.map_points[taken]], [row.id], [free])
    assert slamdb.encode(atlas) == before
