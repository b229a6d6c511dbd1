# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
import slamdb


def test_info_is_the_commands(session, command):
    assert slamdb.info(session).to_dict() == command("info", session)


def test_check_is_the_commands(session, command):
    report = slamdb.check(session)
    assert report.to_dict() == command("check", session)
    assert report.sound and report.inputs[0].severities.error == 0


def test_check_finds_what_is_broken(atlas):
    atlas.maps[0].points.positions[3] = np.nan
    report = slamdb.check(atlas)
    assert not report.sound
    [broken] = [rule for rule in report.inputs[0].results if rule.severity == "error"]
    assert broken.count == 1 and broken.findings[0].place.point == atlas.maps[0].points[3].id
    assert slamdb.check(atlas, ignore=[broken.rule]).sound


def test_gates(atlas):
    assert slamdb.check(atlas, gates={"min-keyframes": 10}).sound
    assert not slamdb.check(atlas, gates={"min-keyframes": 100}).sound
    with pytest.raises(slamdb.UsageError):
        slamdb.check(atlas, gates={"no-such-gate": 1})


def test_repair_is_the_commands(session, atlas, command, tmp_path):
    atlas.maps[0].points.positions[3] = np.nan
    slamdb.write(atlas, tmp_path / "broken.osa")
    report = slamdb.repair(atlas)
    theirs = command("repair", tmp_path / "broken.osa", tmp_path / "mended.osa")
    mine = report.to_dict()
    for report_of in (mine, theirs):  # files, which only the command knows, and the journal it was asked for
        del report_of["input"], report_of["output"]
    assert mine == theirs
    assert slamdb.encode(atlas) == (tmp_path / "mended.osa").read_bytes()


def test_recover_is_the_commands(session, command, tmp_path):
    cut = tmp_path / "cut.osa"
    cut.write_bytes(session.read_bytes()[: session.stat().st_size * 2 // 3])
    atlas, report = slamdb.recover(cut)
    theirs = command("recover", cut, tmp_path / "rescued.osa")
    assert report.keyframes.recovered == theirs["keyframes"]["recovered"] and report.losses == theirs["losses"]
    assert slamdb.encode(atlas) == (tmp_path / "rescued.osa").read_bytes()
    (tmp_path / "zeros.osa").write_bytes(bytes(100_000))
    with pytest.raises(slamdb.Error):
        slamdb.recover(tmp_path / "zeros.osa")


def test_diff_is_the_commands(session, fixtures, command):
    other = fixtures / "session_small_b" / "session_small_b.osa"
    assert slamdb.diff(session, other).to_dict() == command("diff", session, other)
    assert slamdb.diff(session, session).verdict == "same"


def test_merge_is_the_commands(session, fixtures, command, tmp_path):
    other = fixtures / "session_small_b" / "session_small_b.osa"
    merged, report = slamdb.merge(session, other)
    theirs = command("merge", session, other, "-o", tmp_path / "both.osa")
    assert slamdb.encode(merged) == (tmp_path / "both.osa").read_bytes()
    mine = report.to_dict()
    del mine["output"], theirs["output"]
    assert mine == theirs
    with pytest.raises(ValueError):
        slamdb.merge(session, other, same_map="sometimes")


def test_inputs_of_a_merge_stay_as_they_are(atlas):
    before = slamdb.encode(atlas)
    slamdb.merge(atlas, atlas)
    assert slamdb.encode(atlas) == before


def test_reports_say_what_they_have(atlas):
    report = slamdb.check(atlas)
    with pytest.raises(AttributeError, match="inputs"):
        report.nothing
    assert report.to_dict()["inputs"][0]["sound"] is True
    assert slamdb.Report.parse('{"a": [{"b": 1}]}').a[0].b == 1
