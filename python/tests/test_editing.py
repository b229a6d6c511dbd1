# SPDX-License-Identifier: BSD-3-Clause
"""Edits are put in place whole or not at all, and taken back bit by bit."""

import json

import numpy as np
import pytest
import slamdb
from real_atlases import built_anew


def move(map):
    map.points.positions[:] += np.float32(1)


def turn(map):
    map.keyframes.camera_from_world[0, 4:] += np.float32(0.25)
    map.points.positions[7, 0] = np.nan


def remove_points(map):
    map.remove_points(map.points.weights < 5)


def remove_keyframes(map):
    map.remove_keyframes([map.keyframes.ids[3], map.keyframes.ids[8]])


def add(map):
    free = [int(np.flatnonzero(row.features.map_points == slamdb.NONE)[0]) for row in map.keyframes]
    map.add_points(positions=[[0, 0, 1]], observations=[(0, map.keyframes[k].id, free[k]) for k in (0, 1)])
    map.add_keyframes(
        timestamps=[2e9], poses=[np.eye(4)], features=[map.keyframes[0].features], camera=map.keyframes[0].camera,
        baseline=map.keyframes[0].intrinsics["baseline"],
    )  # fmt: skip


def link(map):
    ids = map.keyframes.ids
    map.add_loop_edges([(ids[0], ids[9]), (ids[2], ids[9])])
    map.add_merge_edges([(ids[1], ids[8])])
    map.update_points()
    map.update_covisibility()


def everything(map):
    for change in (move, remove_points, add, remove_keyframes, link):
        change(map)


CHANGES = (move, turn, remove_points, remove_keyframes, add, link, everything)


@pytest.mark.parametrize("change", CHANGES)
def test_an_edit_is_taken_back_bit_by_bit(atlas, change):
    before = slamdb.encode(atlas)
    with atlas.edit() as edit:
        change(edit.maps[0])
        during = slamdb.encode(edit.atlas)
        assert slamdb.encode(atlas) == before, "nothing is changed before the edit is put in place"
    after = slamdb.encode(atlas)
    assert after == during != before
    assert len(edit.journal) > 0 and edit.undo() == len(edit.journal)
    assert slamdb.encode(atlas) == before


@pytest.mark.parametrize("change", CHANGES)
def test_what_fails_changes_nothing(atlas, change):
    before = slamdb.encode(atlas)
    with pytest.raises(ZeroDivisionError):
        with atlas.edit() as edit:
            change(edit.maps[0])
            1 / 0
    assert slamdb.encode(atlas) == before and atlas.history == []
    with pytest.raises(slamdb.UsageError):
        edit.maps
    with pytest.raises(slamdb.UsageError):
        edit.journal


@pytest.mark.parametrize("change", [each for each in CHANGES if each is not turn])
def test_what_verbs_leave_is_sound(atlas, change):
    with atlas.edit() as edit:
        change(edit.maps[0])
    assert slamdb.check(atlas).sound


def test_journals_are_files_that_the_command_takes_back(session, atlas, command, tmp_path):
    with atlas.edit(label="thinned") as edit:
        everything(edit.maps[0])
    slamdb.write(atlas, tmp_path / "edited.osa")
    edit.journal.save(tmp_path / "edit.json")
    with pytest.raises(slamdb.AlreadyExistsError):
        edit.journal.save(tmp_path / "edit.json")
    assert (tmp_path / "edit.json").read_text() == edit.journal.text
    journal = json.loads(edit.journal.text)
    assert {each["rule"] for each in journal["edits"]} == {"thinned"}
    assert {"removed", "added"} <= {key for each in journal["edits"] for key in each}
    report = command("repair", "--undo", tmp_path / "edit.json", tmp_path / "edited.osa", tmp_path / "again.osa")
    assert report["edits"] == len(edit.journal)
    assert (tmp_path / "again.osa").read_bytes() == session.read_bytes()

    again = slamdb.read(tmp_path / "edited.osa")
    assert again.undo(tmp_path / "edit.json") == len(edit.journal) and slamdb.encode(again) == session.read_bytes()
    assert len(slamdb.Journal.read(tmp_path / "edit.json")) == len(edit.journal)


def test_a_history_is_taken_back_from_its_end(atlas):
    states = [slamdb.encode(atlas)]
    edits = []
    for change in CHANGES:
        with atlas.edit(label=change.__name__) as edit:
            change(edit.maps[0])
        edits.append(edit)
        states.append(slamdb.encode(atlas))
    assert [journal.text for journal in atlas.history] == [edit.journal.text for edit in edits]
    with pytest.raises(slamdb.NotPossibleError, match="not the atlas that the journal was kept of"):
        edits[0].undo()
    assert slamdb.encode(atlas) == states[-1]
    for state in reversed(states[:-1]):
        atlas.undo()
        assert slamdb.encode(atlas) == state
    assert atlas.history == []
    with pytest.raises(slamdb.NotPossibleError):
        atlas.undo()


def test_a_journal_of_the_command_is_taken_back(session, tmp_path, atlas, command):
    atlas.maps[0].points.positions[3] = np.nan
    slamdb.write(atlas, tmp_path / "broken.osa")
    command("repair", tmp_path / "broken.osa", tmp_path / "mended.osa", "--journal", tmp_path / "fix.json")
    mended = slamdb.read(tmp_path / "mended.osa")
    mended.undo(slamdb.Journal.read(tmp_path / "fix.json"))
    assert slamdb.encode(mended) == (tmp_path / "broken.osa").read_bytes()


def test_an_atlas_that_changes_under_an_edit_refuses_it(atlas):
    def write(under):
        under.maps[0].points.positions[0] = 7

    def verb(under):
        under.maps[0].remove_points(under.maps[0].points.ids[:3])

    for change in (write, verb):
        edit = atlas.edit()
        move(edit.maps[0])
        change(atlas)
        before = slamdb.encode(atlas)
        with pytest.raises(slamdb.NotPossibleError, match="changed while the edit was open"):
            edit.commit()
        edit.drop()
        assert slamdb.encode(atlas) == before


def test_without_a_journal_nothing_is_taken_back(atlas):
    with atlas.edit(journal=False) as edit:
        move(edit.maps[0])
    with pytest.raises(slamdb.UsageError):
        edit.undo()
    assert atlas.history == []


def test_arrays_of_an_edit_are_those_of_the_atlas_afterwards(atlas):
    old = atlas.maps[0].points.positions
    with atlas.edit() as edit:
        positions = edit.maps[0].points.positions
    assert np.shares_memory(positions, atlas.maps[0].points.positions) and not np.shares_memory(positions, old)


def test_building_is_an_edit_that_is_taken_back(atlas):
    arrays = built_anew(atlas)
    empty = slamdb.Atlas()
    before = slamdb.encode(empty)
    with empty.edit() as edit:
        edit.atlas.add_camera("pinhole", 400, 400, 320, 240)
        edit.atlas.add_map()
    edit.undo()
    assert slamdb.encode(empty) == before and len(arrays.maps) == 1


@pytest.mark.parametrize("end", ["commit", "drop"])
def test_what_is_kept_of_an_edit_is_over_with_it(atlas, end):
    edit = atlas.edit()
    kept, kept_atlas = edit.maps[0], edit.atlas
    move(kept)
    during = slamdb.encode(kept_atlas)
    getattr(edit, end)()
    after = slamdb.encode(atlas)
    ids = kept.keyframes.ids
    for change in (
        lambda: kept.remove_points([1]), lambda: kept.remove_keyframes([ids[3]]), kept.update_points,
        kept.update_covisibility, lambda: kept.set_parents([ids[3]], [ids[0]]), lambda: add(kept),
        lambda: kept.add_loop_edges([(ids[0], ids[5])]), lambda: slamdb.cull(kept_atlas, min_observations=5),
        lambda: slamdb.repair(kept_atlas), kept_atlas.add_map, kept_atlas.edit,
    ):  # fmt: skip
        with pytest.raises(slamdb.UsageError, match="the edit is over"):
            change()
    assert slamdb.encode(kept_atlas) == during and slamdb.encode(atlas) == after
    assert slamdb.check(kept_atlas).sound and kept_atlas.copy().add_map()


def test_an_edit_that_nobody_has_is_over(atlas):
    map = atlas.edit().maps[0]
    with pytest.raises(slamdb.UsageError, match="the edit is over"):
        map.update_points()


# ---- Removing


def references(map):
    """Everything that refers to keyframes and to points."""
    keyframes, points = map.keyframes, map.points
    links = [keyframes.parents, keyframes.connections.keyframes, points.observations.keyframes]
    links += [points.reference_keyframes, map.loop_edges.reshape(-1)]
    to_keyframes = np.concatenate(links)
    to_points = np.concatenate([row.features.map_points for row in keyframes] + [points.replaced_by])
    return (np.unique(ids[ids != slamdb.NONE]) for ids in (to_keyframes, to_points))


@pytest.mark.parametrize("seed", range(6))
def test_removing_takes_all_references_along(atlas, seed):
    rng = np.random.default_rng(seed)
    map = atlas.maps[0]
    gone = map.points.ids[rng.random(len(map.points)) < 0.3].copy()
    report = map.remove_points(gone)
    assert report.before.points - report.after.points == len(gone) and report.cut.slots >= len(gone)
    lost = map.keyframes.ids[1:][rng.random(len(map.keyframes) - 1) < 0.3].copy()
    report = map.remove_keyframes(np.isin(map.keyframes.ids, lost))
    assert report.before.keyframes - report.after.keyframes == len(lost)
    to_keyframes, to_points = references(map)
    assert set(to_keyframes.tolist()) <= set(map.keyframes.ids.tolist())
    assert set(to_points.tolist()) <= set(map.points.ids.tolist()) - set(gone.tolist())
    assert slamdb.check(atlas).sound


def test_what_is_removed_must_be_there(atlas):
    map = atlas.maps[0]
    before = slamdb.encode(atlas)
    for call, message in (
        (lambda: map.remove_points([10**9]), "the map has no point 1000000000"),
        (lambda: map.remove_keyframes([99]), "the map has no keyframe 99"),
        (lambda: map.remove_points(np.zeros(7, bool)), "mask of another shape"),
        (lambda: map.remove_points(["a"]), "which: "),
        (lambda: map.remove_keyframes([0], border="open"), "border"),
        (lambda: map.remove_points(np.zeros(len(map.points), np.uint8)), "is that a mask"),
        (lambda: map.remove_keyframes([0, 1] * (len(map.keyframes) // 2)), "is that a mask"),
        (lambda: map.update_points(np.ones(len(map.points), int)), "is that a mask"),
        (lambda: map.remove_points(np.ma.masked_less(map.points.ids, 9)), "masked array"),
        (lambda: map.remove_points(np.ma.masked_array(map.points.bad, map.points.bad)), "masked array"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    assert slamdb.encode(atlas) == before


def test_removing_all_warns(atlas):
    for name, noun in (("points", "point"), ("keyframes", "keyframe")):
        map = atlas.copy().maps[0]
        with pytest.warns(slamdb.SlamdbWarning, match=f"map 0 has no {noun} left") as told:
            getattr(map, f"remove_{name}")(getattr(map, name).ids)
        assert told[0].filename == __file__


# ---- Links


def test_parents(atlas):
    map = atlas.maps[0]
    ids, root = map.keyframes.ids, map.root_keyframe
    child = next(row for row in map.keyframes if row.id != root and row.parent != root)
    map.set_parents([child.id], [root])
    assert map.keyframes.by_id(child.id).parent == root and child.id in map.keyframes.by_id(root).children
    assert child.id not in map.keyframes.by_id(child.parent).children and slamdb.check(atlas).sound
    before = slamdb.encode(atlas)
    grandchild = next(row for row in map.keyframes if row.parent not in (None, root))
    for keyframes, parents, message in (
        ([root], [ids[3]], "the root"),
        ([grandchild.parent], [grandchild.id], "hangs on itself"),
        ([ids[3]], [ids[3]], "hangs on itself"),
        ([ids[3]], [99], "names keyframe 99"),
        ([ids[3]], [], "parents: "),
    ):
        with pytest.raises(ValueError, match=message):
            map.set_parents(keyframes, parents)
    assert slamdb.encode(atlas) == before


def test_edges(atlas):
    map = atlas.maps[0]
    a, b, c = (int(each) for each in map.keyframes.ids[[0, 5, 9]])
    assert map.add_loop_edges([(c, a), (a, c), (a, b)]) == 2 and map.add_loop_edges([(a, b)]) == 0
    assert map.loop_edges.tolist() == sorted([sorted((a, b)), sorted((a, c))]) and len(map.merge_edges) == 0
    assert map.keyframes.not_erase[map.keyframes.rows_of([a, b, c])].all() and slamdb.check(atlas).sound
    with pytest.raises(ValueError, match="row 1 leads from a keyframe to itself"):
        map.add_merge_edges([(a, b), (c, c)])
    assert len(map.merge_edges) == 0


def test_reference_keyframes(atlas):
    map = atlas.maps[0]
    row = next(each for each in map.points if len(each.observations) > 1)
    other = next(each for each in row.observations if each != row.reference_keyframe)
    map.set_reference_keyframes([row.id], [other])
    assert map.points.by_id(row.id).reference_keyframe == other and slamdb.check(atlas).sound
    stranger = next(each for each in map.keyframes.ids.tolist() if each not in row.observations)
    with pytest.raises(ValueError, match="does not observe point"):
        map.set_reference_keyframes([row.id], [stranger])


def test_points_that_were_moved_are_updated(atlas):
    map = atlas.maps[0]
    untouched = map.points.normals[1:].copy()
    map.points.positions[0] += np.float32(0.5)
    before = map.points.normals[0].copy()
    map.update_points([map.points.ids[0]])
    assert not np.allclose(map.points.normals[0], before) and np.array_equal(map.points.normals[1:], untouched)
    centers = map.keyframes.centers[map.keyframes.rows_of(list(map.points[0].observations))]
    rays = map.points.positions[0] - centers
    mean = (rays / np.linalg.norm(rays, axis=1)[:, None]).mean(axis=0)
    assert np.allclose(map.points.normals[0], mean, atol=1e-5)


