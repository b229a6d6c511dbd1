# SPDX-License-Identifier: BSD-3-Clause
import shutil

import pytest
import slamdb


@pytest.fixture
def maps(session, fixtures, tmp_path):
    """A folder with two atlases, a damaged one, and one in a folder below; a store of two."""
    folder = tmp_path / "maps"
    (folder / "below").mkdir(parents=True)
    shutil.copy(session, folder / "map2.osa")
    shutil.copy(fixtures / "tiny" / "tiny.osa", folder / "map10.osa")
    shutil.copy(session, folder / "below" / "map2.osa")
    (folder / "cut.osa").write_bytes(session.read_bytes()[:100_000])
    (folder / "notes.txt").write_text("no atlas")
    for name in ("lab", "hall"):
        slamdb.write(slamdb.read(session), f"{folder / 'maps.db'}#{name}")
    return folder


def test_what_names_stand_for(maps):
    found = slamdb.find_atlases(maps, f"{maps}/maps.db#l*", maps / "nothing.osa")
    assert [each.input.replace(f"{maps}/", "") for each in found] == [
        "cut.osa", "map2.osa", "map10.osa", "maps.db#hall", "maps.db#lab", "maps.db#lab", "nothing.osa",
    ]  # fmt: skip
    assert [each.below for each in found][:3] == ["cut.osa", "map2.osa", "map10.osa"]
    assert "below/map2.osa" in [each.below for each in slamdb.find_atlases(maps, recursive=True)]
    [empty] = slamdb.find_atlases(maps / "below" / "..", maps / "below")[-1:]
    assert empty.failure == ""


def test_a_folder_without_atlases_is_an_entry_with_its_failure(tmp_path):
    [nothing] = slamdb.find_atlases(tmp_path)
    assert nothing.failure


@pytest.mark.parametrize("check", [False, True])
def test_list_is_the_commands(maps, command, check):
    mine = slamdb.list_atlases(maps, check=check).to_dict()
    theirs = command("list", maps, *(["--check"] if check else []))
    [failure] = [each.pop("failure") for each in mine["atlases"] if "failure" in each]
    [told] = [each.pop("failure") for each in theirs["atlases"] if "failure" in each]
    assert mine == theirs
    assert failure.replace("slamdb.recover", "slamdb recover") == told.replace("`slamdb recover`", "slamdb recover")


def test_a_summary_is_the_part_of_a_list_about_the_content(maps):
    [listed] = slamdb.list_atlases(maps / "map2.osa")["atlases"]
    summary = slamdb.summarize(slamdb.read(maps / "map2.osa")).to_dict()
    assert summary["keyframes"] == 14
    assert summary == {name: listed[name] for name in summary}


def test_files_appear_whole_and_replace_only_what_they_may(maps, tmp_path):
    slamdb.write_file(tmp_path / "table.csv", b"a\n")
    with pytest.raises(slamdb.AlreadyExistsError):
        slamdb.write_file(tmp_path / "table.csv", b"b\n")
    assert (tmp_path / "table.csv").read_bytes() == b"a\n"
    slamdb.write_file(tmp_path / "table.csv", b"b\n", overwrite=True)
    assert (tmp_path / "table.csv").read_bytes() == b"b\n"
    with pytest.raises(slamdb.AlreadyExistsError):
        slamdb.write_file(maps / "maps.db", b"b\n", overwrite=True)
    with pytest.raises(slamdb.NotFoundError):
        slamdb.write_file(tmp_path / "nowhere" / "table.csv", b"a\n")
