// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/formats/rtabmap/detail/nodes.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

namespace slamdb::rtabmap {

// A keyframe in the making: one camera of one node.
struct Shot {
  const Node* node = nullptr;
  std::uint32_t camera = 0, map = 0;  // row of Node::cameras, and of the maps
  KeyFrame keyframe;
  // Of each keypoint.
  std::vector<std::int32_t> words;      // <= 0: of none
  std::vector<Eigen::Vector3f> places;  // in the camera's frame, metres; not finite: no depth
};

// The shots of the nodes, whose rows follow each other.
struct Shots {
  std::vector<Shot> list;
  IdTable first_of_node;  // node id -> row of its first shot

  // Which shot of its node a keypoint of a picture is in, and where: pictures of several cameras stand side by side.
  // kNoRow: of no node that has one.
  std::uint32_t Find(std::uint64_t node, float& x) const;
};

// What follows from the distance of the two cameras, metres; 0: there is one.
void SetBaseline(KeyFrame& keyframe, float baseline);

struct FeatureCounts {
  std::uint64_t without_node = 0;
  std::uint64_t other_descriptors = 0;  // of another kind than those of their picture
  std::uint64_t by_word = 0;            // whose descriptor is that of their word
  std::int32_t highest_word = 0;
};

// Fills keypoints, descriptors, depth, words and places. One pass over the table, in its order.
//
// Throws Error: kDamaged with table and row.
FeatureCounts ReadFeatures(sqlite::Database& database, Shots& shots, double scale_factor, const ReadOptions& options);

struct PointCounts {
  std::uint64_t words_without_place = 0;  // no feature of it has depth
  std::uint64_t loose = 0;                // features with a word whose point they do not see
};

// A point for each word that keyframes see in one place, and further ones where look-alikes share a word: the median of
// the places that agree. Sets which keypoint sees it.
PointCounts MakePoints(Shots& shots, std::int32_t highest_word, std::vector<Map>& maps);

}  // namespace slamdb::rtabmap
