// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/edit/part/shrink.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// Shrink, by what is found again: each keyframe is left out in turn, and the choice counts the points that its picture
// shows of what the others know. Says in ShrinkReport::found how well places are found before and after: at most a
// hundred keyframes, at equal steps, located by their own features as if the map had never had them. Where nothing has
// to be chosen nobody looks.
//
// Throws Error as Shrink does. Reads options.threads and options.progress; options.looks is its own.
// Cost: Shrink, and Locator::Locate twice for each of those places; the result is the same for any number of threads.
SLAMDB_EXPORT ShrinkReport ShrinkForLocating(Atlas& atlas, ShrinkOptions options);

}  // namespace slamdb
