# SPDX-License-Identifier: BSD-3-Clause
"""Atlases, rows and reports are as Python's own objects: equal, counted, copied, shown."""

import concurrent.futures
import copy
import errno
import json
import pickle
import subprocess
import sys
import warnings

import numpy as np
import pytest
import slamdb
from real_atlases import path_of, real_atlases

CLASSES = ("Atlas", "Map", "KeyFrames", "KeyFrame", "Points", "MapPoint", "Features", "Landmarks", "Edit", "Journal")


@pytest.mark.parametrize("name", CLASSES)
def test_nothing_is_made_that_holds_nothing(name):
    program = f"import slamdb; bare = slamdb.{name}.__new__(slamdb.{name}); repr(bare); dir(bare)"
    done = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1 and "TypeError" in done.stderr
    if name != "Atlas":
        with pytest.raises(TypeError):
            getattr(slamdb, name)()


def test_a_class_may_be_derived_from_atlas(session):
    class Named(slamdb.Atlas):
        def __init__(self, name):
            super().__init__()
            self.name = name

    assert Named("a").name == "a" and Named("a").maps == []


FIXED = {
    "points": ("ids", "first_keyframes", "first_frames", "reference_keyframes", "replaced_by", "weights"),
    "keyframes": ("ids", "parents", "frame_ids", "previous", "next", "integration_biases"),
    "landmarks": ("ids",),
}
FREE = {
    "points": ("positions", "normals", "descriptors", "min_distances", "max_distances"),
    "keyframes": ("timestamps", "camera_from_world", "velocities", "accelerometer_biases", "gyroscope_biases"),
    "landmarks": ("means", "normals", "seen_counts"),
}


def test_ids_and_links_are_read_only(atlas):
    slamdb.landmarks_from_points(atlas)
    map = atlas.maps[0]
    for names, is_free in ((FIXED, False), (FREE, True)):
        for kind, columns in names.items():
            for name in columns:
                array = getattr(getattr(map, kind), name)
                assert len(array) > 0 and array.flags.writeable == is_free, f"{kind}.{name}"
                doc = getattr(type(getattr(map, kind)), name).__doc__
                assert ("writable" in doc) == is_free, f"{kind}.{name}"
                assert np.shares_memory(array, getattr(getattr(map, kind), name))


def test_rows_of_one_place_are_equal(atlas):
    map = atlas.maps[0]
    for take in (
        lambda a: a.maps[0], lambda a: a.maps[0].points, lambda a: a.maps[0].keyframes, lambda a: a.maps[0].points[5],
        lambda a: a.maps[0].keyframes[5], lambda a: a.maps[0].keyframes[5].features, lambda a: a.maps[0].landmarks,
    ):  # fmt: skip
        assert take(atlas) == take(atlas) and hash(take(atlas)) == hash(take(atlas))
        assert take(atlas) != take(atlas.copy()) and take(atlas) != 5
    assert map.points[5] in set(map.points[3:9]) and map.points[0] not in map.points[3:9]
    assert map.points[5] == map.points.by_id(int(map.points.ids[5])) != map.points[6]
    before = map.points[5]
    map.remove_points([int(map.points.ids[-1])])
    assert map.points[5] != before  # which shows the atlas as it was


@pytest.mark.parametrize("kind", ["points", "keyframes"])
def test_rows_are_taken_as_of_a_list(atlas, kind):
    rows = getattr(atlas.maps[0], kind)
    all_of_them = list(rows)
    assert [row.id for row in all_of_them] == rows.ids.tolist() and len(rows) == len(all_of_them)
    for taken in (slice(3, 9), slice(None, None, -1), slice(-4, None, 2), slice(9, 3), slice(10**9)):
        assert rows[taken] == all_of_them[taken]
    mask = rows.ids % 3 == 0
    assert rows[mask] == [row for row in all_of_them if row.id % 3 == 0] == rows[mask.tolist()]
    assert rows[np.int64(-2)] == all_of_them[-2]
    for wrong in ("3", 1.5, None, [1, 2], rows.ids, (1, 2), np.zeros((2, 2), bool)):
        with pytest.raises(TypeError, match="a number, a slice or a mask"):
            rows[wrong]
    for wrong in (len(rows), -len(rows) - 1, 2**70, mask[1:]):
        with pytest.raises(IndexError):
            rows[wrong]


def test_reprs_tell_how_many(atlas):
    map = atlas.maps[0]
    slamdb.landmarks_from_points(atlas)
    assert repr(map.points) == f"<slamdb.Points: {len(map.points)} points of map 0>"
    assert repr(map.keyframes) == "<slamdb.KeyFrames: 14 keyframes of map 0>"
    assert repr(map.landmarks) == f"<slamdb.Landmarks: {len(map.landmarks)} landmarks of map 0>"
    features = map.keyframes[3].features
    assert repr(features) == f"<slamdb.Features: {len(features)} keypoints of keyframe {map.keyframes[3].id}>"
    edit = atlas.edit()
    assert repr(edit) == "<slamdb.Edit: open>"
    edit.maps[0].points.positions[0] = 1
    edit.commit()
    assert repr(edit) == "<slamdb.Edit: put in place, 1 edit>"


def test_a_point_has_its_descriptor(atlas):
    points = atlas.maps[0].points
    assert np.array_equal(points[7].descriptor, points.descriptors[7])
    assert np.shares_memory(points[7].descriptor, points.descriptors)


def test_rows_of_fisheye_pairs_stand_behind_each_other():
    path = path_of("fisheye_stereo")
    if not path.exists():
        pytest.skip("fisheye_stereo is not there")
    map = slamdb.read(path).maps[0]
    features = map.keyframes[0].features
    left, right = len(features.keypoints), len(features.right_keypoints)
    assert right > 0 and len(features) == left + right
    for name in ("descriptors", "map_points", "word_nodes"):
        assert len(getattr(features, name)) == left + right and "(N + M," in getattr(slamdb.Features, name).__doc__
    for name, rows in (("undistorted", left), ("right_of_left", left), ("left_of_right", right)):
        assert len(getattr(features, name)) in (0, rows), name
    seen = map.points.observations
    slots = {row.id: row.features.map_points for row in map.keyframes}
    points = np.repeat(map.points.ids, map.points.observation_counts)
    same = [slots[k][r] == p for k, r, p in zip(seen.keyframes.tolist(), seen.right.tolist(), points) if r >= 0]
    assert len(same) > 100 and np.mean(same) > 0.9


# ---- Copies


def alike(one, other):
    assert slamdb.diff(one, other).verdict == "same"
    assert slamdb.encode(one, format="ndjson") == slamdb.encode(other, format="ndjson")


@pytest.mark.parametrize("name", real_atlases())
def test_an_atlas_is_pickled_whole(name):
    if not path_of(name).exists():
        pytest.skip(f"{name} is not there")
    atlas = slamdb.read(path_of(name))
    again = pickle.loads(pickle.dumps(atlas))
    assert slamdb.encode(again) == slamdb.encode(atlas)


def test_what_an_osa_file_lacks_is_pickled(atlas):
    slamdb.landmarks_from_points(atlas)
    again = pickle.loads(pickle.dumps(atlas))
    assert len(again.maps[0].landmarks) == len(atlas.maps[0].landmarks) > 0
    alike(again, atlas)


@pytest.mark.parametrize("how", [copy.copy, copy.deepcopy, slamdb.Atlas.copy])
def test_copies_are_apart_and_whole(atlas, how):
    slamdb.landmarks_from_points(atlas)
    other = how(atlas)
    alike(other, atlas)
    other.maps[0].points.positions[:] = 0
    assert atlas.maps[0].points.positions.any()


def culled(path):
    atlas = slamdb.read(path)
    slamdb.cull(atlas, min_observations=5)
    return atlas


def test_processes_give_atlases_back(session):
    with concurrent.futures.ProcessPoolExecutor(1) as pool:
        alike(pool.submit(culled, session).result(), culled(session))


# ---- Reports and errors


def test_a_report_is_a_mapping(atlas):
    report = slamdb.check(atlas)
    values = report.to_dict()
    assert dict(report) == values and len(report) == len(values) and list(report.keys()) == list(values)
    assert list(report.items()) == list(values.items()) and report.get("nothing", 7) == 7
    assert {**report} == values and json.dumps(dict(report)) == json.dumps(values)
    values["inputs"][0]["sound"] = "changed"
    assert report.inputs[0].sound is True and report["inputs"][0]["sound"] is True  # to_dict is a copy
    assert pickle.loads(pickle.dumps(report)) == report == copy.deepcopy(report)


def test_a_report_shows_its_upper_level(atlas):
    atlas.maps[0].points.positions[:500] = np.nan
    report = slamdb.check(atlas, max_findings=1000)
    assert len(repr(report)) < 200
    assert repr(report).startswith("<slamdb.CheckReport: report='slamdb-check-2', inputs=[1]")
    culled = slamdb.repair(atlas)
    assert len(repr(culled)) < 1000 and "\n" not in repr(culled)


def test_findings_are_those_of_all_rules(atlas):
    atlas.maps[0].points.positions[3] = np.nan
    report = slamdb.check(atlas)
    kept = [finding for result in report["inputs"][0]["results"] for finding in result["findings"]]
    assert len(report.findings) == len(kept) > 0
    error = next(finding for finding in report.findings if finding.severity == "error")
    assert error.rule and error.message and error.count >= 1


def test_errors_of_the_system_have_its_fields(atlas, session, tmp_path):
    with pytest.raises(FileNotFoundError) as raised:
        slamdb.read(tmp_path / "none.osa")
    assert (raised.value.errno, raised.value.filename) == (errno.ENOENT, str(tmp_path / "none.osa"))
    assert raised.value.strerror == "No such file or directory"
    slamdb.write(atlas, tmp_path / "a.osa")
    with pytest.raises(FileExistsError) as raised:
        slamdb.write(atlas, tmp_path / "a.osa")
    assert (raised.value.errno, raised.value.filename) == (errno.EEXIST, str(tmp_path / "a.osa"))
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.path, again.errno) == (str(raised.value), raised.value.path, errno.EEXIST)
    denied = slamdb.AccessDeniedError("is denied", "a.osa", "keyframe 3")
    assert (denied.errno, denied.filename, str(denied)) == (errno.EACCES, "a.osa", "a.osa: keyframe 3: is denied")
    assert slamdb.NotFoundError("no such point").filename is None


def test_warnings_come_when_it_is_done(atlas, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(slamdb.LossWarning):
            slamdb.write(atlas, tmp_path / "a.msg")
        with pytest.raises(slamdb.NotPossibleError):
            slamdb.write(atlas, tmp_path / "b.msg", strict=True)
        with pytest.raises(slamdb.SlamdbWarning):
            atlas.maps[0].remove_points(atlas.maps[0].points.ids)
    assert (tmp_path / "a.msg").exists() and not (tmp_path / "b.msg").exists()
    assert len(atlas.maps[0].points) == 0
