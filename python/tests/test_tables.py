# SPDX-License-Identifier: BSD-3-Clause
import sys

import numpy as np
import pytest
import slamdb


def test_tables_of_points_and_keyframes(atlas):
    pytest.importorskip("pandas")
    points, keyframes = atlas.maps[0].points, atlas.maps[0].keyframes
    frame = points.to_pandas()
    assert len(frame) == len(points) and frame["id"].tolist() == points.ids.tolist()
    assert np.array_equal(frame[["x", "y", "z"]].to_numpy(), points.positions)
    assert np.array_equal(frame["observations"], points.observation_counts)
    frame = keyframes.to_pandas()
    assert np.array_equal(frame["timestamp"], keyframes.timestamps) and frame["id"].tolist() == keyframes.ids.tolist()
    assert np.array_equal(frame[["x", "y", "z"]].to_numpy(), keyframes.centers)
    x, y, z, w = frame[["qx", "qy", "qz", "qw"]].to_numpy().T
    assert np.allclose(keyframes.poses[:, 0, 0], 1 - 2 * (y * y + z * z), atol=1e-6)
    assert np.allclose(keyframes.poses[:, 1, 0], 2 * (x * y + z * w), atol=1e-6)


def test_ids_that_are_none_are_no_numbers(atlas):
    pytest.importorskip("pandas")
    parents = atlas.maps[0].keyframes.to_pandas()["parent"]
    roots = atlas.maps[0].keyframes.parents == slamdb.NONE
    assert roots.sum() == 1 and np.array_equal(parents.isna(), roots) and parents.max() < 14


def test_tables_are_copies(atlas):
    pytest.importorskip("pandas")
    frame = atlas.maps[0].points.to_pandas()
    frame["x"] = 7.0
    assert not (atlas.maps[0].points.positions[:, 0] == 7).any()


def test_rotations_that_are_none_are_nan(atlas):
    pytest.importorskip("pandas")
    atlas.maps[0].keyframes.camera_from_world[0] = 0
    frame = atlas.maps[0].keyframes.to_pandas()
    assert frame["qw"].isna().tolist() == [True] + [False] * 13


def test_findings_as_a_table(atlas, tmp_path):
    pd = pytest.importorskip("pandas")
    atlas.maps[0].points.positions[3] = np.nan
    report = slamdb.check(atlas)
    frame = report.to_pandas()
    assert len(frame) == sum(len(result["findings"]) for result in report["inputs"][0]["results"])
    [broken] = frame[frame["severity"] == "error"].itertuples()
    assert broken.point == atlas.maps[0].points[3].id and broken.keyframe is pd.NA and broken.count == 1
    store = slamdb.Store(tmp_path / "maps.db")
    store.save("lab", atlas)
    whole = pd.concat([store.check().to_pandas(), slamdb.CheckReport({"inputs": []}).to_pandas()])
    assert set(whole["input"]) == {f"{tmp_path}/maps.db#lab"} and len(whole) == len(frame)


def test_inputs_that_could_not_be_read_are_rows(atlas):
    pytest.importorskip("pandas")
    failed = slamdb.CheckReport({"inputs": [{"input": "a.osa", "failure": "gone"}]})
    [row] = failed.to_pandas().to_dict("records")
    assert (row["input"], row["rule"], row["severity"], row["message"]) == ("a.osa", "unreadable", "error", "gone")
    assert not failed.sound


@pytest.mark.parametrize("of", ["points", "keyframes", "report"])
def test_without_pandas_an_error_says_what_to_install(of, atlas, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    things = {"points": atlas.maps[0].points, "keyframes": atlas.maps[0].keyframes, "report": slamdb.check(atlas)}
    with pytest.raises(ImportError, match="python3-pandas"):
        things[of].to_pandas()
