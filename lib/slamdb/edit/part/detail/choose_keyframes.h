// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "slamdb/edit/part/detail/finding.h"
#include "slamdb/edit/part/detail/remains.h"

namespace slamdb::detail {

// Takes keyframes away, one by one, until what remains keeps to its budget: next goes the one without which finding
// loses least, for each byte where bytes are asked for. Then those go, too, without which more is found. Where bytes
// are asked for and the budget is lean, points that a single place shows go first (Finding::ShownOnce). Throws Error
// (kNotPossible) when the budget leaves no room for a single good keyframe, or there is none. Cost: about that of
// measuring the loss of every keyframe some twenty times.
void ChooseKeyFrames(Remains& remains, Finding& finding);

}  // namespace slamdb::detail
