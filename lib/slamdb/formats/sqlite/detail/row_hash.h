// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "slamdb/base/file.h"
#include "slamdb/model/atlas.h"

// Hashes of what the store's rows mean: equal content, equal hash, wherever and however it is stored. They tell on save
// what changed, and on load what is damaged.
namespace slamdb::sqlite {

// Chains hashes of byte ranges, their lengths included.
class Hasher {
 public:
  void Add(Bytes bytes);
  template <class Vector>
  void AddVector(const Vector& values) {
    Add(std::as_bytes(std::span(values.data(), values.size())));
  }
  std::int64_t value() const { return static_cast<std::int64_t>(state_); }

 private:
  std::uint64_t state_ = 0;
};

std::int64_t HashOfAtlasHeader(const Atlas& atlas);  // vocabulary, counters, encoding, repeated maps and cameras
std::int64_t HashOf(const Camera& camera);
std::int64_t HashOfHeader(const Map& map);           // all but keyframes and points
std::int64_t HashOfRow(const KeyFrame& keyframe);    // all but the two below
std::int64_t HashOfLinks(const KeyFrame& keyframe);  // connections, children, loop and merge edges
std::int64_t HashOf(const Features& features);       // all but the counts, which are in the keyframe's row
std::int64_t HashOfRow(const MapPoint& point);       // all but the observations
std::int64_t HashOf(const Column<Observation>& observations);
std::int64_t HashOf(const Landmark& landmark);

// The hashes of everything in an atlas, in its order; their hash is the atlas' content hash.
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

}  // namespace slamdb::sqlite
