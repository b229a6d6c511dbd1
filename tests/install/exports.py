#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""exports.py BUILD: what the public headers declare and do not define, BUILD/lib/libslamdb.so gives to programs.

A program that calls what is declared without SLAMDB_EXPORT links against the static library alone.
"""
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FUNCTIONS = {"FunctionDecl", "CXXMethodDecl", "CXXConstructorDecl", "CXXDestructorDecl", "CXXConversionDecl"}
ELSEWHERE = {"isImplicit", "explicitlyDeleted", "explicitlyDefaulted", "inline", "constexpr", "pure"}


def compiler_arguments(build: pathlib.Path) -> list[str]:
    """Include paths and definitions that the build has for what uses all public headers."""
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if entry["file"].endswith("examples/first_lines.cc"):
            return re.findall(r"(?<= )(?:-I|-isystem |-D|-std=)\S+", entry["command"])
    sys.exit(f"{build} does not build examples/first_lines.cc")


def syntax_trees(text: str):
    """clang prints one after another, each behind a line that names it."""
    decoder, at = json.JSONDecoder(), text.find("\n{") + 1
    while at > 0:
        tree, end = decoder.raw_decode(text, at)
        yield tree
        at = text.find("\n{", end - 1) + 1


def declared(node: dict):
    """Mangled names of the functions in a tree that are declared alone."""
    inner = node.get("inner", [])
    if node["kind"] in {"NamespaceDecl", "CXXRecordDecl"}:
        for each in inner:
            yield from declared(each) if "kind" in each else ()
    elif node["kind"] in FUNCTIONS and not ELSEWHERE & node.keys():
        if "mangledName" in node and all(each.get("kind") != "CompoundStmt" for each in inner):
            yield node["mangledName"]


def main() -> None:
    build = pathlib.Path(sys.argv[1]).resolve()
    arguments = " ".join(compiler_arguments(build)).split()
    dump = subprocess.run(
        ["clang++", *arguments, "-fsyntax-only", "-Xclang", "-ast-dump=json", "-Xclang", "-ast-dump-filter=slamdb::", "-x", "c++", "-"],
        input='#include "slamdb/slamdb.h"\n', capture_output=True, text=True, check=True, cwd=ROOT).stdout
    wanted = {name for tree in syntax_trees(dump) for name in declared(tree)}
    lines = subprocess.run(["nm", "-D", "--defined-only", build / "lib/libslamdb.so"], capture_output=True, text=True, check=True).stdout
    given = {line.split()[-1] for line in lines.splitlines()}
    missing = subprocess.run(["c++filt"], input="\n".join(sorted(wanted - given)), capture_output=True, text=True, check=True).stdout
    if len(wanted) < 100:
        sys.exit(f"only {len(wanted)} functions were found in the public headers: what clang prints is read wrongly")
    if missing:
        sys.exit(f"declared in public headers, and hidden in libslamdb.so (SLAMDB_EXPORT):\n{missing}")
    print(f"libslamdb.so gives all {len(wanted)} functions that its public headers declare.")


main()
