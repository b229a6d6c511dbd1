# SPDX-License-Identifier: BSD-3-Clause
"""Atlases out of pickles."""

from . import _slamdb
from ._slamdb import Atlas


def unpickled(format: str, data: bytes) -> Atlas:
    """What Atlas.__reduce__ calls: pickle takes functions of Python alone."""
    return _slamdb.unpickled(format, data)
