// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/model/atlas.h"

// The parts that HashOf (digest.h) is made of: the hashes of entities, which a store keeps beside its rows. They tell
// on save what changed, and on load what is damaged. They are of what is recorded, not of how a store lays it out.
namespace slamdb::detail {

std::int64_t HashOfAtlasHeader(const Atlas& atlas, const ArchiveEncoding& encoding);  // all but maps and cameras
std::int64_t HashOf(const Camera& camera);
std::int64_t HashOfHeader(const Map& map);              // all but keyframes, points and landmarks
std::int64_t HashOfRow(const KeyFrame& keyframe);       // all but the two below
std::int64_t HashOfLinks(const KeyFrame& keyframe);     // connections, children, loop and merge edges
std::int64_t HashOfFeatures(const KeyFrame& keyframe);  // the features without their counts
std::int64_t HashOfRow(const MapPoint& point);          // all but the observations
std::int64_t HashOf(const Column<Observation>& observations);
std::int64_t HashOf(const Landmark& landmark);

// The hashes of everything in an atlas, in its order; their hash is that of the atlas.
struct AtlasHashes {
  std::int64_t header = 0;
  std::vector<std::int64_t> cameras;
  struct OfMap {
    std::int64_t header = 0;
    std::vector<std::int64_t> keyframes, links, features;  // one each for every keyframe
    std::vector<std::int64_t> points, observations;        // one each for every point
    std::vector<std::int64_t> landmarks;
  };
  std::vector<OfMap> maps;

  std::int64_t Combined() const;
};
AtlasHashes HashesOf(const Atlas& atlas, int threads);

}  // namespace slamdb::detail
