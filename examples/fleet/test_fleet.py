# SPDX-License-Identifier: BSD-3-Clause
"""What a fleet does without a cluster: rows, outputs, the journal, parts."""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest
import slamdb
from conftest import HERE
from slamdb_fleet.plan import outputs_of

SOUND = 61  # atlases of the folder, see conftest.py
ALL = SOUND + 3
SERIAL = ("-r", "--workers", "0")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def command(folder, *arguments):
    done = subprocess.run([os.environ["SLAMDB"], *arguments, "--json"], cwd=folder, stdout=subprocess.PIPE, check=False)
    return json.loads(done.stdout)


def outputs(folder):
    return {path.relative_to(folder): path.read_bytes() for path in (folder / "atlases").rglob("*") if path.is_file()}


def test_rows_are_what_check_and_list_say(fleet):
    report = fleet.run("maps", "-o", "out", *SERIAL)
    assert (report["atlases"], report["sound"], report["unsound"], report["failures"]) == (ALL, SOUND, 1, 2)
    rows = rows_of(fleet.folder / "out" / "summary.csv")
    checked = command(fleet.folder, "check", "maps", "-r")["inputs"]
    listed = command(fleet.folder, "list", "maps", "-r")["atlases"]
    assert [row["input"] for row in rows] == [each["input"] for each in checked] == [each["input"] for each in listed]
    for row, check, listing in zip(rows, checked, listed):
        if "failure" in check:
            assert row["failure"].replace("slamdb.recover", "`slamdb recover`") == check["failure"] and not row["sound"]
            continue
        assert row["sound"] == str(check["sound"]).lower()
        assert {name: int(row[name]) for name in check["severities"]} == check["severities"]
        broken = [result["rule"] for result in check["results"] if result["severity"] == "error"]
        assert row["rules"].split() == broken
        for name in ("components", "observers_per_point", "reprojection_error_px"):
            assert float(row[name]) == check["measures"][name]
        for name in ("bytes", "keyframes", "points", "observations", "trajectory_length", "end_time", "duration_s"):
            assert float(row[name]) == listing[name], name
        assert row["sensors"].split() == listing["sensors"]


def test_atlases_of_one_name_in_several_folders_do_not_collide(fleet):
    fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    written = outputs(fleet.folder / "out")
    rows = [row for row in rows_of(fleet.folder / "out" / "summary.csv") if not row["failure"]]
    assert len(written) == len(rows) == ALL - 2
    for row in rows:
        assert written[pathlib.Path(row["output"])] == (fleet.folder / row["input"]).read_bytes()


def test_names_of_outputs_do_not_depend_on_what_else_is_there():
    files = ["a/map.osa", "a/map.osa.txt", "b/map.osa", "../b/map.osa", "a/.osa", "A/MAP.osa"]
    names = [*files, "lab.db#x/y", "lab.db#.."]
    made = outputs_of(names, "atlases", ".ply")
    assert len({output.casefold() for output in made.values()}) == len(names)
    assert made["a/map.osa"] == "atlases/a/map.ply" and made["a/map.osa.txt"] == "atlases/a/map-2.ply"
    assert made["lab.db#x/y"] == "atlases/lab.db/x%2Fy.ply"
    assert not any(part.startswith(".") for output in made.values() for part in output.split("/"))
    assert outputs_of(["new/map.osa", *names], "atlases", ".ply").items() >= made.items()


def test_of_what_is_done_nothing_is_done_again(fleet):
    fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    table = (fleet.folder / "out" / "summary.csv").read_bytes()
    journals = fleet.done("out")
    report = fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    assert report["resumed"] == ALL and fleet.done("out") == journals
    assert (fleet.folder / "out" / "summary.csv").read_bytes() == table


def test_what_has_changed_is_done_again(fleet, maps, atlases):
    fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    changed, removed, touched = (maps / "day1" / f"map{number}.osa" for number in (1, 2, 3))
    written = fleet.folder / "out" / "atlases" / "maps" / "day1"
    shutil.copy(atlases[-1], changed)
    (written / removed.name).unlink()
    before = (written / touched.name).stat().st_ino
    os.utime(touched, ns=(1, 1))
    report = fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    assert report["resumed"] == ALL - 3
    assert (written / changed.name).read_bytes() == atlases[-1].read_bytes()
    assert (written / removed.name).read_bytes() == removed.read_bytes()
    assert (written / touched.name).stat().st_ino == before  # its bytes are the same: it was not written again
    assert fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")["resumed"] == ALL
    assert fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa", "--strict")["resumed"] == 0  # another job


def test_bytes_that_change_behind_the_back_of_the_clock_are_found_by_hash(fleet, maps, atlases):
    fleet.run("maps", "-o", "out", *SERIAL)
    changed = maps / "day1" / "map1.osa"
    before = changed.stat()
    data = bytearray(changed.read_bytes())
    data[-1] ^= 1
    changed.write_bytes(data)
    os.utime(changed, ns=(before.st_atime_ns, before.st_mtime_ns))
    rows = {row["input"]: row for row in rows_of(fleet.folder / "out" / "summary.csv")}
    assert fleet.run("maps", "-o", "out", *SERIAL)["resumed"] == ALL
    fleet.run("maps", "-o", "out", *SERIAL, "--again", "hash")
    again = {row["input"]: row for row in rows_of(fleet.folder / "out" / "summary.csv")}
    assert [name for name in rows if rows[name] != again[name]] == ["maps/day1/map1.osa"]


def test_parts_of_an_array_make_the_whole(fleet):
    """As a Slurm array has them: processes that know nothing of each other, and a merge."""
    whole = fleet.run("maps", "-o", "whole", *SERIAL, "--to", ".osa")
    options = ("maps", "-o", "parts", "-r", "--to", ".osa", "--chunk", "4")
    for process in [fleet.start(*options, "--part", f"{part}/3") for part in (0, 2)]:
        assert process.wait() == 0
    missing = fleet.run(*options, "--merge")
    undone = [row for row in rows_of(fleet.folder / "parts" / "summary.csv") if row["failure"] == "not done yet"]
    assert missing["undone"] == len(undone) > 10
    fleet.run(*options, "--part", "1/3", status=0)
    merged = fleet.run(*options, "--merge")
    assert merged["undone"] == 0 and merged["resumed"] == ALL
    parts, serial = (fleet.folder / name for name in ("parts", "whole"))
    assert (parts / "summary.csv").read_bytes() == (serial / "summary.csv").read_bytes()
    assert outputs(parts) == outputs(serial)
    assert whole["atlases"] == merged["atlases"]
    assert set(fleet.times("parts", "done")) == set(fleet.times("parts", "begun")) == {1}


def test_a_journal_that_ends_in_a_line_goes_on(fleet):
    fleet.run("maps", "-o", "out", *SERIAL)
    table = (fleet.folder / "out" / "summary.csv").read_bytes()
    journal = sorted((fleet.folder / "out" / "journal").iterdir())[0]
    journal.write_bytes(journal.read_bytes()[:-20])
    assert fleet.run("maps", "-o", "out", *SERIAL)["resumed"] == ALL - 1
    assert (fleet.folder / "out" / "summary.csv").read_bytes() == table
    assert fleet.run("maps", "-o", "out", *SERIAL)["resumed"] == ALL


def test_a_store_is_a_fleet(fleet, maps):
    options = ("maps.db", "-o", "out", "--workers", "0", "--to", ".osa")
    command(fleet.folder, "add", "maps.db", "maps/day3", "--no-sync")
    report = fleet.run(*options, status=0)
    assert report["sound"] == report["atlases"] == 16
    assert fleet.run(*options, status=0)["resumed"] == 16
    slamdb.write(slamdb.read(maps / "day0" / "map2.osa"), fleet.folder / "maps.db#map3", overwrite=True)
    assert fleet.run(*options, status=0)["resumed"] == 15
    written = fleet.folder / "out" / "atlases" / "maps.db" / "map3.osa"
    assert written.read_bytes() == (maps / "day0" / "map2.osa").read_bytes()


def test_outputs_are_never_inputs(fleet, maps):
    fleet.run("maps", "-o", "maps/day0", *SERIAL)
    assert "holds other files" in fleet.said
    fleet.run("maps", "-o", "maps/out", *SERIAL, "--to", ".osa")
    fleet.run("maps", "-o", "maps/out", *SERIAL, "--to", ".osa")
    assert "lies in maps/out, which is for outputs" in fleet.said
    shutil.rmtree(maps / "out")
    fleet.run("maps", "-o", "out", *SERIAL)
    (fleet.folder / "out" / "atlases").symlink_to(maps.parent)  # outputs would be written over the inputs
    before = {path: path.stat().st_mtime_ns for path in maps.rglob("*.osa")}
    fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    assert "leads out of the folder of outputs" in fleet.said
    assert {path: path.stat().st_mtime_ns for path in maps.rglob("*.osa")} == before


def test_outputs_that_cannot_be_written_end_the_run_and_blame_no_atlas(fleet):
    fleet.run("maps", "-o", "out", *SERIAL)
    (fleet.folder / "out" / "atlases").write_text("in the way")
    fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    assert not any(row["failure"].startswith("out/") for row in rows_of(fleet.folder / "out" / "summary.csv"))
    (fleet.folder / "out" / "atlases").unlink()
    fleet.run("maps", "-o", "out", *SERIAL, "--to", ".osa")
    assert len(outputs(fleet.folder / "out")) == ALL - 2


def test_losses_are_named_and_refused_where_that_is_asked_for(fleet, maps):
    shutil.rmtree(maps / "day2")
    fleet.run("maps", "-o", "out", *SERIAL, "--to", ".msg")
    lossy = [row for row in rows_of(fleet.folder / "out" / "summary.csv") if not row["failure"]]
    assert lossy and all(row["losses"] for row in lossy)
    fleet.run("maps", "-o", "strict", *SERIAL, "--to", ".msg", "--strict")
    assert all(row["failure"] for row in rows_of(fleet.folder / "strict" / "summary.csv"))
    assert outputs(fleet.folder / "strict") == {}


def test_the_page_tells_of_the_fleet_and_names_are_no_markup(fleet):
    fleet.run("maps", "-o", "out", *SERIAL)
    page = (fleet.folder / "out" / "index.html").read_text()
    assert "<script" not in page and "default-src 'none'" in page
    assert "map-listed-once" in page and "maps/day0/cut.osa" in page
    assert "Outliers" in page and page.count("mono_small_twice.osa") > 2
    assert "The same bytes" in page and page.count("<svg") >= 5


def test_pages_of_each_are_linked(fleet):
    options = ("maps/day2", "-o", "out", "--workers", "0", "--pages")
    fleet.run(*options)
    folder = fleet.folder / "out"
    pages = [row["page"] for row in rows_of(folder / "summary.csv")]
    assert len(pages) == 16 and all("<svg" in (folder / page).read_text() for page in pages)
    index = (folder / "index.html").read_text()
    assert 'href="pages/maps/day2/mono_small_twice.html"' in index and "data:image/png" in index
    (folder / pages[3]).unlink()
    assert fleet.run(*options)["resumed"] == 15 and (folder / pages[3]).exists()


def test_gates_and_rules_are_those_of_check(fleet):
    ignored = ("--ignore", "map-listed-once")
    report = fleet.run("maps", "-o", "out", *SERIAL, "--gate", "min-keyframes=6", *ignored)
    checked = command(fleet.folder, "check", "maps", "-r", "--min-keyframes", "6", *ignored)["inputs"]
    assert report["unsound"] == sum(each.get("sound") is False for each in checked) > 10


def test_a_terminal_is_told_how_far_it_is(fleet):
    terminal, of_script = os.openpty()
    command = [sys.executable, HERE / "fleet.py", "maps/day1", "-o", "out", "--workers", "0", "--chunk", "1"]
    subprocess.run(command, cwd=fleet.folder, stdout=subprocess.DEVNULL, stderr=of_script, check=False)
    os.close(of_script)
    told = os.read(terminal, 1 << 20).decode()
    os.close(terminal)
    assert "16 of 16 atlases, 1 failed" in told and told.endswith("\r\033[K")


@pytest.mark.parametrize("wrong", [
    "--part 3/3", "--part x", "--to osa", "--to .db", "--to .nope", "--to .osa --format nope", "--format tum",
    "--chunk 0", "--gate nope=1", "--gate min-keyframes", "--ignore nope",
])  # fmt: skip
def test_wrong_arguments(fleet, wrong):
    fleet.run("maps", "-o", "out", *wrong.split(), status=2)
    assert wrong.split()[0] in fleet.said or "nope" in fleet.said
    assert not (fleet.folder / "out").exists()


def test_a_typing_error_spoils_no_summary(fleet):
    fleet.run("maps", "-o", "out", *SERIAL)
    before = [(fleet.folder / "out" / name).read_bytes() for name in ("summary.csv", "index.html")]
    fleet.run("maps", "-o", "out", *SERIAL, "--gate", "min-keyframe=6", status=2)
    assert "no quality gate is called 'min-keyframe'" in fleet.said
    assert before == [(fleet.folder / "out" / name).read_bytes() for name in ("summary.csv", "index.html")]


def test_one_atlas_is_told_as_one(fleet):
    process = fleet.start("maps/day0/map0.osa", "-o", "out", "--workers", "0")
    assert process.communicate()[0].startswith("1 atlas: 1 sound,")


def test_a_folder_without_atlases_is_a_row(fleet):
    (fleet.folder / "empty").mkdir()
    fleet.run("empty", "-o", "out", *SERIAL)
    [row] = rows_of(fleet.folder / "out" / "summary.csv")
    assert row["input"] == "empty" and row["failure"]


def test_parquet_where_pyarrow_is_there(fleet):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not there")
    fleet.run("maps", "-o", "out", *SERIAL, "--parquet")
    table = parquet.read_table(fleet.folder / "out" / "summary.parquet").to_pylist()
    assert [row["input"] for row in table] == [row["input"] for row in rows_of(fleet.folder / "out" / "summary.csv")]
