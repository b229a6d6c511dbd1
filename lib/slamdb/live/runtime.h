// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "slamdb/live/change_gate.h"
#include "slamdb/live/listed.h"

// Locks of the live classes, in the order in which a thread may take them (a thread that holds one takes only later
// ones, and never a second one of its rank). Methods take what they need themselves.
//   1. Change (change_gate.h)                 around everything that changes something
//   2. Map::mMutexMapUpdate                   clients: one at a time rewrites poses and points of a map
//   3. Map::mMutexPointCreation               clients: as in ORB-SLAM3; ids are atomic and do not need it
//   4. Runtime::global_mutex                  positions of all points: SetWorldPos takes it, optimisers that read many
//   5. features of a point or keyframe        observations, descriptor, counters; feature slots
//   6. connections of a keyframe              covisibility, spanning tree, edges
//   7. position of a point, pose of a keyframe
//   8. lists of the atlas
//   9. lists and numbers of a map
namespace slamdb::live {

class KeyFrame;
class MapPoint;

// Hands out ids of one kind. Thread-safe.
class IdCounter {
 public:
  // Not below what is in use already.
  std::uint64_t Next() {
    std::uint64_t next = next_.load(std::memory_order_relaxed);
    std::uint64_t id = next;
    do {
      id = next < floor_ ? floor_ : next;
    } while (!next_.compare_exchange_weak(next, id + 1, std::memory_order_relaxed));
    return id;
  }
  // Never hands out this one, nor any below.
  void Pass(std::uint64_t id) {
    std::uint64_t next = next_.load(std::memory_order_relaxed);
    while (next <= id && !next_.compare_exchange_weak(next, id + 1, std::memory_order_relaxed)) {
    }
  }
  std::uint64_t recorded() const { return next_.load(std::memory_order_relaxed); }

  // Before other threads use it: as a file says, which may be too low for the ids that the file holds.
  void Set(std::uint64_t next, std::uint64_t floor) {
    next_.store(next, std::memory_order_relaxed);
    floor_ = floor;
  }

 private:
  std::atomic<std::uint64_t> next_ = 0;
  std::uint64_t floor_ = 0;
};

// What all objects of one live atlas share. What ORB-SLAM3 keeps in static members is here, so that two atlases live in
// one process.
struct Runtime {
  ChangeGate gate;
  std::mutex global_mutex;  // ORB-SLAM3: MapPoint::mGlobalMutex
  IdCounter map_ids, frame_ids, keyframe_ids, point_ids, camera_ids;
  ChangeLog<KeyFrame> changed_keyframes;
  ChangeLog<MapPoint> changed_points;
};

}  // namespace slamdb::live
