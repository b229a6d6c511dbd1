# SPDX-License-Identifier: BSD-3-Clause
"""The vocabulary that an atlas was made with: ORB-SLAM3 refuses an atlas of another one (schema/vocabulary.md)."""

from typing import Optional

from . import _slamdb
from ._slamdb import Atlas
from .calls import Source, changed, reported
from .files import Path, Progress
from .report import Report


def vocabulary_show(*paths: Path, threads: int = 0) -> Report:
    """Which vocabulary atlases were made with, or what vocabulary files are: `report.inputs[0].vocabulary.name`."""
    return Report.parse(
        reported(_slamdb.vocabulary_show, {"paths": paths, "threads": threads})
    )


def vocabulary_verify(source: Source, *, vocabulary: Path) -> str:
    """How the vocabulary of an atlas differs from that file; empty: it was made with it."""
    return reported(_slamdb.vocabulary_mismatch, {"source": source, "vocabulary": vocabulary})


def vocabulary_set(
    atlas: Atlas,
    *,
    vocabulary: Optional[Path] = None,
    name: str = "",
    checksum: str = "",
    force: bool = False,
) -> None:
    """Let the atlas name another vocabulary, in place: one that has the same words.

    vocabulary: stamp name and MD5 of this file, or name and checksum themselves
    force: stamp also what is no vocabulary
    """
    changed(_slamdb.vocabulary_set, locals())


def vocabulary_recompute(
    atlas: Atlas, *, vocabulary: Path, missing: bool = False, threads: int = 0, progress: Progress = None
) -> Report:
    """Compute all words anew by the file of a vocabulary, in place.

    missing: only of keyframes without a bag of words or feature vector
    """
    return changed(_slamdb.vocabulary_recompute, locals())
