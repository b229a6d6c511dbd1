// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/model/camera.h"
#include "slamdb/model/keyframe.h"
#include "slamdb/model/landmark.h"
#include "slamdb/model/map_point.h"

namespace slamdb {

// An irregular entry of a list of an .osa file, which holds pointers.
// At `position` of the list stands
//   a null pointer: `owner_map` is kNull
//   or once more an object that is already stored: row `row` of the same kind of list in map `owner_map`
// Maps are rows of Atlas::maps; for the lists of the atlas itself owner_map is 0.
// Healthy files have none.
struct RepeatedEntry {
  static constexpr std::uint32_t kNull = ~std::uint32_t{0};
  std::uint64_t position = 0;
  std::uint32_t owner_map = kNull;
  std::uint64_t row = 0;
  friend bool operator==(const RepeatedEntry&, const RepeatedEntry&) = default;
};

// Keyframes and map points in one world frame. ORB-SLAM3: Map, its name at the right.
struct Map {
  MapId id;                                       //                                        mnId
  KeyFrameId initial_keyframe;                    // fixed in bundle adjustment             mnInitKFid
  std::uint64_t max_keyframe_id = 0;              // largest keyframe id ever added         mnMaxKFid
  std::int32_t big_change_index = 0;              // loop closures and the like             mnBigChangeIdx
  Column<KeyFrame> keyframes;                     // in the file's order                    mvpBackupKeyFrames
  Column<MapPoint> points;                        // in the file's order                    mvpBackupMapPoints
  std::vector<RepeatedEntry> repeated_keyframes;  // irregular entries of the two lists, ascending position
  std::vector<RepeatedEntry> repeated_points;
  std::vector<Landmark> landmarks;                   // in the frame of this map; no .osa file holds them
  std::vector<KeyFrameId> origins;                   // roots for global bundle adjustment     mvBackupKeyFrameOriginsId
  KeyFrameId first_keyframe;                         // root of the spanning tree              mnBackupKFinitialID
  KeyFrameId lowest_keyframe;                        // smallest id                            mnBackupKFlowerID
  Flag imu_initialized, inertial, imu_ba1, imu_ba2;  // mbImuInitialized, mbIsInertial, mbIMU_BA1, mbIMU_BA2
  Boxed<Carried> carried;                            // of a fork's file; null as a rule
};

// The next id that ORB-SLAM3 hands out of each kind.
struct Counters {
  std::uint64_t map = 0;               // Map::nNextId
  std::uint64_t frame = 0;             // Frame::nNextId
  std::uint64_t keyframe = 0;          // KeyFrame::nNextId
  std::uint64_t map_point = 0;         // MapPoint::nNextId
  std::uint64_t camera = 0;            // GeometricCamera::nNextId
  std::uint64_t initial_keyframe = 0;  // of the next new map: Atlas::mnLastInitKFidMap
  friend bool operator==(const Counters&, const Counters&) = default;
};

// The vocabulary that bags of words refer to.
// ORB-SLAM3 refuses an atlas whose checksum is not its vocabulary's.
struct Vocabulary {
  std::string name;      // file name without folder
  std::string checksum;  // MD5 of the file, 32 lower-case hex digits
  friend bool operator==(const Vocabulary&, const Vocabulary&) = default;
};

// How the .osa file that an atlas was read from is written down; what writing it again keeps by default.
struct ArchiveEncoding {
  bool text = false;                 // Boost text archive instead of binary
  std::uint32_t boost_version = 12;  // library version of Boost.Serialization. New files: 12 loads in Boost >= 1.58
  std::uint8_t long_bytes = 8;       // sizeof(long) of the writer: 4 on Windows and 32-bit systems
  std::uint8_t size_bytes = 8;       // sizeof(size_t) of the writer: 4 on 32-bit systems
  friend bool operator==(const ArchiveEncoding&, const ArchiveEncoding&) = default;
};

// What one ORB-SLAM3 atlas file holds.
// A value: copying copies everything, and nothing in it refers to memory elsewhere.
//
// Safe to read from many threads at once.
struct Atlas {
  Vocabulary vocabulary;
  std::vector<Map> maps;                     // by id; each a world frame of its own
  std::vector<RepeatedEntry> repeated_maps;  // an atlas that was saved twice lists each map again
  std::vector<Camera> cameras;               // mvpCameras
  std::vector<RepeatedEntry> repeated_cameras;
  Counters next_ids;
  ArchiveEncoding encoding;
  // The layout of the fork's file that it was read from, which says what `carried` means: the id of a known one, or
  // its JSON (formats/layouts/layout.h). Empty: ORB-SLAM3 v1.0.
  std::string layout;
  Boxed<Carried> carried;  // of the atlas itself
};

}  // namespace slamdb
