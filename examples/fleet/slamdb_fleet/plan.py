# SPDX-License-Identifier: BSD-3-Clause
"""Which atlases there are, which of them are done, and where each is written."""

import hashlib
import os
import pathlib
import urllib.parse
from typing import Any, Dict, Iterable, List, NamedTuple, Sequence, Set

import slamdb

from .journal import Entry
from .work import Chunk, Item, Job, holds, is_of, signature_of


class Plan(NamedTuple):
    items: List[Item]  # all, in the order in which they were named and found
    done: Dict[str, Entry]  # by input
    failures: Dict[str, str]  # of folders and stores that cannot be looked into, by their names


class Wanted(NamedTuple):
    names: Sequence[str]
    recursive: bool = False
    suffix: str = ""  # of outputs; empty: there are none
    pages: bool = False
    again: Sequence[str] = ()  # though it is done: "failed", and files of the same size and time, by their "hash"


def make_plan(wanted: Wanted, job: Job, known: Dict[str, Entry]) -> Plan:
    """known: entries of earlier runs, by input."""
    items: List[Item] = []
    done: Dict[str, Entry] = {}
    failures: Dict[str, str] = {}
    inputs: Dict[str, None] = {}  # each once
    for found in slamdb.find_atlases(*wanted.names, recursive=wanted.recursive):
        if found.failure:
            failures[found.input] = found.failure
        else:
            inputs[found.input] = None
    outputs = outputs_of(inputs, "atlases", wanted.suffix) if wanted.suffix else {}
    pages = outputs_of(inputs, "pages", ".html") if wanted.pages else {}
    stored = stored_atlases(inputs)
    for input in inputs:
        item = Item(input, outputs.get(input, ""), pages.get(input, ""), stored.get(input), None, None)
        entry = known.get(input)
        if entry is not None:
            if holds(entry, job, item) and not _is_asked_again(entry, wanted.again):
                done[input] = entry
            item = item._replace(before=_if_bytes_are_same(entry, job, item, wanted.again), seen=entry["at"])
        items.append(item)
    return Plan(items, done, failures)


def _is_asked_again(entry: Entry, again: Sequence[str]) -> bool:
    return ("failed" in again and bool(entry["kind"])) or ("hash" in again and "sha256" in entry["signature"])


def _if_bytes_are_same(entry: Entry, job: Job, item: Item, again: Sequence[str]) -> "Entry | None":
    """The entry of a file that only its hash can tell from what it was."""
    if item.stored is not None or not is_of(entry, job, item) or ("failed" in again and entry["kind"]):
        return None
    try:
        return entry if signature_of(item)["bytes"] == entry["signature"]["bytes"] else None
    except (OSError, KeyError):
        return None


def stored_atlases(inputs: "Dict[str, None]") -> Dict[str, Dict[str, Any]]:
    """What stores tell of their atlases, by input, without reading them."""
    stores = {input.rpartition("#")[0]: None for input in inputs if "#" in input and not os.path.exists(input)}
    listed = slamdb.list_atlases(*stores)["atlases"] if stores else []
    return {each["input"]: {"hash": each["hash"], "bytes": each["bytes"]} for each in listed if "hash" in each}


def outputs_of(inputs: Iterable[str], folder: str, suffix: str) -> Dict[str, str]:
    """The folder, and the path by which each was named, so that none depends on what else is there.

    Where that is still the same, as of map.osa and map.osa.txt, the later ones get a number.
    """
    outputs: Dict[str, str] = {}
    taken: Set[str] = set()
    for input in inputs:
        stem = os.path.join(folder, *_parts_of(input))
        output = stem + suffix
        number = 2
        while output.casefold() in taken:  # some file systems do not know capitals
            output = f"{stem}-{number}{suffix}"
            number += 1
        taken.add(output.casefold())
        outputs[input] = output
    return outputs


def _parts_of(input: str) -> List[str]:
    path, hash, name = input.rpartition("#") if not os.path.exists(input) else ("", "", input)
    folders = os.path.normpath(path if hash else input).split(os.sep)
    if hash:
        folders.append(name)
    else:
        folders[-1] = _without_suffix(folders[-1])
    return [_safe(part) for part in folders if part]


def _without_suffix(name: str) -> str:
    for suffix in (".osa.txt", os.path.splitext(name)[1]):
        if suffix and name.endswith(suffix) and name != suffix:
            return name[: -len(suffix)]
    return name


def _safe(part: str) -> str:
    quoted = urllib.parse.quote(part, safe=" ", errors="surrogateescape")
    return "%2E" + quoted[1:] if quoted.startswith(".") else quoted


def chunks_of(plan: Plan, size: int, run: str) -> List[Chunk]:
    """All atlases, `size` at a time; what is done of each is left out. So a chunk is the same whatever is done."""
    chunks = []
    for begin in range(0, len(plan.items), size):
        items = plan.items[begin : begin + size]
        inputs = "\0".join(item.input for item in items).encode(errors="surrogateescape")
        left = [item for item in items if item.input not in plan.done]
        chunks.append(Chunk(hashlib.sha256(inputs).hexdigest()[:16], run, left))
    return chunks


def refuse_inputs_below(folder: pathlib.Path, items: Sequence[Item]) -> None:
    """Outputs of one run would be inputs of the next."""
    root = os.path.realpath(folder)
    for item in items:
        path = os.path.realpath(item.input if os.path.exists(item.input) else item.input.rpartition("#")[0])
        if os.path.commonpath([root, path]) == root:
            raise slamdb.UsageError(f"lies in {folder}, which is for outputs: name another folder with -o", item.input)
