# SPDX-License-Identifier: BSD-3-Clause
"""Layouts of .osa files of forks of ORB-SLAM3 (docs/layouts.md): `layout=` of `read`, `recover` and `convert`."""

from typing import Optional

from . import _slamdb
from .calls import reported
from .files import Path
from .report import Report


def layouts_list() -> Report:
    """The layouts that slamdb knows."""
    return Report.parse(reported(_slamdb.layouts_list, {}))


def layouts_show(layout: Path) -> Report:
    """A layout, by its id or of a JSON file, with all members."""
    return Report.parse(reported(_slamdb.layouts_show, {"layout": layout}))


def layouts_infer(
    path: Path, *, choose: int = 1, output: Optional[Path] = None, overwrite: bool = False
) -> Report:
    """Find the layout of an .osa file: one that is known, or the smallest change of one that explains every byte.

    choose: where several fit, take this one; 1 is the likeliest
    output: write it to this file; overwrite: replace it
    """
    return Report.parse(reported(_slamdb.layouts_infer, locals()))


def layouts_from_source(folder: Path, *, output: Optional[Path] = None, overwrite: bool = False) -> Report:
    """Derive the layout from the serialize functions in the folder of a fork's sources.

    output: write it to this file; overwrite: replace it
    """
    return Report.parse(reported(_slamdb.layouts_from_source, locals()))
