# SPDX-License-Identifier: BSD-3-Clause
"""What verbs write beside their reports never replaces an atlas, an input, or another output of the same call."""

import shutil

import pytest
import slamdb


@pytest.fixture
def files(session, tmp_path):
    """Copies that a verb might destroy: two atlases, a trajectory, a table."""
    first, second = tmp_path / "first.osa", tmp_path / "second.osa"
    shutil.copy(session, first)
    shutil.copy(session.parents[1] / "session_small_b" / "session_small_b.osa", second)
    shutil.copy(session.parent / "truth.txt", tmp_path / "truth.txt")
    atlas = slamdb.read(first)
    slamdb.write(atlas, tmp_path / "points.csv", format="csv")
    return tmp_path


# What is written where, by which call.
OVER_AN_ATLAS = {
    "evaluate": lambda f, a: slamdb.evaluate(a, f / "truth.txt", output=f / "second.osa", overwrite=True),
    "evaluate aligned": lambda f, a: slamdb.evaluate(a, f / "truth.txt", aligned=f / "second.osa", overwrite=True),
    "merge": lambda f, a: slamdb.merge(a, f / "first.osa", id_map=f / "second.osa", overwrite=True),
    "repair": lambda f, a: slamdb.repair(a, journal=f / "second.osa", overwrite=True),
    "edit_tables": lambda f, a: slamdb.edit_tables(
        a, points=f / "points.csv", journal=f / "second.osa", overwrite=True
    ),
    "renumber": lambda f, a: slamdb.renumber(a, id_map=f / "second.osa", overwrite=True),
    "align": lambda f, a: slamdb.align(a, f / "first.osa", save=f / "second.osa", overwrite=True),
    "plot": lambda f, a: slamdb.plot(a, f / "second.osa", picture="svg", overwrite=True),
    "synthesize": lambda f, a: slamdb.synthesize(truth=f / "second.osa", overwrite=True),
    "layouts_infer": lambda f, a: slamdb.layouts_infer(f / "first.osa", output=f / "second.osa", overwrite=True),
    "write": lambda f, a: slamdb.write(a, f / "second.osa", format="ply", overwrite=True),
    "convert": lambda f, a: slamdb.convert(a, f / "second.osa", to="ply", overwrite=True),
    "write_file": lambda f, a: slamdb.write_file(f / "second.osa", b"x", overwrite=True),
}  # fmt: skip

OVER_AN_INPUT = {
    "evaluate": lambda f, a: slamdb.evaluate(a, f / "truth.txt", output=f / "truth.txt", overwrite=True),
    "edit_tables": lambda f, a: slamdb.edit_tables(
        a, points=f / "points.csv", journal=f / "points.csv", overwrite=True
    ),
    "layouts_infer": lambda f, a: slamdb.layouts_infer(f / "first.osa", output=f / "first.osa", overwrite=True),
    "merge": lambda f, a: slamdb.merge(f / "first.osa", f / "second.osa", id_map=f / "first.osa", overwrite=True),
    "convert": lambda f, a: slamdb.convert(f / "first.osa", f / "first.osa", overwrite=True),
    "report": lambda f, a: slamdb.report(f / "first.osa", f / "first.osa", overwrite=True),
}  # fmt: skip

TWICE = {
    "evaluate": lambda f, a: slamdb.evaluate(a, f / "truth.txt", output=f / "one.txt", aligned=f / "one.txt"),
    "align": lambda f, a: slamdb.align(a, f / "first.osa", save=f / "one.svg", plot=f / "one.svg"),
}


@pytest.mark.parametrize(
    "write", [*OVER_AN_ATLAS.values(), *OVER_AN_INPUT.values()],
    ids=[*OVER_AN_ATLAS, *(f"{name} input" for name in OVER_AN_INPUT)],
)  # fmt: skip
def test_atlases_and_inputs_stay(files, write):
    before = {path.name: path.read_bytes() for path in files.iterdir()}
    atlas = slamdb.read(files / "first.osa")
    with pytest.raises(slamdb.Error, match="atlas|input"):
        write(files, atlas)
    assert {path.name: path.read_bytes() for path in files.iterdir()} == before
    assert slamdb.encode(atlas) == before["first.osa"]


@pytest.mark.parametrize("write", TWICE.values(), ids=TWICE)
def test_no_file_is_written_twice(files, write):
    with pytest.raises(slamdb.UsageError, match="twice"):
        write(files, slamdb.read(files / "first.osa"))


@pytest.mark.parametrize("name", ["map.pdf", "map.PNG", "map"])
def test_pictures_are_of_the_kind_that_their_name_says(session, tmp_path, name):
    with pytest.raises(slamdb.UsageError, match="svg"):
        slamdb.plot(session, tmp_path / name)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["x.osa\0.ply", "\0"])
def test_names_end_nowhere_but_at_their_end(session, tmp_path, name):
    atlas = slamdb.read(session)
    for call in (lambda path: slamdb.write(atlas, path), lambda path: slamdb.write_file(path, b"x"), slamdb.read):
        with pytest.raises(ValueError, match="null"):
            call(str(tmp_path / name))
    assert not list(tmp_path.iterdir())


def test_names_may_be_any_bytes(session, tmp_path):
    """Those of files are no text in Linux."""
    path = str(tmp_path / "k\udcff.osa")
    shutil.copy(session, path)
    assert slamdb.check(path).sound and slamdb.diff(path, session).verdict == "same"
    assert slamdb.merge(path, session)[1].result.keyframes == 28
    assert list(slamdb.split(path)[0]) == ["map-0"]


def test_texts_in_files_may_be_any_bytes():
    odd = b"VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\nODD\xff 1 2 3\n"
    with pytest.warns(slamdb.SlamdbWarning, match="ODD"):
        assert len(slamdb.read(odd, format="g2o").maps[0].keyframes) == 2
