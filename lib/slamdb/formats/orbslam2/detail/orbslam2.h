// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Maps of ORB-SLAM2 as its BoostArchiver saves them (orb_slam_2_ros and relatives). See schema/orbslam2.md.
extern const Format kOrbslam2Format;

}  // namespace slamdb::detail
