# SPDX-License-Identifier: BSD-3-Clause
import os
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


def test_names_may_be_any_bytes(session, tmp_path):
    path = os.fsdecode(os.fsencode(tmp_path) + b"/\xff.osa")
    shutil.copy(session, path)
    for named in (tmp_path, path):
        assert [each.input for each in slamdb.find_atlases(named)] == [path]
    [listed] = slamdb.list_atlases(path)["atlases"]
    assert listed["keyframes"] == 14 and listed["input"].endswith("\ufffd.osa")
    slamdb.write_file(path + ".csv", b"a\n")
    assert os.listdir(os.fsencode(tmp_path)) and b"\xff.osa.csv" in os.listdir(os.fsencode(tmp_path))


def test_a_folder_without_atlases_is_an_entry_with_its_failure(tmp_path):
    [nothing] = slamdb.find_atlases(tmp_path)
    assert nothing.failure


# Arguments of a function, and words of the command: names are below the folder of `maps`.
LISTS = [
    ([""], {}, ""),
    (["", "maps.db#l*", "nothing.osa"], {"recursive": True}, "-r"),
    ([""], {"check": True, "sort": ["verdict", "-name"]}, "--check --sort verdict,-name"),
    (["maps.db"], {"sort": "-name"}, "--sort=-name"),
    (["", "maps.db"], {"keyframes": (0, 1)}, "--keyframes 0:1"),
    ([""], {"near": ((0, 0, 2), 0.5)}, "--near 0,0,2,0.5"),
    ([""], {"time": (1403636580, 1403636581)}, "--time 1403636580:1403636581"),
    ([""], {"time": (5, 6)}, "--time 5:6"),
    (["map2.osa"], {"format": "orbslam3", "layout": "v1.0"}, "--from orbslam3 --layout v1.0"),
]
CHECKS = [
    ([""], {}, ""),
    (["", "maps.db", "nothing.osa"], {"recursive": True, "warn": "uninitialised"}, "-r --warn uninitialised"),
    (["maps.db"], {"max_findings": 1, "strict": True, "gates": {"min-keyframes": 50}},
     "--max-findings 1 --strict --min-keyframes 50"),
    (["maps.db#l*"], {}, ""),
    (["cut.osa"], {}, ""),
    (["nothing.osa"], {}, ""),
    (["below"], {"vocabulary": "{vocabulary}"}, "--vocabulary {vocabulary}"),
    (["map2.osa"], {"format": "ply"}, "--from ply"),
]  # fmt: skip
REPORTS = [
    ([""], {"recursive": True, "gates": {"min-keyframes": 5}}, "-r --min-keyframes 5"),
    (["maps.db"], {}, ""),
    (["map2.osa", "map10.osa", "nothing.osa"], {"error": "uninitialised"}, "--error uninitialised"),
    (["below/map2.osa"], {}, ""),
]


def both(function, verb, case, maps, fixtures, command, monkeypatch, words=()):
    """What Python and the command tell, each called in the folder of the maps."""
    names, arguments, options = case
    monkeypatch.chdir(maps.parent)
    vocabulary = fixtures / "vocabulary" / "small.txt"
    paths = [os.path.join("maps", name) for name in names]
    given = {key: vocabulary if value == "{vocabulary}" else value for key, value in arguments.items()}
    asked = [str(vocabulary) if word == "{vocabulary}" else word for word in options.split()]
    return function(paths, **given), command(verb, *paths, *asked, *words)


@pytest.mark.parametrize("case", LISTS, ids=str)
def test_lists_are_the_commands(case, maps, fixtures, command, monkeypatch):
    mine, theirs = both(lambda paths, **given: slamdb.list_atlases(*paths, **given), "list", case, maps, fixtures,
                        command, monkeypatch)  # fmt: skip
    assert mine.to_dict() == theirs


def test_lists_are_sorted_by_what_there_is(maps):
    with pytest.raises(slamdb.UsageError, match="none of name, input, maps"):
        slamdb.list_atlases(maps, sort="sise")
    assert [each["name"] for each in slamdb.Store(maps / "maps.db").list(sort="-name")["atlases"]] == ["lab", "hall"]


@pytest.mark.filterwarnings("ignore::slamdb.SlamdbWarning")
@pytest.mark.parametrize("case", CHECKS, ids=str)
def test_checks_are_the_commands(case, maps, fixtures, command, monkeypatch):
    mine, theirs = both(lambda paths, **given: slamdb.check(*paths, **given), "check", case, maps, fixtures,
                        command, monkeypatch)  # fmt: skip
    assert mine.to_dict() == theirs
    assert mine.sound == all(each.get("sound", False) for each in theirs["inputs"])


def test_atlases_in_memory_are_checked_beside_files(maps, atlas):
    one, both_ = slamdb.check(atlas), slamdb.check(atlas, maps / "cut.osa", maps / "map2.osa")
    assert [each["input"] for each in both_["inputs"]] == ["", str(maps / "cut.osa"), str(maps / "map2.osa")]
    assert both_["inputs"][0] == one["inputs"][0]
    assert "truncated" in both_["inputs"][1]["failure"] and not both_.sound
    assert {**both_["inputs"][2], "input": ""} == one["inputs"][0]


def test_nothing_to_check_is_an_error(tmp_path, atlas):
    slamdb.write(atlas, tmp_path / "empty.db#lab")
    slamdb.Store(tmp_path / "empty.db").remove("lab")
    for nothing in ([], [tmp_path / "empty.db"]):
        with pytest.raises(slamdb.NotFoundError, match="no atlas to check"):
            slamdb.check(*nothing)


def test_what_is_thrown_by_progress_stops_a_check_of_many(maps):
    class Enough(Exception):
        pass

    def stop(stage, fraction):
        raise Enough(stage)

    with pytest.raises(Enough):
        slamdb.check(maps, progress=stop)


@pytest.mark.filterwarnings("ignore::slamdb.SlamdbWarning")
@pytest.mark.parametrize("case", REPORTS, ids=str)
def test_reports_and_their_pages_are_the_commands(case, maps, fixtures, command, monkeypatch):
    one = case[0] == ["below/map2.osa"]
    outputs = [maps.parent / name / ("lab.html" if one else "pages") for name in ("mine", "theirs")]
    for output in outputs:
        output.parent.mkdir()
    mine, theirs = both(lambda paths, **given: slamdb.report(paths, outputs[0], **given), "report", case, maps,
                        fixtures, command, monkeypatch, words=["-o", str(outputs[1])])  # fmt: skip
    assert {**mine.report.to_dict(), "output": None} == {**theirs, "output": None}
    files = [{path.name: path.read_bytes() for path in output.parent.rglob("*.html")} for output in outputs]
    readable = sum("failure" not in each for each in theirs["inputs"])
    assert files[0] == files[1] and len(files[0]) == (1 if one else 1 + readable)
    assert mine.html.encode() == files[0]["lab.html" if one else "index.html"]


def test_several_pages_need_a_folder_and_replace_only_what_they_may(maps):
    for nowhere in (None, maps / "all.html"):
        with pytest.raises(slamdb.UsageError, match="several pages need a folder"):
            slamdb.report(maps, nowhere)
    slamdb.report([maps / "map2.osa", maps / "map10.osa"], maps.parent / "pages")
    with pytest.raises(slamdb.AlreadyExistsError):
        slamdb.report(maps / "maps.db", maps.parent / "pages")
    assert not (maps.parent / "pages" / "lab.html").exists()
    with pytest.raises(slamdb.UsageError, match="a page is an .html|is the input"):
        slamdb.report(maps / "map2.osa", maps / "map2.osa")
    with pytest.raises(slamdb.NotFoundError, match="no atlas to report on"):
        slamdb.report([])


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


def test_a_page_tells_of_an_atlas_and_its_name_is_no_markup(atlas):
    page = slamdb.report(atlas, name="<b>lab</b>")
    assert page.html.startswith("<!DOCTYPE html>") and "3,162" in page.html
    assert "&lt;b&gt;lab" in page.html and "<b>lab" not in page.html
    assert page.report["inputs"][0]["input"] == "<b>lab</b>" and page.report["inputs"][0]["sound"]
    assert page.thumbnail[:8] in (b"", b"\x89PNG\r\n\x1a\n")


def test_pages_of_atlases_in_memory(atlas, tmp_path):
    page = slamdb.report([atlas, atlas], tmp_path / "pages", name="lab")
    assert sorted(path.name for path in (tmp_path / "pages").iterdir()) == ["index.html", "lab-2.html", "lab.html"]
    assert page.html == (tmp_path / "pages" / "index.html").read_text()
