// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/align/align_all.h"
#include "slamdb/align/report_json.h"
#include "slamdb/base/notices.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// The maps with keyframes of several atlases, and what to call them; and those of a store that look like them.
struct MapsToAlign {
  std::vector<std::shared_ptr<const Atlas>> atlases;  // that `maps` refers to
  std::vector<MapRef> maps;
  std::vector<MapName> names;
  std::vector<bool> metric;
  std::size_t asked = 0;  // the first ones are compared with all; those behind them, of a store, not among themselves
  std::optional<SearchedStore> store;

  // An atlas that is asked for.
  SLAMDB_EXPORT void Add(std::shared_ptr<const Atlas> atlas, const std::string& name);

  // Those of the store that are likely to overlap, but for `inputs` that are in it. What is damaged is passed over, and
  // told. Throws Error as FindLikelyMaps and Store::Load do.
  SLAMDB_EXPORT void AddLikely(Store& store, const std::vector<std::string>& inputs, const ReadOptions& read,
                               Notices& notices);

  // AlignWithOthers. Throws Error (kNotPossible) where there is nothing to compare.
  [[nodiscard]] SLAMDB_EXPORT AlignedMaps Align(const AlignOptions& options) const;

  // Whether all are in one frame; with a store, whether each that was asked for lies in some map of it.
  [[nodiscard]] SLAMDB_EXPORT bool AreSure(const AlignedMaps& aligned) const;

  [[nodiscard]] SLAMDB_EXPORT std::string ToJson(const AlignedMaps& aligned) const;
};

}  // namespace slamdb
