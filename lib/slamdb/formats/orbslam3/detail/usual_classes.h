// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/formats/orbslam3/detail/class_table.h"

// What the class table is where the objects that met the classes cannot be read: as ORB-SLAM3 usually has it.
namespace slamdb::orbslam3 {

// What it may be behind an object that could not be read: all classes of a first keyframe, and those of IMU
// measurements when it had any.
std::vector<ClassTable> TablesBehind(ClassTable classes, WireClass wire_class);

// In front of the keyframes of the first map.
ClassTable TableOfFirstMap(const ArchiveEncoding& encoding);

}  // namespace slamdb::orbslam3
