# SPDX-License-Identifier: BSD-3-Clause
import base64
import copy
import html.parser
import json
import re
import xml.etree.ElementTree

import numpy as np
import pytest
import slamdb
from slamdb import _slamdb, notebook

HOSTILE = "</td><script>alert(1)</script><img src=x onerror=alert(2)>\"'&"


class Markup(html.parser.HTMLParser):
    """What is in a piece of HTML: its tags, in order and closed, and their attributes."""

    EMPTY = {"img", "br"}

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.words, self.open = [], [], "", []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += attributes
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, words):
        self.words += words


@pytest.fixture
def store(tmp_path, atlas):
    store = slamdb.Store(tmp_path / "maps.db")
    store.save("lab", atlas)
    return store


SHOWN = {
    "atlas": lambda atlas, store: atlas,
    "map": lambda atlas, store: atlas.maps[0],
    "check": lambda atlas, store: slamdb.check(atlas),
    "info": lambda atlas, store: slamdb.Report({"maps": [{"id": 0}, {"id": 1}], "list": list(range(99)), "a": None}),
    "log": lambda atlas, store: store.log(),
    "checks of a store": lambda atlas, store: store.check(),
    "store": lambda atlas, store: store,
}


@pytest.mark.parametrize("what", SHOWN)
def test_what_is_shown_is_small_well_formed_and_runs_nothing(what, atlas, store):
    shown = SHOWN[what](atlas, store)._repr_html_()
    markup = Markup(shown)
    assert set(markup.tags) <= {"div", "strong", "table", "thead", "tbody", "tr", "th", "td", "img"}
    assert not any(name.startswith("on") or "javascript" in (value or "") for name, value in markup.attributes)
    assert len(shown) < 200_000
    assert shown == SHOWN[what](atlas, store)._repr_html_()


def test_an_atlas_shows_its_statistics_and_its_plan(atlas):
    markup = Markup(atlas._repr_html_())
    for figure in ("14", "3,162", "7,204", "0.5809", "5.253 m", "17.9 s"):
        assert figure in markup.words
    if "without a plan" in markup.words:
        pytest.skip("built without Cairo")
    [picture] = [value for name, value in markup.attributes if name == "src"]
    kind, data = picture.split(",")
    root = xml.etree.ElementTree.fromstring(base64.b64decode(data))
    assert kind == "data:image/svg+xml;base64" and root.tag.endswith("svg") and len(list(root.iter())) > 50


def test_a_map_of_several_shows_itself_alone(fixtures):
    merged, _ = slamdb.merge(*(fixtures / name / f"{name}.osa" for name in ("session_small_a", "session_small_b")))
    words = [Markup(map._repr_html_()).words for map in merged.maps]
    assert "3,162" in words[0] and "3,235" not in words[0] and "3,235" in words[1] and "3,162" not in words[1]


def test_without_cairo_the_rest_is_shown(atlas, monkeypatch):
    monkeypatch.setattr(_slamdb, "plan", lambda atlas, width: None)
    words = Markup(atlas._repr_html_()).words
    assert "3,162" in words and "libcairo2-dev" in words


def test_names_are_text(tmp_path, atlas, store):
    report = slamdb.Report({"report": HOSTILE, HOSTILE: HOSTILE, "rows": [{HOSTILE: HOSTILE}], "list": [HOSTILE]})
    failed = slamdb.check(HOSTILE)
    name = HOSTILE.replace("/", "")
    store.save(name, atlas)
    shows = {HOSTILE: (report, failed), name: (store, store.log(), store.check())}
    for text, shown in ((text, each) for text, several in shows.items() for each in several):
        markup = Markup(shown._repr_html_())
        assert text in markup.words and not {"script", "img"} & set(markup.tags)


def test_atlases_of_anything_are_shown(atlas):
    atlas.maps[0].points.positions[:] = np.nan
    atlas.maps[0].keyframes.camera_from_world[:] = np.inf
    assert "14" in Markup(atlas._repr_html_()).words
    Markup(atlas.maps[0]._repr_html_())


def test_a_store_that_cannot_be_read_is_shown_as_text(store, tmp_path):
    store.close()
    assert store._repr_html_() is None and slamdb.Store(tmp_path / "none.db")._repr_html_() is None


@pytest.fixture
def page_is_built(atlas):
    try:
        slamdb.view(atlas)
    except slamdb.UnsupportedError as error:
        assert "esbuild" in str(error)
        pytest.skip("built without esbuild")


def test_the_viewer_is_in_a_frame_of_its_own(page_is_built, atlas):
    shown = slamdb.view(atlas, height=321)
    markup = Markup(shown._repr_html_())
    assert markup.tags == ["iframe"]
    attributes = dict(markup.attributes)
    assert attributes["sandbox"] == "allow-scripts allow-downloads" and attributes["srcdoc"] == shown.html
    assert "height:321px" in attributes["style"] and "Content-Security-Policy" in shown.html
    assert len(shown.html) > 100_000 and shown.left_out == []


def test_what_jupyter_would_not_let_through_is_not_embedded(page_is_built, atlas, monkeypatch):
    whole, bare = (len(slamdb.view(atlas, keypoints=which).html) for which in ("all", "none"))
    monkeypatch.setattr(notebook, "MOST_EMBEDDED", (whole + bare) // 2)
    shown = slamdb.view(atlas)
    assert len(shown.html) == bare and any("keypoints" in sentence for sentence in shown.left_out)
    assert "keypoints" in Markup(shown._repr_html_()).words
    monkeypatch.setattr(notebook, "MOST_EMBEDDED", bare - 1)
    markup = Markup(slamdb.view(atlas)._repr_html_())
    assert "iframe" not in markup.tags and "map.html" in markup.words and f"{bare:,}" in markup.words


def test_the_page_is_written_as_a_file(page_is_built, atlas, session, tmp_path):
    page = tmp_path / "map.html"
    shown = slamdb.view(atlas, page, title=HOSTILE)
    assert page.read_text(encoding="utf-8") == shown.html and "<script>alert" not in shown.html
    with pytest.raises(slamdb.AlreadyExistsError):
        slamdb.view(atlas, page)
    slamdb.view([session, atlas], page, overwrite=True, side_by_side=True, normals=True, check=False)
    assert re.search("session_small_a.osa", page.read_text(encoding="utf-8"))
    with pytest.raises(slamdb.UsageError):
        slamdb.view(atlas, tmp_path / "map.osa")
    with pytest.raises(ValueError, match="matched"):
        slamdb.view(atlas, keypoints="some")
    assert [each.name for each in tmp_path.iterdir()] == ["map.html"]


def test_what_a_report_found_is_in_the_page(page_is_built, atlas, command, tmp_path):
    base, ours, theirs = copy.deepcopy(atlas), copy.deepcopy(atlas), copy.deepcopy(atlas)
    for each, ids in ((base, range(8)), (ours, range(11)), (theirs, [0, 1, 2, 3, 5, 6, 7, 11])):
        extracted = slamdb.extract(each, keyframe=list(ids))
    merged, report = slamdb.merge(ours, theirs, base=base)
    assert report["branches"]["conflicts"]
    shown = slamdb.view(merged, findings=report)
    (tmp_path / "merge.json").write_text(json.dumps(report.to_dict()), encoding="utf-8")
    assert slamdb.view(merged, findings=tmp_path / "merge.json").html == shown.html != slamdb.view(merged).html
    with pytest.raises(slamdb.UsageError, match="of one atlas"):
        slamdb.view([merged, atlas], findings=report)
    with pytest.raises(slamdb.UsageError):
        slamdb.view(merged, findings=extracted)


PART = ({"keyframes": (0, 5), "keypoints": "none"}, "--keyframes 0:5 --keypoints none")


@pytest.mark.parametrize("arguments, options", [({}, ""), PART], ids=["whole", "part"])
def test_the_page_is_the_commands(page_is_built, session, command, tmp_path, arguments, options):
    shown = slamdb.view(session, tmp_path / "mine.html", **arguments)
    command("view", session, "-o", tmp_path / "theirs.html", *options.split(), json=False)
    assert shown.html == (tmp_path / "mine.html").read_text() == (tmp_path / "theirs.html").read_text()
    assert "px on average" in shown.html  # the panel of the viewer


def test_two_atlases_are_compared(page_is_built, atlas, session):
    atlas.maps[0].points.positions[0] += 1
    assert slamdb.view([session, atlas], diff=True).html != slamdb.view([session, atlas]).html
    with pytest.raises(slamdb.UsageError):
        slamdb.view(atlas, diff=True)
