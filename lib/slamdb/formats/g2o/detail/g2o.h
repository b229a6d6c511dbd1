// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/model/keyframe_pose.h"

namespace slamdb::detail {

// Pose graphs as text of g2o: keyframes, and edges with how surely they are known. See schema/g2o.md.
extern const Format kG2oFormat;

bool SniffG2o(const Probe& probe);
// A map for each vertex that is fixed, of what edges lead to from there; the rest belongs to the first.
Atlas ReadG2o(const Source& source, const ReadOptions& options, Notices& notices);
std::vector<KeyFramePose> ReadG2oPoses(const Source& source, Notices& notices);

}  // namespace slamdb::detail
