# SPDX-License-Identifier: BSD-3-Clause
"""The command and the package are in step: verbs are functions, long options keywords of the same names."""

import inspect
import keyword
import os
import re
import subprocess

import pytest
import slamdb

OF_THE_COMMAND = {
    "help": "help() is Python's",
    "completion": "shells complete the command",
    "version": "slamdb.__version__",
    "show": "entities are objects: atlas.maps[0].keyframes[3]",
    "dump": "encode(atlas, format='ndjson')",
    "fleet": "servers are set up from a shell",
}
ELSEWHERE = {  # what does the verb, where it is no function of that name and options
    "add": "Store", "log": "Store", "remove": "Store", "stats": "Store", "vacuum": "Store", "backup": "Store",
    "migrate": "Store", "restore": "Store", "tag": "Store", "branch": "Store", "gc": "Store",
}  # fmt: skip
CALLED = {"list": "list_atlases", "edit": "edit_tables"}  # functions of other names
INNER = {
    "landmarks": ["from-points", "to-points"],
    "vocabulary": ["show", "verify", "set", "recompute"],
    "layouts": ["list", "show", "infer", "from-source"],
}

# Options that no function needs.
CONSOLE = {"help", "version", "quiet", "verbose", "no-progress", "color", "json", "format"}  # how the command speaks
PROCESS = {"memory", "spill"}  # of set_memory_limit
FILES = {"output", "from", "layout", "to", "overwrite", "no-sync", "wait", "to-layout", "boost-version", "dry-run"}
ITS_OWN = {  # of single verbs
    "info": {"plot": "for terminals", "get": "report['maps']"},
    "check": {"list": "docs/checks.md"},
    "list_atlases": {"columns": "report['atlases']"},
    "view": {"open": "webbrowser", "serve": "http.server", "port": "http.server"},
    "diff": {"ignore-ids": "report.verdict", "summary": "report.verdict"},
    "merge": {"no-scale": "scale=False", "no-fuse": "fuse=False", "no-base": "a base is given or none"},
    "vocabulary_show": {}, "layouts_list": {},
}  # fmt: skip


def printed(*words):
    return subprocess.run([os.environ["SLAMDB"], *words], stdout=subprocess.PIPE, text=True, check=True).stdout


def verbs():
    return re.findall(r"^  ([a-z-]+)  +\S", printed("help").split("Common options")[0], re.MULTILINE)


def functions():
    for verb in verbs():
        if verb not in OF_THE_COMMAND and verb not in ELSEWHERE:
            yield from ([verb, inner] for inner in INNER[verb]) if verb in INNER else [[verb]]


def function_of(words):
    return CALLED.get("_".join(words), "_".join(words)).replace("-", "_")


def test_every_verb_is_there_or_has_a_reason():
    assert {"cull", "help", "merge"} < set(verbs())
    for verb in verbs():
        names = [function_of([verb, inner]) for inner in INNER.get(verb, [])]
        for name in names or [ELSEWHERE.get(verb, function_of([verb]))]:
            if verb not in OF_THE_COMMAND:
                assert hasattr(slamdb, name), verb


@pytest.mark.parametrize("words", functions(), ids=" ".join)
def test_every_option_is_a_keyword(words):
    name = function_of(words)
    keywords = inspect.signature(getattr(slamdb, name)).parameters
    described = inspect.getdoc(getattr(slamdb, name))
    options = set(re.findall(r"^  (?:-\w, )?--([a-z][a-z0-9-]*)", printed(*words, "--help"), re.MULTILINE))
    assert "quiet" in options
    limits = {option for option in options if "gates" in keywords and re.match("m(ax|in)-", option)}
    for option in options - limits - CONSOLE - PROCESS - set(ITS_OWN.get(name, {})):
        spelled = option.replace("-", "_") + ("_" if keyword.iskeyword(option) else "")
        if option in FILES | {"threads", "progress"} and spelled not in keywords:
            continue  # of what `read` and `write` do; and quick ones have no progress
        if option.startswith("no-") and spelled not in keywords:
            spelled = spelled[len("no_") :]  # its default is True
        assert spelled in keywords, f"--{option}"
        assert spelled in described or spelled in ("threads", "progress"), f"{spelled} is not described"


@pytest.mark.parametrize("words", functions(), ids=" ".join)
def test_no_keyword_is_pythons_alone(words):
    name = function_of(words)
    options = set(re.findall(r"--([a-z][a-z0-9-]*)", printed(*words, "--help")))
    pythons_own = {"format": "--from", "gates": "--min-... and --max-...", "sync": "--no-sync", "picture": "--format",
                   "name": "of atlases in memory", "height": "of the frame in a notebook"}  # fmt: skip
    for spelled, parameter in inspect.signature(getattr(slamdb, name)).parameters.items():
        if parameter.kind is parameter.KEYWORD_ONLY and spelled not in pythons_own:
            option = spelled.rstrip("_").replace("_", "-")
            assert option in options or f"no-{option}" in options, spelled


def test_sentences_speak_of_what_python_has():
    from slamdb.words import _WORDS, in_python_words

    for library, python in _WORDS:
        assert "--" not in python and "`slamdb " not in python.replace("`slamdb version`", ""), python
        for name in re.findall(r"slamdb\.([a-z_]+)", python):
            assert hasattr(slamdb, name), python
    assert in_python_words("is there; WriteOptions::overwrite replaces it") == "is there; overwrite=True replaces it"
    assert in_python_words("`MakeLandmarks` makes them") == "slamdb.landmarks_from_points makes them"
    page = "<style>a { color: var(--ink) }</style> a --strict b"
    assert in_python_words(page) == page
