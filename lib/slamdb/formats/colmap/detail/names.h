// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "slamdb/formats/colmap/detail/outline.h"

namespace slamdb::colmap {

// Gives each view of an outline a name of its own: of the picture file that is nearest in time, or else
// `1403636579.763555.png`, in the folders `left` and `right` for a pair. Where two would have the same, the second is
// in a folder with the number of its image.
//
// Throws Error (kUsage) when pictures were named and no time is known of any, or none is near in time to a keyframe.
void NameImages(Outline& outline, const KeyFramePictures& pictures);

// The time in a name, in seconds, as NameImages writes it and datasets do: the file's name without suffix, a number;
// whole numbers of 16 digits or more are nanoseconds.
std::optional<double> TimeInName(std::string_view name);

}  // namespace slamdb::colmap
