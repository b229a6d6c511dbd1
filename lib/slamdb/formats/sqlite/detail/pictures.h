// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slamdb/formats/sqlite/detail/database.h"

// The table `picture`: what pictures gave, each content once, whoever has it.
namespace slamdb::sqlite {

std::int64_t HashOfPicture(Bytes columns);

class PictureWriter {
 public:
  explicit PictureWriter(Database& database);
  // The row that has these columns, of which HashOfPicture is `hash`; a new one where there is none.
  std::int64_t RowOf(Bytes columns, std::int64_t hash);

 private:
  Statement find_, insert_;
};

// The pictures that an atlas has, now and in revisions that can be read, ascending.
std::vector<std::int64_t> PicturesOf(Database& database, std::int64_t atlas);

// Deletes those of `pictures` that nobody has any more; returns how many.
std::uint64_t DeleteUnused(Database& database, std::span<const std::int64_t> pictures);

// The step from version 6 to 7, and back: keyframe_features.points has whole features before, and then not.
void SplitAllFeatures(Database& database);
void JoinAllFeatures(Database& database);

}  // namespace slamdb::sqlite
