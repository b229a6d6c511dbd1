# SPDX-License-Identifier: BSD-3-Clause
import collections
import json
import pathlib
import shutil
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


def test_the_notebook_runs_again_where_it_ran(fixtures, tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    for name in ("session_small_a", "session_small_b"):
        shutil.copytree(fixtures / name, name)
    cells = json.loads((DOCS / "notebook.ipynb").read_text(encoding="utf-8"))["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    for _ in range(2):
        exec(code, {})
