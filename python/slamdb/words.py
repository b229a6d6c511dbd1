# SPDX-License-Identifier: BSD-3-Clause
"""Sentences of the library name its C++ functions and options; here they name what Python has."""

_WORDS = (
    ("WriteOptions::overwrite", "overwrite=True"),
    ("WriteOptions::strict", "strict=True"),
    ("WriteOptions::format", "format="),
    ("ReadOptions::format", "format="),
    ("SalvageAtlas", "slamdb.recover"),
    ("`RecoverAtlas`", "slamdb.recover"),
    ("`CheckAtlas`", "slamdb.check"),
    ("`RepairAtlas`", "slamdb.repair"),
    ("`MergeAtlases`", "slamdb.merge"),
    ("`DiffAtlases`", "slamdb.diff"),
)


def in_python_words(sentence: str) -> str:
    for library, python in _WORDS:
        sentence = sentence.replace(library, python)
    return sentence
