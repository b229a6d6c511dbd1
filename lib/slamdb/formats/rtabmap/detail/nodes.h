// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/rtabmap/detail/blobs.h"
#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/model/geodetic.h"

namespace slamdb::rtabmap {

// A place of the graph. Poses are of the robot's base.
struct Node {
  std::uint64_t id = 0;
  std::uint32_t session = 0;  // map_id
  double stamp = 0;           // seconds
  std::optional<Pose> odometry, optimized, truth;
  std::optional<GpsFix> gps;
  std::vector<NodeCamera> cameras;  // of its picture; none: it has no picture, or no camera that is calibrated
};

// What RTAB-Map calls its links by, as far as an atlas has a place for them.
struct Link {
  static constexpr std::int64_t kNeighbor = 0, kFirstClosure = 1, kLastClosure = 4, kMergedNeighbor = 6;
  std::uint64_t from = 0, to = 0;
  std::int64_t type = 0;

  bool is_closure() const { return type >= kFirstClosure && type <= kLastClosure; }
  bool is_neighbor() const { return type == kNeighbor || type == kMergedNeighbor; }
  friend auto operator<=>(const Link&, const Link&) = default;
};

struct Graph {
  Version version;
  std::vector<Node> nodes;        // by id, each id once
  std::vector<Link> links;        // sorted, `from` lower, each once
  std::uint64_t other_links = 0;  // priors, landmarks, gravity, virtual ones
  std::uint64_t lost_nodes = 0;   // whose id no node of RTAB-Map has, or another has too
  double scale_factor = 1.2;      // of the pyramid: what the parameters of ORB say
};

// Throws Error: kUnsupported before RTAB-Map 0.11, kDamaged with table and row.
Graph ReadGraph(sqlite::Database& database, const ReadOptions& options);

}  // namespace slamdb::rtabmap
