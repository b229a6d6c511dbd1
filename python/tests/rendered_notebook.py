# SPDX-License-Identifier: BSD-3-Clause
"""docs/notebook.md and its pictures, from docs/notebook.ipynb, which is run. As a program it writes them anew:

    PYTHONPATH=build/dev/python python3 python/tests/rendered_notebook.py
"""

import base64
import importlib.util
import os
import pathlib
import re
import shutil
import tempfile
from typing import Any, Dict, Tuple

SOURCE = pathlib.Path(__file__).resolve().parents[2]
HEAD = "<!-- made from notebook.ipynb by python/tests/rendered_notebook.py -->\n\n"
PICTURE = re.compile(r"data:image/svg\+xml;base64,([\w+/=]+)")


def run() -> Any:
    """The notebook with its outputs, run where the fixtures that it reads are."""
    import nbclient
    import nbformat

    notebook = nbformat.read(SOURCE / "docs" / "notebook.ipynb", as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        for name in ("session_small_a", "session_small_b"):
            shutil.copytree(SOURCE / "fixtures" / name, pathlib.Path(folder, name))
        client = nbclient.NotebookClient(notebook, kernel_name="python3", resources={"metadata": {"path": folder}})
        package = pathlib.Path(importlib.util.find_spec("slamdb").origin).resolve().parents[1]
        return client.execute(env={**os.environ, "PYTHONPATH": str(package)})


def _shown(data: Dict[str, str]) -> str:
    page = data.get("text/html", "<style")
    # Pages of Markdown show neither frames nor the style sheets of data frames.
    return f"```\n{data['text/plain']}\n```" if "<style" in page or "<iframe" in page else page


def render(notebook: Any) -> Tuple[str, Dict[str, str]]:
    """The page, and the pictures beside it by name."""
    parts = []
    for cell in notebook.cells:
        parts.append(cell.source if cell.cell_type == "markdown" else f"```python\n{cell.source}\n```")
        for output in cell.get("outputs", ()):
            parts.append(_shown(output.data) if "data" in output else f"```\n{output.text}```")
    pictures: Dict[str, str] = {}

    def beside(match: "re.Match[str]") -> str:
        name = f"notebook_{len(pictures) + 1}.svg"
        pictures[name] = base64.b64decode(match[1]).decode()
        return name

    return HEAD + PICTURE.sub(beside, "\n\n".join(parts)) + "\n", pictures


if __name__ == "__main__":
    page, pictures = render(run())
    for name, text in {"notebook.md": page, **pictures}.items():
        (SOURCE / "docs" / name).write_text(text, encoding="utf-8")
