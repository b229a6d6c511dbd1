# SPDX-License-Identifier: BSD-3-Clause
import collections
import pathlib
import xml.etree.ElementTree

import pytest
import rendered_notebook
from slamdb import _slamdb

DOCS = rendered_notebook.SOURCE / "docs"


def shapes(svg: str) -> collections.Counter:
    """What is drawn, but for letters, whose shapes are those of the machine's fonts."""
    root = xml.etree.ElementTree.fromstring(svg)
    names = [(each.tag.split("}")[-1], each.get("stroke")) for each in root.iter()]
    return collections.Counter(name for name in names if name[0] not in ("use", "symbol", "g", "path"))


def test_the_notebook_shows_what_its_page_says(atlas, tmp_path):
    for module in ("nbformat", "nbclient", "ipykernel", "pandas"):
        pytest.importorskip(module)
    if _slamdb.plan(atlas, 400) is None:
        pytest.skip("built without Cairo")
    page, pictures = rendered_notebook.render(rendered_notebook.run())
    assert page == (DOCS / "notebook.md").read_text(encoding="utf-8")
    assert {path.name for path in DOCS.glob("notebook_*.svg")} == set(pictures) != set()
    for name, text in pictures.items():
        assert shapes(text) == shapes((DOCS / name).read_text(encoding="utf-8"))
