# SPDX-License-Identifier: BSD-3-Clause
"""Arguments that cannot be, or would be without effect, are refused as the command refuses them."""

import inspect
import os
import re
import subprocess
import warnings

import numpy as np
import pytest
import slamdb

from test_command import function_of, functions

NEVER = ("1e400", "nan", "-1")  # of no use to any option that takes a number above 0


def number_options():
    """Each verb's keywords that are numbers, and how the command spells them."""
    for words in functions():
        name = function_of(words)
        for spelled, parameter in inspect.signature(getattr(slamdb, name)).parameters.items():
            if parameter.kind is parameter.KEYWORD_ONLY and re.fullmatch(
                r"(typing\.)?(Optional\[)?(int|float)\]?", str(parameter.annotation).replace("<class '", "").replace("'>", "")
            ):
                yield words, name, spelled


IDS = {"map", "maps", "reference_map"}  # which there are or are not


@pytest.mark.parametrize("words, name, spelled", number_options())
def test_numbers_are_within_the_command_s_limits(words, name, spelled, session, tmp_path):
    """What the command refuses when it reads its options, Python refuses, too."""
    option = "--" + spelled.replace("_", "-")
    described = subprocess.run([os.environ["SLAMDB"], *words, "--help"], stdout=subprocess.PIPE, text=True, check=True)
    if option + " " not in described.stdout or spelled in IDS:
        pytest.skip(f"{option} is no option of the command")
    function = getattr(slamdb, name)
    for text in NEVER:
        asked = [os.environ["SLAMDB"], *words, f"{option}={text}", str(session), str(tmp_path / "out.osa")]
        done = subprocess.run(asked, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode != 2 or option not in done.stderr:
            continue
        value = int(text) if text == "-1" else float(text)
        with pytest.raises((slamdb.UsageError, ValueError, TypeError)):
            called(function, session, tmp_path, {spelled: value})


def called(function, session, folder, keywords):
    first = next(iter(inspect.signature(function).parameters.values()))
    if first.name == "atlas":
        return function(slamdb.read(session), **keywords)
    if first.name in ("folder", "paths"):
        return function(folder, **keywords)
    places = {"convert": [session, folder / "out.ply"], "evaluate": [session, session], "diff": [session, session],
              "merge": [session, session], "align": [session, session], "locate": [session, folder],
              "synthesize": [], "list_atlases": [session], "plot": [session], "view": [session]}  # fmt: skip
    return function(*places.get(function.__name__, [session]), **keywords)


IDLE = {
    "merge transform": lambda s, a: slamdb.merge(a, s, transform="0 0 0 0 0 0 1"),
    "merge anchors": lambda s, a: slamdb.merge(a, s, anchors=[(0, 1)]),
    "merge optimize": lambda s, a: slamdb.merge(a, s, optimize="full"),
    "merge fuse": lambda s, a: slamdb.merge(a, s, fuse=True),
    "merge fuse_radius": lambda s, a: slamdb.merge(a, s, fuse_radius=3),
    "locate camera": lambda s, a: slamdb.locate(a, benchmark=True, camera="nofile.yaml"),
    "locate output": lambda s, a: slamdb.locate(a, benchmark=True, output="nofile.txt"),
    "plot max_dt": lambda s, a: slamdb.plot(a, max_dt=5),
    "plot joint": lambda s, a: slamdb.plot(a, joint=True),
    "renumber": lambda s, a: slamdb.renumber(a, start=4, offset=5),
    "renumber apply": lambda s, a: slamdb.renumber(a, start=4, apply="ids.csv"),
    "transform": lambda s, a: slamdb.transform(a, scale=2, max_dt=1),
    "transform times": lambda s, a: slamdb.transform(a, scale=2, times="x"),
    "transform origin": lambda s, a: slamdb.transform(a, scale=2, origin=(48, 11)),
    "convert sim3": lambda s, a: slamdb.convert(a, "o.ply", sim3=True),
    "convert long_bytes": lambda s, a: slamdb.convert(a, "o.ply", long_bytes=4),
    "convert long_bytes of seven": lambda s, a: slamdb.convert(a, "o.osa", long_bytes=7),
    "convert with_database": lambda s, a: slamdb.convert(a, "o.ply", with_database=True),
    "synthesize": lambda s, a: slamdb.synthesize(common=0.5),
    "synthesize size": lambda s, a: slamdb.synthesize(size=10**6, points=5),
}


@pytest.mark.parametrize("call", IDLE.values(), ids=IDLE)
def test_what_would_be_without_effect_is_refused(call, session):
    atlas = slamdb.read(session)
    before = slamdb.encode(atlas)
    with pytest.raises(slamdb.UsageError, match="="):
        call(session, atlas)
    assert slamdb.encode(atlas) == before


def test_parts_are_told_in_either_order_and_may_be_open(session):
    low, high = (-1, -1, -1), (1, 1, 3)
    inside = len(slamdb.read(session, box=(low, high)).maps[0].points)
    assert inside == len(slamdb.read(session, box=(high, low)).maps[0].points) > 0
    times = sorted(slamdb.read(session).maps[0].keyframes.timestamps)
    assert len(slamdb.read(session, time=(times[3], None)).maps[0].keyframes) == len(times) - 3
    assert len(slamdb.read(session, time=(None, times[3])).maps[0].keyframes) == 4


@pytest.mark.parametrize(
    "part",
    [{"map": 9}, {"keyframes": (5, 2)}, {"time": (5, 1)}, {"time": (1.0, 2.0)}, {"time": (float("nan"), 1)},
     {"box": ((900, 900, 900), (901, 901, 901))}, {"box": ((float("nan"), 0, 0), (1, 1, 1))}],
)  # fmt: skip
def test_parts_that_are_not_there_are_errors(session, tmp_path, part):
    with slamdb.Store(tmp_path / "maps.db") as store:
        store.save("lab", slamdb.read(session))
        with pytest.raises((slamdb.NotFoundError, slamdb.UsageError)):
            store.load("lab", **part)
    with pytest.raises((slamdb.NotFoundError, slamdb.UsageError)):
        slamdb.read(session, **part)


def test_an_atlas_is_what_verbs_change(session):
    for verb in (slamdb.cull, slamdb.repair, slamdb.extract, slamdb.renumber):
        with pytest.raises(TypeError, match="slamdb.read reads one"):
            verb(str(session))


def test_names_stay_what_they_are(session, tmp_path):
    """Sentences of reports are put into Python's words, names are not."""
    name = "migrate it first"
    with slamdb.Store(tmp_path / "SalvageAtlas.db") as store:
        store.save(name, slamdb.read(session))
        assert [atlas.name for atlas in store.list().atlases] == [name]
        assert store.check().sound
    assert slamdb.list_atlases(tmp_path / "SalvageAtlas.db").atlases[0].input.endswith(f"SalvageAtlas.db#{name}")


def test_a_part_does_not_pass_for_the_whole(session, tmp_path):
    part = slamdb.read(session, keyframes=(0, 5))
    with slamdb.Store(tmp_path / "maps.db") as store:
        store.save("lab", slamdb.read(session))
        for name, lesser in (("lab", store.load("lab", features=False)), ("part", part)):
            with pytest.warns(slamdb.LossWarning, match="part of the atlas"):
                store.save(name, lesser, overwrite=True)
    with pytest.warns(slamdb.LossWarning, match="part of the atlas"):
        slamdb.write(part, tmp_path / "part.osa")
    with pytest.raises(slamdb.NotPossibleError, match="part of the atlas"):
        slamdb.write(part, tmp_path / "strict.osa", strict=True)
    slamdb.extract(part)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        slamdb.write(part, tmp_path / "whole.osa")


@pytest.mark.parametrize("misspelt", ["descriptor", "octave"])
def test_names_of_feature_arrays_are_known(session, misspelt):
    atlas = slamdb.read(session)
    before = slamdb.encode(atlas)
    features = {"keypoints": [(90.0, 68.0)], misspelt: [3]}
    with pytest.raises(slamdb.UsageError, match=f"features: row 0.*{misspelt}.*may have keypoints"):
        atlas.maps[0].add_keyframes(timestamps=[1.0], poses=[np.eye(4)], features=[features], camera=0)
    assert slamdb.encode(atlas) == before


def test_keyframes_without_descriptors_are_warned_of():
    atlas = slamdb.Atlas()
    camera = atlas.add_camera("pinhole", 400, 400, 320, 240)
    keyframe = {"timestamps": [1.0], "poses": [np.eye(4)], "camera": camera}
    with pytest.warns(slamdb.SlamdbWarning, match="no descriptors"):
        atlas.add_map().add_keyframes(features=[{"keypoints": [(90.0, 68.0)]}], **keyframe)
