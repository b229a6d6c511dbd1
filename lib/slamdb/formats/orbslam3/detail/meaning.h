// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/formats/layouts/detail/inference.h"
#include "slamdb/formats/orbslam3/detail/fork_program.h"

namespace slamdb::orbslam3 {

// What speaks against an atlas that was read in a layout: whether points lie where keyframes see them, ids refer to
// each other, times rise. A sample of the points is looked at. What cannot
// be asked, as the layout lacks it, weighs less than what is wrong.
layouts::Meaning MeaningOf(const Atlas& atlas, const ForkProgram& program);

// Members that no map is without, of those that the layout lacks: `no member is KeyFrame.mTcw: all keyframes are at the
// origin`.
std::vector<std::string> DoubtsOfMissing(const ForkProgram& program);

// What is said where times, or poses and positions, of a whole atlas are nearly all such as no map has; empty as a
// rule.
std::string DoubtOfPoses(const Atlas& atlas);

}  // namespace slamdb::orbslam3
