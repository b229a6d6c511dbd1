// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/selection.h"

// The part of an atlas that was asked for, once it is read.
namespace slamdb::cli {

// Throws Error where nothing of the atlas is in the part that was asked for. `name` is that of the input.
void RefuseEmptySelection(const Atlas& atlas, const std::string& name, const HeldSource& input,
                          const ReadOptions& read);

// The part that is to be looked at: of ranges of keyframes and times with the points that those keyframes observe.
// Throws Error as ReadAtlas does, and where nothing is in the part.
Atlas ReadPartToShow(const std::string& name, const HeldSource& input, const ReadOptions& read, Notices& notices);

}  // namespace slamdb::cli
