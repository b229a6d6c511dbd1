// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include "slamdb/base/notices.h"
#include "slamdb/formats/format.h"

namespace slamdb::python {

// What a run had to say: [(kind, text)], of the kinds loss, warning and note.
pybind11::list ListOf(const Notices& notices);

class Arguments;
class HeldAtlas;
struct AtlasOrPath;

// map, keyframes, time, box, format, layout, wait, threads, progress: how a source that is a path, or bytes, is read.
ReadOptions ReadingOf(Arguments& given);

// Of what was read by that selection: marked as a part where it is one.
std::shared_ptr<HeldAtlas> MarkedAtlas(Atlas atlas, Selection selection);

// Of an atlas that was read in part and is to be written as if it were whole: loses the rest, or refuses it.
//
// Throws Error (kNotPossible) where `strict`.
void LoseRest(const HeldAtlas& atlas, const Format& format, bool strict, Notices& notices);

// An atlas in memory as it is; what a path leads to, read.
std::shared_ptr<const Atlas> Hold(const AtlasOrPath& source, const ReadOptions& read, Notices& notices);

// Throws Error (kUsage) where a part is asked for of what is in memory, which is whole.
void RefuseIdleSelection(const AtlasOrPath& source, const ReadOptions& read);

}  // namespace slamdb::python
