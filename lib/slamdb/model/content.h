// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// How much there is of everything, for proofs that nothing was lost.
struct SLAMDB_EXPORT ContentCounts {
  std::uint64_t maps = 0, cameras = 0, keyframes = 0, points = 0;
  std::uint64_t features = 0;      // rows of all keyframes
  std::uint64_t observations = 0;  // of points by keyframes
  std::uint64_t slots = 0;         // keypoints that see a point
  std::uint64_t connections = 0;   // covisibility, each direction
  std::uint64_t parents = 0, children = 0, loop_edges = 0, merge_edges = 0;
  std::uint64_t temporal_links = 0;  // previous and next
  std::uint64_t references = 0;      // reference keyframes of points
  std::uint64_t landmarks = 0;

  ContentCounts& operator+=(const ContentCounts& other);
  ContentCounts& operator-=(const ContentCounts& other);
  friend bool operator==(const ContentCounts&, const ContentCounts&) = default;
};

// Counts what is there.
//
// Cost: linear. `threads` 0: every core.
SLAMDB_EXPORT ContentCounts CountContent(const Map& map, int threads = 0);
SLAMDB_EXPORT ContentCounts CountContent(const Atlas& atlas, int threads = 0);

// What there is some of: the one measure of whether an atlas is one of nothing.
struct SLAMDB_EXPORT Substance {
  bool maps = false, keyframes = false, points = false, landmarks = false;

  // What there must be and is none of: `maps`, `keyframes` or `points`; empty for an atlas that one can localise in,
  // and for one of landmarks, which need neither.
  std::string_view Lacks() const;
  Substance& operator|=(const Substance& other);
};
// Of all, or without what is flagged bad.
SLAMDB_EXPORT Substance SubstanceOf(const Atlas& atlas, bool with_bad = false);

// A few numbers that equal maps share, cheap to compare before ContentHash.
struct ContentSignature {
  std::uint64_t keyframes = 0, points = 0, features = 0, timestamps = 0, landmarks = 0;
  friend bool operator==(const ContentSignature&, const ContentSignature&) = default;
};
SLAMDB_EXPORT ContentSignature SignatureOf(const Map& map);

// Tells whether two maps are the same map twice: a hash over
//   timestamps, camera positions, keypoints and descriptors of its keyframes
//   positions and descriptors of its points
//   positions of its landmarks
// It depends neither on ids nor on the order of the lists, which differ each time ORB-SLAM3 saves a map, nor on
// rotations, which ORB-SLAM3 normalises when it loads one.
//
// Cost: linear. `threads` 0: every core.
SLAMDB_EXPORT std::uint64_t ContentHash(const Map& map, int threads = 0);

// Of all that a landmark holds but its id.
SLAMDB_EXPORT std::uint64_t ContentHash(const Landmark& landmark);

}  // namespace slamdb
