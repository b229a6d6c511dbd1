# SPDX-License-Identifier: BSD-3-Clause
"""Sentences of the library name its C++ functions and options; here they name what Python has.

The command has a table of these (cli/words.cc). Verbs and options of the command are functions and keyword arguments
of the same names, so its words become Python's by spelling: `slamdb close-loops` is slamdb.close_loops, --max-dt is
max_dt=.
"""

import re
from typing import Match

from ._slamdb import command_words

_INNER = "from-points|to-points|show|verify|set|recompute|list|infer|from-source"
_VERB = re.compile(rf"`slamdb ([a-z-]+)(?: ({_INNER})\b)?(?: --([a-z-]+))?(`?)")
_VALUED = re.compile(r"--([a-z][a-z-]*) (all|full|keep-first|sim3)\b")
_OPTION = re.compile(r"(?<!\w)(?:-[A-Za-z]/)?--([a-z][a-z-]*)|^-(r)\b")

_ELSEWHERE = {"edit": "edit_tables", "list": "list_atlases"}
_OF_STORES = ("add", "backup", "log", "migrate", "remove", "stats", "vacuum")
_OF_THE_COMMAND = ("completion", "help", "version")
_FLAGS = ("accept_edits", "add", "by_index", "force", "overwrite", "recursive", "sanitize", "strict")
_KEYWORDS = {"r": "recursive", "from": "format", "to": "format", "as": "name", "for": "for_", "except": "except_"}


def _keyword(option: str) -> str:
    keyword = _KEYWORDS.get(option, option).replace("-", "_")
    return f"{keyword}={'True' if keyword in _FLAGS else ''}"


def _function(said: Match[str]) -> str:
    verb, inner, option, end = said.groups()
    if verb in _OF_THE_COMMAND:
        return said[0]
    name = _ELSEWHERE.get(verb, verb).replace("-", "_") + ("_" + inner.replace("-", "_") if inner else "")
    arguments = f"({_keyword(option)})" if option else ""
    return ("" if end else "`") + ("slamdb.Store." if verb in _OF_STORES else "slamdb.") + name + arguments


def spelled(words: str) -> str:
    """A sentence in the words of the command as Python says it."""
    words = _VALUED.sub(lambda said: f'{_keyword(said[1])}"{said[2]}"', _VERB.sub(_function, words))
    return _OPTION.sub(lambda said: _keyword(said[1] or said[2]), words)


_WORDS = [(library, spelled(command)) for library, command in command_words()]


def in_python_words(sentence: str) -> str:
    for library, python in _WORDS:
        sentence = sentence.replace(library, python)
    return sentence
