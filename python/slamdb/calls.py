# SPDX-License-Identifier: BSD-3-Clause
"""How the functions of verbs call the module in C++: keyword arguments in; reports, atlases and warnings out."""

import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from ._slamdb import Atlas
from .files import Path, _told, read
from .report import Report

Source = Union[Atlas, Path]
Texts = Union[str, Sequence[str]]  # one, or several
Ids = Union[None, int, Sequence[int]]  # one, or several
Arguments = Mapping[str, Any]
Notices = List[Tuple[str, str]]

_DEPTH = 4  # from the warning to who called the verb


def held(source: Source) -> Atlas:
    return source if isinstance(source, Atlas) else read(source)


def name(source: Source) -> str:
    return "" if isinstance(source, Atlas) else os.fspath(source)


def named(given: Arguments, key: str = "source") -> Dict[str, Any]:
    """The arguments with the atlas itself under that key, and how it is called."""
    source = given[key]
    return {**given, key: held(source), "name": name(source)}


def listed(texts: Texts) -> List[str]:
    return [texts] if isinstance(texts, str) else list(texts)


def several(sources: Union[Source, Sequence[Source]]) -> List[Source]:
    """One, or a sequence of them, as a list."""
    return [sources] if isinstance(sources, (Atlas, str, os.PathLike)) else list(sources)


def changed(verb: Callable[[Atlas, Arguments], Tuple[str, Notices]], given: Arguments) -> Report:
    """Does a verb that changes `given["atlas"]` in place."""
    arguments = dict(given)
    text, notices = verb(arguments.pop("atlas"), arguments)
    _told(notices, _DEPTH)
    return Report.parse(text)


def reported(verb: Callable[[Arguments], Tuple[str, Notices]], given: Arguments) -> str:
    text, notices = verb(given)
    _told(notices, _DEPTH)
    return text


def made(verb: Callable[[Arguments], Tuple[Atlas, str, Notices]], given: Arguments) -> Tuple[Atlas, Report]:
    atlas, text, notices = verb(given)
    _told(notices, _DEPTH)
    return atlas, Report.parse(text)


def optional(source: Optional[Source]) -> Optional[Atlas]:
    return None if source is None else held(source)
