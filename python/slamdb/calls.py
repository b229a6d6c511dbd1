# SPDX-License-Identifier: BSD-3-Clause
"""How the functions of verbs call the module in C++: keyword arguments in; reports, atlases and warnings out."""

import os
from typing import Any, Callable, List, Mapping, Sequence, Tuple, Union

from ._slamdb import Atlas
from .files import Path, told
from .report import Report

Source = Union[Atlas, Path]
Texts = Union[str, Sequence[str]]  # one, or several
Ids = Union[None, int, Sequence[int]]  # one, or several
Arguments = Mapping[str, Any]
Notices = List[Tuple[str, str]]



def listed(texts: Texts) -> List[str]:
    return [texts] if isinstance(texts, str) else list(texts)


def several(sources: Union[Source, Sequence[Source]]) -> List[Source]:
    """One, or a sequence of them, as a list."""
    return [sources] if isinstance(sources, (Atlas, str, os.PathLike)) else list(sources)


def changed(verb: Callable[[Atlas, Arguments], Tuple[str, Notices]], given: Arguments) -> Report:
    """Does a verb that changes `given["atlas"]` in place."""
    arguments = dict(given)
    if not isinstance(arguments["atlas"], Atlas):
        raise TypeError(f"an Atlas is changed in place, and {arguments['atlas']!r:.80} is none: slamdb.read reads one")
    text, notices = verb(arguments.pop("atlas"), arguments)
    told(notices)
    return Report.parse(text)


def reported(verb: Callable[[Arguments], Tuple[str, Notices]], given: Arguments) -> str:
    text, notices = verb(given)
    told(notices)
    return text


def made(verb: Callable[[Arguments], Tuple[Atlas, str, Notices]], given: Arguments) -> Tuple[Atlas, Report]:
    atlas, text, notices = verb(given)
    told(notices)
    return atlas, Report.parse(text)
