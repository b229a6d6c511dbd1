// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "slamdb/align/align.h"
#include "slamdb/align/detail/common_words.h"
#include "slamdb/align/detail/local_map.h"
#include "slamdb/align/detail/map_views.h"
#include "slamdb/align/place_index.h"

namespace slamdb::detail {

// A map with all that the search for places in it needs, made once for every pair that it is in.
struct PreparedMap {
  const MapViews& views;
  std::span<const BagOfWords* const> bags;         // by view
  NodeTable nodes;                                 // of keypoints
  std::vector<std::vector<std::uint32_t>> groups;  // CovisibilityGroups
  PlaceIndex index;
};

// Some maps in one vocabulary. Refers to their atlases.
class PreparedMaps {
 public:
  PreparedMaps(std::span<const MapRef> maps, const AlignOptions& options);
  // Without words: places are known already, and neither bags nor nodes nor indexes have any.
  static PreparedMaps WithoutWords(std::span<const MapRef> maps, int threads);

  const PreparedMap& operator[](std::size_t row) const { return maps_[row]; }
  std::size_t size() const { return maps_.size(); }
  bool trained_words() const { return words_.trained(); }
  const VocabularyTree& trained_tree() const { return words_.trained_tree(); }

 private:
  enum class Recognition { kByWords, kNone };
  PreparedMaps(std::span<const MapRef> maps, const AlignOptions& options, Recognition recognition);

  std::deque<MapViews> views_;
  CommonWords words_;
  std::deque<PreparedMap> maps_;
};

}  // namespace slamdb::detail
