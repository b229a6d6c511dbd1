# SPDX-License-Identifier: BSD-3-Clause
"""How much memory atlases may take, and where what is more goes (docs/memory.md)."""

from typing import Optional

from . import _slamdb
from .files import Path


def set_memory_limit(memory: int = 0, *, spill: Optional[Path] = None) -> None:
    """Let the process take at most so much memory; columns beyond it go to a file on disk that has no name.

    It is for the whole process, from now on: what is in memory already stays there.

    memory: bytes; 0: three quarters of what is free
    spill: folder of that file, on disk; by default TMPDIR where that is on disk, else /var/tmp
    """
    _slamdb.set_memory_limit({"memory": memory, "spill": spill})


def spilled() -> int:
    """Bytes that are in that file now."""
    return _slamdb.spilled()
