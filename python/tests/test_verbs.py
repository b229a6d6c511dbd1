# SPDX-License-Identifier: BSD-3-Clause
"""Every verb does in Python what the command of that name does: the same report, and the same atlas."""

import numpy as np
import pytest
import slamdb

BOX = ((-5, -2, -5), (1, 2, 4))
POLYGON = [(-5, -5), (1, -5), (1, 4), (-5, 4)]
QUARTER_TURN = (1, 0, 0, 0, 0, 0.70710678, 0.70710678)

# Verbs that change an atlas: function, its arguments, and those of the command. Names in braces are files of `files`.
CHANGES = [
    ("extract", {"keyframes": (2, 9)}, "--keyframes 2:9"),
    ("extract", {"keyframe": [1, 2, 5], "except_": True}, "--keyframe 1,2,5 --except"),
    ("extract", {"box": BOX, "border": "strict"}, "--box=-5,-2,-5:1,2,4 --border strict"),
    ("extract", {"polygon": POLYGON, "plane": "xz", "region": "points"},
     ["--polygon=-5,-5 1,-5 1,4 -5,4", "--plane", "xz", "--region", "points"]),
    ("extract", {"every": 3, "map": 0}, "--every 3 --map 0"),
    ("cull", {}, ""),
    ("cull", {"redundant": 0.5, "observers": 2}, "--redundant 0.5 --observers 2"),
    ("cull", {"max_error": 1, "min_parallax": 1, "min_observations": 0},
     "--max-error 1 --min-parallax 1 --min-observations 0"),
    ("cull", {"unseen_since": 1403636585.0}, "--unseen-since 1403636585"),
    ("shrink", {"target_keyframes": 8, "min_points": 20}, "--target-keyframes 8 --min-points 20"),
    ("shrink", {"target_mb": 2.5, "for_": "mapping"}, "--target-mb 2.5 --for mapping"),
    ("shrink", {"for_": "localization", "largest_map": True}, "--for localization --largest-map"),
    ("fragments", {"min_keyframes": 2, "largest": 1, "order": "size"}, "--min-keyframes 2 --largest 1 --order size"),
    ("renumber", {"start": 100, "order": "time"}, "--start 100 --order time"),
    ("renumber", {"offset": 1000, "kinds": ["keyframe", "point"]}, "--offset 1000 --kinds keyframe,point"),
    ("reassign_origin", {"map": {0: 7}, "shift": 1}, "--map 0=7 --shift 1"),
    ("reassign_origin", {"set": 3, "compact": True}, "--set 3 --compact"),
    ("transform", {"scale": 2}, "--scale 2"),
    ("transform", {"axes": "camera:ros", "map": 0}, "--axes camera:ros --map 0"),
    ("transform", {"by": QUARTER_TURN}, ["--by", " ".join(map(str, QUARTER_TURN))]),
    ("transform", {"gravity": "cameras"}, "--gravity cameras"),
    ("transform", {"onto": "{truth}", "robust": 0.05, "with_scale": True}, "--onto {truth} --robust 0.05 --with-scale"),
    ("optimize", {"iterations": 3, "fix_points": True}, "--iterations 3 --fix-points"),
    ("close_loops", {"optimize": "pose-graph"}, "--optimize pose-graph"),
    ("landmarks_from_points", {"sigma": 2}, "--sigma 2"),
    ("vocabulary_recompute", {"vocabulary": "{vocabulary}"}, "--vocabulary {vocabulary}"),
    ("edit_tables", {"points": "{points}", "delete_missing": True}, "--points {points} --delete-missing"),
    ("repair", {}, ""),
]  # fmt: skip

VERBS = {
    "edit_tables": ["edit"],
    "landmarks_from_points": ["landmarks", "from-points"],
    "vocabulary_recompute": ["vocabulary", "recompute"],
}

# Verbs that change nothing: arguments are files of `files`.
LOOKS = [
    ("info", ["{session}"], {}, ""),
    ("check", ["{session}"], {"gates": {"min-keyframes": 100}, "warn": "uninitialised"},
     "--min-keyframes 100 --warn uninitialised"),
    ("diff", ["{session}", "{other}"], {"max_listed": 3}, "--max-listed 3"),
    ("align", ["{session}", "{other}"], {}, ""),
    ("locate", ["{session}"], {"benchmark": True, "most": 5}, "--benchmark --most 5"),
    ("locate", ["{corner}", "{a01}", "{b01}"], {}, ""),
    ("evaluate", ["{session}", "{truth}"], {"delta": "1f", "max_ate_rmse": 0.001, "errors": True},
     "--delta 1f --max-ate-rmse 0.001 --errors"),
    ("evaluate", ["{session}", "{session}"], {"by_index": True, "align": "sim3"}, "--by-index --align sim3"),
    ("convert", ["{session}", "{new.ply}"], {"color": "height", "ascii": True}, "--color height --ascii"),
    ("convert", ["{session}", "{new.tum}"], {}, ""),
    ("convert", ["{session}", "{new.db#lab}"], {"keyframes": (1, 5)}, "--keyframes 1:5"),
    ("convert", ["{session}", "{new.db}"], {}, ""),
    ("convert", ["{truth}", "{new.osa}"], {"onto": "{session}", "dry_run": True}, "--onto {session} --dry-run"),
    ("convert", ["{session}", "{new.osa}"], {"text": True, "long_bytes": 4}, "--text --long-bytes 4"),
    ("layouts_list", [], {}, ""),
    ("layouts_infer", ["{session}"], {}, ""),
    ("vocabulary_show", ["{session}", "{vocabulary}"], {}, ""),
]  # fmt: skip


@pytest.fixture
def files(session, fixtures, tmp_path):
    """Files by the names that parameters have for them; new ones are not there yet."""
    vocabulary = fixtures / "vocabulary" / "small.txt"
    tables = tmp_path / "points.csv"
    slamdb.write(slamdb.read(session), tables, format="csv")
    rows = tables.read_text().splitlines()
    tables.write_text("\n".join(rows[: len(rows) // 2]) + "\n")
    known = {
        "session": session, "other": fixtures / "session_small_b" / "session_small_b.osa",
        **{name: fixtures / "room" / f"{name}.jpg" for name in ("a01", "b01")},
        "corner": fixtures / "room" / "corner.osa",
        "truth": session.parent / "truth.txt", "vocabulary": vocabulary, "points": tables,
    }  # fmt: skip

    def named(value, folder):
        if not isinstance(value, str) or not value.startswith("{"):
            return value
        name = value.strip("{}")
        return known[name] if name in known else folder / name

    return named


def words_of(options, files, folder):
    return [str(files(word, folder)) for word in (options.split() if isinstance(options, str) else options)]


def without_files(report):
    return {name: value for name, value in report.items() if name not in ("input", "output")}


@pytest.mark.filterwarnings("ignore::slamdb.SlamdbWarning")
@pytest.mark.parametrize("function, arguments, options", CHANGES, ids=lambda value: str(value)[:30])
def test_changes_are_the_commands(function, arguments, options, session, atlas, command, files, tmp_path):
    given = {name: files(value, tmp_path) for name, value in arguments.items()}
    report = getattr(slamdb, function)(atlas, **given)
    verb = VERBS.get(function, [function.replace("_", "-")])
    out = tmp_path / ("out.db" if function == "landmarks_from_points" else "out.osa")
    theirs = command(*verb, session, out, *words_of(options, files, tmp_path))
    assert without_files(report.to_dict()) == without_files(theirs)
    assert report.to_dict()["input"] is None  # an atlas has no file
    assert slamdb.encode(atlas) == slamdb.encode(slamdb.read(out))


@pytest.mark.filterwarnings("ignore::slamdb.SlamdbWarning")
@pytest.mark.parametrize("function, sources, arguments, options", LOOKS, ids=lambda value: str(value)[:30])
def test_looks_are_the_commands(function, sources, arguments, options, command, files, tmp_path, monkeypatch):
    verb = {"layouts_list": ["layouts", "list"], "layouts_infer": ["layouts", "infer"],
            "vocabulary_show": ["vocabulary", "show"]}.get(function, [function])  # fmt: skip
    reports = []
    for folder in (tmp_path / "mine", tmp_path / "theirs"):  # the same names of outputs
        folder.mkdir()
        monkeypatch.chdir(folder)
        paths = [str(files(source, folder)).replace(str(folder) + "/", "") for source in sources]
        given = {name: files(value, folder) for name, value in arguments.items()}
        if folder.name == "mine":
            reports.append(getattr(slamdb, function)(*paths, **given).to_dict())
        else:
            reports.append(command(*verb, *paths, *words_of(options, files, folder)))
    assert reports[0] == reports[1]
    mine, theirs = ([path.name for path in sorted(folder.iterdir())] for folder in (tmp_path / "mine", tmp_path / "theirs"))
    assert [name for name in mine if not name.endswith("-shm")] == [name for name in theirs if not name.endswith("-shm")]
    for name in mine:
        if not name.startswith("new.db"):  # which has times
            assert (tmp_path / "mine" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes()


def test_check_finds_what_is_broken(atlas):
    atlas.maps[0].points.positions[3] = np.nan
    report = slamdb.check(atlas)
    assert not report.sound
    [broken] = [rule for rule in report.inputs[0].results if rule.severity == "error"]
    assert broken.count == 1 and broken.findings[0].place.point == atlas.maps[0].points[3].id
    assert slamdb.check(atlas, ignore=[broken.rule]).sound
    with pytest.raises(slamdb.UsageError):
        slamdb.check(atlas, gates={"no-such-gate": 1})


def test_repair_is_the_commands_and_is_taken_back(atlas, command, tmp_path):
    atlas.maps[0].points.positions[3] = np.nan
    before = slamdb.encode(atlas)
    slamdb.write(atlas, tmp_path / "broken.osa")
    report = slamdb.repair(atlas, journal=tmp_path / "mine.json")
    theirs = command("repair", tmp_path / "broken.osa", tmp_path / "mended.osa", "--journal", tmp_path / "theirs.json")
    assert without_files(report.to_dict()) == without_files(theirs)
    assert slamdb.encode(atlas) == (tmp_path / "mended.osa").read_bytes()
    assert (tmp_path / "mine.json").read_bytes() == (tmp_path / "theirs.json").read_bytes()
    assert slamdb.repair(atlas, undo=tmp_path / "mine.json").to_dict()["edits"] > 0
    assert slamdb.encode(atlas) == before
    with pytest.raises(slamdb.UsageError, match="undo="):
        slamdb.repair(atlas, undo=tmp_path / "mine.json", rule="no-such")


def test_recover_is_the_commands(session, command, tmp_path):
    cut = tmp_path / "cut.osa"
    cut.write_bytes(session.read_bytes()[: session.stat().st_size * 2 // 3])
    with pytest.warns(slamdb.LossWarning):
        atlas, report = slamdb.recover(cut)
    theirs = command("recover", cut, tmp_path / "rescued.osa")
    assert without_files(report.to_dict()) == without_files(theirs)
    assert slamdb.encode(atlas) == (tmp_path / "rescued.osa").read_bytes()
    (tmp_path / "zeros.osa").write_bytes(bytes(100_000))
    with pytest.raises(slamdb.Error):
        slamdb.recover(tmp_path / "zeros.osa")


@pytest.mark.filterwarnings("ignore::slamdb.SlamdbWarning")
@pytest.mark.parametrize(
    "arguments, options",
    [
        ({}, ""),
        ({"align": True}, "--align"),
        ({"align": True, "optimize": "none", "fuse": False}, "--align --optimize none"),
        ({"join": True, "transform": QUARTER_TURN, "fuse": True}, ["--join", "--fuse", "--transform", " ".join(map(str, QUARTER_TURN))]),
    ],
    ids=["beside", "align", "align-plain", "join"],
)  # fmt: skip
def test_merge_is_the_commands(arguments, options, session, fixtures, command, tmp_path):
    if arguments.get("fuse") is False:
        pytest.skip("the command fuses what it aligns, unless --no-fuse, which needs --join")
    other = fixtures / "session_small_b" / "session_small_b.osa"
    merged, report = slamdb.merge(session, other, id_map=tmp_path / "mine.csv", **arguments)
    words = options.split() if isinstance(options, str) else options
    theirs = command("merge", session, other, "-o", tmp_path / "both.osa", "--id-map", tmp_path / "theirs.csv", *words)
    assert slamdb.encode(merged) == (tmp_path / "both.osa").read_bytes()
    assert without_files(report.to_dict()) == without_files(theirs)
    assert (tmp_path / "mine.csv").read_text() == (tmp_path / "theirs.csv").read_text()


@pytest.mark.parametrize(
    "arguments, options",
    [({}, ""), ({"geometry": "ours", "prefer": "theirs", "fuse": False}, "--geometry ours --prefer theirs --no-fuse")],
)
def test_merge_of_continuations_is_the_commands(arguments, options, session, command, tmp_path):
    parts = {"base": [0, 1, 2, 3, 4], "ours": [0, 1, 2, 3, 4, 5, 6], "theirs": [0, 1, 2, 3, 4, 7, 8]}
    base, ours, theirs = (tmp_path / f"{name}.osa" for name in parts)
    for path, keyframes in zip((base, ours, theirs), parts.values()):
        command("extract", session, path, "--keyframe", ",".join(map(str, keyframes)))
    merged, report = slamdb.merge(ours, theirs, base=base, **arguments)
    told = command("merge", "--base", base, ours, theirs, "-o", tmp_path / "both.osa", *options.split())
    assert slamdb.encode(merged) == (tmp_path / "both.osa").read_bytes()
    assert without_files(report.to_dict()) == without_files(told)
    assert len(merged.maps[0].keyframes) == 9
    with pytest.raises(slamdb.UsageError, match="goes with base= only"):
        slamdb.merge(ours, theirs, geometry="ours")
    with pytest.raises(slamdb.UsageError, match="does not go with base="):
        slamdb.merge(ours, theirs, base=base, align=True)


def test_branches_of_a_store_name_their_base(tmp_path, session):
    store = slamdb.Store(tmp_path / "s.db")
    atlas = slamdb.read(session)
    store.save("lab", atlas)
    store.branch("lab", "robot")
    atlas.maps[0].points.positions[0] += 1
    store.save("robot", atlas, overwrite=True)
    lab, robot = f"{tmp_path}/s.db#lab", f"{tmp_path}/s.db#robot"
    with pytest.warns(slamdb.SlamdbWarning, match="base='.*s.db#lab@1' merges them three ways"):
        both, _ = slamdb.merge(lab, robot)
    assert len(both.maps) == 2
    merged, _ = slamdb.merge(lab, robot, base=f"{lab}@1")
    assert len(merged.maps) == 1


def test_merge_refuses_what_does_not_overlap(session):
    rooms = slamdb.synthesize(maps=2, keyframes=10, points=400, look_alike=True)
    with pytest.raises(slamdb.NotPossibleError, match="no map could be aligned"):
        slamdb.merge(rooms, align=True)
    with pytest.raises(ValueError, match="on_conflict= is one of 'error', 'keep-first', 'renumber'"):
        slamdb.merge(session, session, on_conflict="sometimes")


def test_split_is_the_commands(fixtures, command, tmp_path):
    source = fixtures / "mono_small_twice" / "mono_small_twice.osa"
    parts, report = slamdb.split(source, by="session")
    theirs = command("split", source, tmp_path / "{}.osa", "--by", "session")
    assert [{**part, "output": None} for part in report.to_dict()["parts"]] == [
        {**part, "output": None} for part in theirs["parts"]
    ]
    for name, part in parts.items():
        assert slamdb.encode(part) == (tmp_path / f"{name}.osa").read_bytes()


def test_synthesize_is_the_commands(command, tmp_path):
    atlas = slamdb.synthesize(sensor="stereo", maps=2, keyframes=5, points=100, overlap=0.6, truth=tmp_path / "mine")
    options = "--sensor stereo --maps 2 --keyframes 5 --points 100 --overlap 0.6 --truth".split()
    command("synthesize", tmp_path / "made.osa", *options, tmp_path / "theirs", json=False)
    assert slamdb.encode(atlas) == (tmp_path / "made.osa").read_bytes()
    assert (tmp_path / "mine").read_text() == (tmp_path / "theirs").read_text()
    assert slamdb.check(atlas).sound


def test_plots_are_the_commands(session, atlas, command, tmp_path):
    for options, arguments in (([], {}), (["--kind", "plan", "--dark"], {"kind": "plan", "dark": True}),
                               (["--with", session.parent / "truth.txt"], {"with_": session.parent / "truth.txt"})):  # fmt: skip
        command("plot", session, "-O", "-o", tmp_path / "theirs.svg", *options, json=False)
        drawn = slamdb.plot(session, tmp_path / "mine.svg", overwrite=True, **arguments)
        assert drawn == (tmp_path / "mine.svg").read_bytes() == (tmp_path / "theirs.svg").read_bytes()
    assert slamdb.plot(atlas, picture="png").startswith(b"\x89PNG")
    (tmp_path / "precious.svg").write_bytes(session.read_bytes())
    with pytest.raises(slamdb.AlreadyExistsError, match="is an atlas"):
        slamdb.plot(atlas, tmp_path / "precious.svg", overwrite=True)


def test_reports_are_the_commands(session, command, tmp_path):
    page, report, _ = slamdb.report(session, tmp_path / "mine.html", gates={"min-keyframes": 20})
    theirs = command("report", session, "-o", tmp_path / "theirs.html", "--min-keyframes", "20")
    assert without_files(report.to_dict()) == without_files(theirs)
    assert page == (tmp_path / "mine.html").read_text() == (tmp_path / "theirs.html").read_text()


def test_landmarks_and_back(atlas, session):
    slamdb.landmarks_from_points(atlas)
    moved, where = slamdb.read(session), slamdb.read(session).maps[0].points.positions
    moved.maps[0].points.positions[:] = 0
    report = slamdb.landmarks_to_points(atlas, into=moved)
    assert report.to_dict()["input"] is None and np.array_equal(moved.maps[0].points.positions, where)
    atlas.maps[0].points.positions[:] = 0
    slamdb.landmarks_to_points(atlas)
    assert np.array_equal(atlas.maps[0].points.positions, where)


def test_the_vocabulary_of_an_atlas(atlas, fixtures):
    vocabulary = fixtures / "vocabulary" / "small.txt"
    assert slamdb.vocabulary_verify(atlas, vocabulary=vocabulary) != ""
    slamdb.vocabulary_recompute(atlas, vocabulary=vocabulary)
    assert slamdb.vocabulary_verify(atlas, vocabulary=vocabulary) == ""
    slamdb.vocabulary_set(atlas, name="other.txt", checksum="0" * 32)
    assert atlas.vocabulary_name == "other.txt"
    assert slamdb.vocabulary_verify(atlas, vocabulary=vocabulary) != ""
    with pytest.raises(slamdb.UsageError, match="32 hexadecimal digits"):
        slamdb.vocabulary_set(atlas, checksum="none")
    with pytest.raises(slamdb.UsageError, match="vocabulary="):
        slamdb.vocabulary_set(atlas)


def test_inputs_of_a_merge_stay_as_they_are(atlas):
    before = slamdb.encode(atlas)
    slamdb.merge(atlas, atlas)
    assert slamdb.encode(atlas) == before


@pytest.mark.parametrize("function, arguments", [(f, a) for f, a, _ in CHANGES if f in ("cull", "optimize", "shrink")])
def test_what_stops_the_work_changes_nothing(function, arguments, atlas):
    class Enough(Exception):
        pass

    def stop(stage, fraction):
        raise Enough(stage)

    before = slamdb.encode(atlas)
    with pytest.raises(Enough):
        getattr(slamdb, function)(atlas, **arguments, progress=stop)
    assert slamdb.encode(atlas) == before


def test_a_part_of_nothing_is_refused(atlas):
    before = slamdb.encode(atlas)
    with pytest.raises(slamdb.Error):
        slamdb.extract(atlas, time=(0, 1))
    with pytest.raises(TypeError, match="every= cannot be 'often'"):
        slamdb.extract(atlas, every="often")
    assert slamdb.encode(atlas) == before


def test_reports_say_what_they_have(atlas):
    report = slamdb.check(atlas)
    with pytest.raises(AttributeError, match="inputs"):
        report.nothing
    assert report.to_dict()["inputs"][0]["sound"] is True
    assert slamdb.Report.parse('{"a": [{"b": 1}]}').a[0].b == 1
