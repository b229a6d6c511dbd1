# SPDX-License-Identifier: BSD-3-Clause
import concurrent.futures
import multiprocessing
import os
import pathlib
import pickle
import shutil
import sqlite3
import subprocess
import threading

import numpy as np
import pytest
import re
import slamdb


@pytest.fixture
def path(tmp_path):
    return tmp_path / "maps.db"


@pytest.fixture
def store(path, atlas, fixtures):
    """Two atlases, saved by this process."""
    with slamdb.Store(path) as store:
        store.save("lab", atlas, provenance="a test")
        store.save("hall", slamdb.read(fixtures / "mono_small_twice" / "mono_small_twice.osa"))
        yield store


def run(*arguments, wait=True):
    started = subprocess.Popen(
        [os.environ["SLAMDB"], *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    if wait:
        _, error = started.communicate()
        assert started.returncode == 0, error
    return started


REPORTS = {
    "list": (lambda s: s.list(), ("list", "{path}")),
    "list checked": (lambda s: s.list(check=True), ("list", "{path}", "--check")),
    "list near": (lambda s: s.list(near=((0, 0, 2), 0.5)), ("list", "{path}", "--near", "0,0,2,0.5")),
    "list keyframes": (lambda s: s.list(keyframes=(14, 99)), ("list", "{path}", "--keyframes", "14:99")),
    "list time": (lambda s: s.list(time=(1403636595.0, 1403636599.0)),
                  ("list", "{path}", "--time", "1403636595:1403636599")),
    "log": (lambda s: s.log(), ("log", "{path}")),
    "history": (lambda s: s.history("lab"), ("log", "{path}#lab")),
    "stats": (lambda s: s.stats(), ("stats", "{path}")),
    "check": (lambda s: s.check(), ("check", "{path}")),
    "check strictly": (lambda s: s.check(ignore=["point-bad"], strict=True, gates={"min-keyframes": 20}),
                       ("check", "{path}", "--ignore", "point-bad", "--strict", "--min-keyframes", "20")),
}  # fmt: skip


@pytest.mark.parametrize("what", REPORTS)
def test_reports_are_the_commands(what, store, path, command):
    call, arguments = REPORTS[what]
    mine, theirs = call(store).to_dict(), command(*(each.format(path=path) for each in arguments))
    assert mine == theirs
    assert any(mine.get(of) for of in ("atlases", "entries", "tables", "inputs"))


def test_what_is_saved_is_loaded_byte_for_byte(store, session, path, tmp_path):
    assert store.names == ["hall", "lab"] and "lab" in store and "kitchen" not in store
    assert slamdb.encode(store.load("lab")) == session.read_bytes()
    run("convert", f"{path}#lab", tmp_path / "back.osa")
    assert (tmp_path / "back.osa").read_bytes() == session.read_bytes()
    assert slamdb.encode(slamdb.read(f"{path}#lab")) == session.read_bytes()


PARTS = {
    "map": {"map": 0},
    "keyframes": {"keyframes": (3, 7)},
    "time": {"time": (1403636580.0, 1403636585.0)},
    "box": {"box": ((-1, -1, 0), (1, 1, 3))},
}


@pytest.mark.parametrize("part", PARTS)
def test_parts_are_those_that_read_gives(part, store, path):
    loaded, read = store.load("lab", **PARTS[part]), slamdb.read(f"{path}#lab", **PARTS[part])
    assert slamdb.diff(loaded, read).verdict == "same"
    assert part == "map" or slamdb.diff(loaded, store.load("lab")).verdict == "different"


def test_keypoints_may_be_left_out(store):
    keyframes = store.load("lab", features=False).maps[0].keyframes
    assert len(keyframes) == 14 and len(keyframes[0].features.keypoints) == 0


def test_saving_again(store, atlas):
    with pytest.raises(slamdb.AlreadyExistsError):
        store.save("lab", atlas)
    assert store.save("lab", atlas, keep_equal=True).unchanged
    atlas.maps[0].points.positions[0] += 1
    report = store.save("lab", atlas, overwrite=True, provenance="moved a point")
    assert report.replaced and not report.unchanged and report.rows.updated < 10 < report.rows["unchanged"]
    history = store.history("lab").entries
    assert [entry.provenance for entry in history] == ["a test", "moved a point"]
    assert history[1].rows.to_dict() == report.rows.to_dict()
    with pytest.raises(slamdb.UsageError):
        store.save("a#b", atlas)


def test_removing_and_giving_back_space(store, path):
    store.remove("hall")
    assert store.names == ["lab"] and [entry.action for entry in store.history("hall").entries] == ["save", "remove"]
    before = path.stat().st_size
    store.vacuum()
    assert path.stat().st_size < before
    with pytest.raises(slamdb.NotFoundError, match="lab"):
        store.remove("hall")
    with pytest.raises(slamdb.NotFoundError, match="lab"):
        store.load("hall")


def test_backups(store, tmp_path):
    store.backup(tmp_path / "copy.db")
    with pytest.raises(slamdb.AlreadyExistsError):
        store.backup(tmp_path / "copy.db")
    store.remove("hall")
    store.backup(tmp_path / "copy.db", overwrite=True)
    assert slamdb.Store(tmp_path / "copy.db").names == ["lab"]


def test_adding_is_the_commands(fixtures, tmp_path, command):
    folders = [fixtures / "session_small_a", fixtures / "session_small_b", tmp_path / "nothing.osa"]
    mine, theirs = slamdb.Store(tmp_path / "mine.db"), tmp_path / "theirs.db"
    runs = [({"dry_run": True}, ["--dry-run"]), ({}, []), ({"name_from": "path"}, ["--name-from", "path"])]
    for options, flags in runs:
        report = mine.add(*folders, **options).to_dict()
        expected = command("add", theirs, *folders, *flags)
        for each in (report, expected):
            each.pop("output")
        assert report == expected
    assert mine.names == slamdb.Store(theirs).names == ["session_small_a", "session_small_b"]
    assert mine.add(folders[0], overwrite=True).unchanged == 1
    assert mine.add(folders[0] / "session_small_a.osa", name="again").added == 1


def test_migrating_an_older_store(fixtures, tmp_path):
    old = sorted((fixtures / "store").glob("version*.db"))[0]
    shutil.copy(old, tmp_path / "old.db")
    with slamdb.Store(tmp_path / "old.db") as store:
        with pytest.raises(slamdb.UnsupportedError):
            store.list()
        planned = store.migrate(dry_run=True)
        report = store.migrate()
        assert report.from_version == planned.from_version == 2 and report.steps == planned.steps != []
        assert pathlib.Path(report.backup).exists() and planned.backup is None
        assert store.list().atlases and store.migrate().steps == []


def test_what_opens_and_what_does_not(tmp_path, atlas, session):
    for read_only in (True, False):
        with pytest.raises(slamdb.Error):
            slamdb.Store(session, read_only=read_only)
    with pytest.raises(slamdb.NotFoundError):
        slamdb.Store(tmp_path / "nothing.db", read_only=True)
    sqlite3.connect(tmp_path / "theirs.db").execute("CREATE TABLE images (a)").connection.close()
    with pytest.raises(slamdb.UnsupportedError):
        slamdb.Store(tmp_path / "theirs.db")
    with pytest.raises(slamdb.UsageError, match="without an atlas"):
        slamdb.Store(f"{tmp_path}/maps.db#lab")
    fresh = slamdb.Store(tmp_path / "fresh.db")
    assert fresh.names == [] and list(tmp_path.glob("fresh*")) == []
    for attempt in (fresh.list, fresh.vacuum, lambda: fresh.load("lab"), lambda: fresh.remove("lab")):
        with pytest.raises(slamdb.NotFoundError):
            attempt()
    with pytest.raises(slamdb.UsageError):
        fresh.save("no/name", atlas)
    assert list(tmp_path.glob("fresh*")) == []
    fresh.save("lab", atlas)
    assert fresh.names == ["lab"]
    (tmp_path / "empty.db").touch()
    slamdb.Store(tmp_path / "empty.db").save("lab", atlas)


def test_read_only_stores(store, path, atlas):
    with slamdb.Store(path, read_only=True) as reader:
        assert reader.names == ["hall", "lab"] and reader.load("lab").maps
        before = path.read_bytes()
        for change in (lambda: reader.save("x", atlas), lambda: reader.remove("lab"), reader.vacuum, reader.migrate,
                       lambda: reader.add("x.osa")):  # fmt: skip
            with pytest.raises(slamdb.UsageError, match="read_only"):
                change()
        assert path.read_bytes() == before


def test_nothing_is_done_after_close(path, atlas):
    with slamdb.Store(path) as store:
        store.save("lab", atlas)
    assert store.closed
    uses = [
        lambda: store.names, lambda: store.load("lab"), lambda: store.save("a", atlas), store.list, store.log,
        lambda: store.history("lab"), store.stats, store.check, store.vacuum, store.migrate,
        lambda: store.remove("lab"), lambda: store.table("points"), lambda: store.add("x.osa"),
        lambda: store.backup("x.db"), lambda: "lab" in store,
    ]  # fmt: skip
    for use in uses:
        with pytest.raises(slamdb.UsageError, match="closed"):
            use()


def test_another_program_that_writes_is_waited_for(store, path, atlas):
    other = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
    other.execute("BEGIN IMMEDIATE")
    impatient = slamdb.Store(path, wait=0.05)
    with pytest.raises(slamdb.LockedError):
        impatient.save("more", atlas)
    with pytest.raises(slamdb.LockedError):
        impatient.remove("lab")
    assert impatient.load("lab").maps  # readers wait for nobody
    release = threading.Timer(0.2, lambda: other.execute("ROLLBACK"))
    release.start()
    slamdb.Store(path, wait=60).save("more", atlas)
    release.join()
    other.close()
    assert "more" in store


def test_waiting_can_be_interrupted(store, path, atlas):
    other = sqlite3.connect(path, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")

    class Enough(Exception):
        pass

    def stop(stage, fraction):
        raise Enough

    with pytest.raises(Enough):
        slamdb.Store(path, wait=float("inf")).save("more", atlas, progress=stop)
    other.close()
    assert "more" not in store


def test_what_other_programs_save_is_seen(store, path, session):
    run("convert", session, f"{path}#theirs")
    assert "theirs" in store and store.load("theirs").maps
    run("remove", f"{path}#lab")
    assert "lab" not in store
    with slamdb.Store(path) as twice:  # and by the same one
        twice.remove("theirs")
    assert store.names == ["hall"]


def test_threads_share_a_store(store, atlas, session):
    expected = session.read_bytes()

    def work(number):
        store.save(f"copy{number}", atlas, threads=1)
        return slamdb.encode(store.load(f"copy{number}", threads=1))

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        assert all(each == expected for each in pool.map(work, range(8)))
    assert len(store.names) == 10


def test_stores_go_to_other_processes(store):
    again = pickle.loads(pickle.dumps(store))
    assert again.names == store.names and again.path == store.path


def test_rows_that_were_edited_are_found(store, path, command):
    database = sqlite3.connect(path)
    database.execute("UPDATE map_point SET x = 7 WHERE row = (SELECT min(row) FROM map_point)")
    database.commit()
    database.close()
    with pytest.raises(slamdb.DamagedError, match="differs from its hash") as damaged:
        store.load("lab")
    assert "map_point" in damaged.value.place
    report = store.check()
    assert not report.sound
    failed = {each["input"] for each in report["inputs"] if "failure" in each}
    assert failed == {f"{path}#lab"} == {e["input"] for e in command("check", path)["inputs"] if "failure" in e}


def test_an_empty_store_has_nothing_to_check(store):
    for name in store.names:
        store.remove(name)
    with pytest.raises(slamdb.NotFoundError):
        store.check()
    assert store.list().atlases == []


def table_of_command(path, suffix, tmp_path):
    run("convert", path, tmp_path / f"table{suffix}")
    return np.genfromtxt(tmp_path / f"table{suffix}", delimiter=",", names=True)


TABLES = {"keyframes": ".keyframes.csv", "points": ".csv", "observations": ".observations.csv"}


@pytest.mark.parametrize("kind", TABLES)
@pytest.mark.parametrize("with_pandas", [True, False])
def test_tables_are_the_commands(kind, with_pandas, store, session, tmp_path, monkeypatch):
    if with_pandas:
        pytest.importorskip("pandas")
    else:
        monkeypatch.setattr("slamdb.tables.has_pandas", lambda: False)
    table = store.table(kind, "lab")
    assert isinstance(table, dict) != with_pandas
    theirs = table_of_command(session, TABLES[kind], tmp_path)
    assert len(table["map"]) == len(theirs) > 0
    for name in set(theirs.dtype.names) & set(table):
        mine = np.asarray(table[name].fillna(0) if with_pandas and table[name].dtype == "UInt64" else table[name])
        mine = np.where(mine == slamdb.NONE, 0, mine.astype(float))
        expected = np.nan_to_num(theirs[name])
        if kind == "observations" and name in ("left", "right"):
            mine = np.where(mine < 0, 0, mine)
        assert np.allclose(mine, expected, rtol=1e-6, atol=1e-6), name
    whole = store.table(kind)
    assert sorted(set(whole["atlas"])) == ["hall", "lab"] and len(whole["atlas"]) > len(table["atlas"])
    with pytest.raises(slamdb.UsageError, match="keyframes, points, observations"):
        store.table("nonsense")


def test_tables_of_nothing_have_their_columns(store):
    for name in store.names:
        store.remove(name)
    for kind in TABLES:
        table = store.table(kind)
        assert {"atlas", "map"} < set(table) and len(table["map"]) == 0
        [said] = re.findall(rf"(?m)^ *{kind}: (.*)$", slamdb.Store.table.__doc__)
        assert re.sub(r" *\([^)]*\)", "", said).split(", ") == list(table)[2:]


def save_some(store, prefix, session):
    atlas = slamdb.read(session, threads=1)
    for number in range(4):
        store.save(f"{prefix}{number}", atlas, threads=1)


def test_processes_write_to_one_store(path, session):
    """Each waits for its turn: nothing is lost, and the file is whole."""
    store = slamdb.Store(path, wait=60)
    several = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(3, mp_context=several) as pool:
        list(pool.map(save_some, [store] * 3, "abc", [session] * 3))
    assert store.names == [f"{prefix}{number}" for prefix in "abc" for number in range(4)]
    assert {slamdb.encode(store.load(name)) == session.read_bytes() for name in store.names} == {True}
    assert len(store.log().entries) == 12


REAL = sorted(pathlib.Path(os.environ.get("SLAMDB_ATLASES", "/nowhere")).glob("*.osa"))


@pytest.mark.parametrize("real", REAL or [None], ids=lambda path: path.stem if path else "none")
def test_real_atlases_come_back_whole(real, path):
    if real is None:
        pytest.skip("SLAMDB_ATLASES names no folder of real atlases")
    store = slamdb.Store(path, sync=False)
    assert store.add(real).added == 1
    [name] = store.names
    read, loaded = slamdb.read(real), store.load(name)
    assert slamdb.encode(read) == slamdb.encode(loaded)
    rows = store.table("points", name)
    assert len(rows["id"]) == sum(len(map.points) for map in read.maps)
    for atlas in (read, *read.maps):
        assert len(atlas._repr_html_()) < 200_000


def test_revisions(store, atlas):
    first = atlas.maps[0].points.positions[0].copy()
    store.tag("lab", "first")
    atlas.maps[0].points.positions[0] += 1
    assert store.save("lab", atlas, overwrite=True).revision == 2
    for earlier in ("lab@1", "lab@-1", "lab@first"):
        assert (store.load(earlier).maps[0].points.positions[0] == first).all()
    entry = store.history("lab").entries[-1]
    assert (entry.revision, entry.readable, entry.changes.points.moved, "@" in entry.who) == (2, True, 1, True)
    with pytest.raises(slamdb.NotFoundError, match="it has 1, 2, tagged first"):
        store.load("lab@7")
    assert store.restore("lab@first") == 3
    assert (store.load("lab").maps[0].points.positions[0] == first).all()
    store.branch("lab@2", "robot7")
    assert store.history("robot7").entries[0]["from"]["revision"] == 2
    with pytest.raises(slamdb.AlreadyExistsError):
        store.branch("lab", "robot7")
    assert [entry.given_up for entry in store.gc(keep=1, dry_run=True).atlases if entry.name == "lab"] == [[]]
    store.tag("lab", "first", remove=True)
    for _ in range(2):
        atlas.maps[0].points.positions[0] += 1
        store.save("lab", atlas, overwrite=True)
    assert [list(entry.given_up) for entry in store.gc("lab", keep_tags=True).atlases] == [[4]]  # lab@3 tells that what follows was not made of lab@2
    for wrong in ({}, {"keep": 0}, {"keep_days": -1}):
        with pytest.raises(slamdb.UsageError):
            store.gc(**wrong)


def test_sync(tmp_path, fixtures):
    first, second = tmp_path / "first.db", tmp_path / "second.db"
    atlas = slamdb.read(fixtures / "session_small_a" / "session_small_a.osa")
    slamdb.Store(first).save("lab", atlas)
    slamdb.Store(second).save("yard", atlas)
    dry = slamdb.sync(first, second, dry_run=True)
    assert [each["input"] for each in dry["inputs"]] == [str(first), str(second)] and dry["copied"] == 2
    assert slamdb.Store(first).names == ["lab"]
    assert [each["name"] for each in slamdb.sync(first, second, name="lab")["atlases"]] == ["lab"]
    report = slamdb.sync(first, second, retry=1, wait=1, sync=False)
    assert (report.copied, report.same) == (1, 1) and report.atlases[0].to == "first"
    assert slamdb.Store(first).names == slamdb.Store(second).names == ["lab", "yard"]
    with pytest.raises(slamdb.UsageError, match="to be compared with"):
        slamdb.sync(first, first)
    with pytest.raises(slamdb.UsageError, match="skip"):
        slamdb.sync(first, second, diverged="both")
