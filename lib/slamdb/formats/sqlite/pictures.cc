// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/pictures.h"

#include <algorithm>

#include "slamdb/base/detail/hash.h"
#include "slamdb/formats/rows/detail/features_blob.h"

namespace slamdb::sqlite {
namespace {

std::vector<std::int64_t> KeyframesWithFeatures(Database& database) {
  return Statement(database, "SELECT keyframe FROM keyframe_features ORDER BY keyframe", "table keyframe_features")
      .Integers();
}

}  // namespace

std::int64_t HashOfPicture(Bytes columns) { return static_cast<std::int64_t>(detail::HashBytes(columns)); }

PictureWriter::PictureWriter(Database& database)
    : find_(database, "SELECT row, columns FROM picture WHERE hash = ?1 ORDER BY row", "table picture"),
      insert_(database, "INSERT INTO picture (hash, columns) VALUES (?1, ?2) RETURNING row", "table picture") {}

std::int64_t PictureWriter::RowOf(Bytes columns, std::int64_t hash) {
  find_.Reset();
  find_.Bind(1, hash);
  while (find_.Step())  // of those with its hash, which others may have too
    if (std::ranges::equal(find_.Blob(1), columns)) return find_.Integer(0);
  insert_.Reset();
  insert_.Bind(1, hash).BindBlob(2, columns).Step();
  const std::int64_t row = insert_.Integer(0);
  insert_.Run();
  return row;
}

std::vector<std::int64_t> PicturesOf(Database& database, std::int64_t atlas) {
  Statement select(database,
                   "SELECT picture FROM map JOIN keyframe_features ON keyframe BETWEEN map.row << 32 AND "
                   "(map.row << 32) + 4294967295 WHERE map.atlas = ?1 "
                   "UNION SELECT picture FROM past WHERE atlas = ?1 AND picture IS NOT NULL ORDER BY picture",
                   "table picture");
  return select.Bind(1, atlas).Integers();
}

std::uint64_t DeleteUnused(Database& database, std::span<const std::int64_t> pictures) {
  Statement remove(
      database,
      "DELETE FROM picture WHERE row = ?1 AND NOT EXISTS (SELECT 1 FROM keyframe_features WHERE picture = ?1) "
      "AND NOT EXISTS (SELECT 1 FROM past WHERE picture = ?1)",
      "table picture");
  std::uint64_t deleted = 0;
  for (const std::int64_t picture : pictures) {
    remove.Bind(1, picture).Run();
    deleted += static_cast<std::uint64_t>(sqlite3_changes(database.handle()));
  }
  return deleted;
}

void SplitAllFeatures(Database& database) {
  PictureWriter pictures(database);
  Statement select(database, "SELECT points FROM keyframe_features WHERE keyframe = ?1", "table keyframe_features");
  Statement update(database, "UPDATE keyframe_features SET points = ?2, picture = ?3 WHERE keyframe = ?1",
                   "table keyframe_features");
  for (const std::int64_t row : KeyframesWithFeatures(database)) {
    select.Reset();
    select.Bind(1, row).Step();
    const Bytes whole = select.Blob(0);
    const std::string copy(reinterpret_cast<const char*>(whole.data()), whole.size());
    select.Reset();
    const rows::SplitFeatures split = rows::Split(std::as_bytes(std::span(copy)));
    const Bytes picture = std::as_bytes(std::span(split.picture));
    update.Bind(1, row).BindBlob(2, split.points).Bind(3, pictures.RowOf(picture, HashOfPicture(picture))).Run();
  }
}

void JoinAllFeatures(Database& database) {
  Statement select(
      database,
      "SELECT columns, points FROM keyframe_features JOIN picture ON picture.row = picture WHERE keyframe = ?1",
      "table keyframe_features");
  Statement update(database, "UPDATE keyframe_features SET points = ?2 WHERE keyframe = ?1", "table keyframe_features");
  for (const std::int64_t row : KeyframesWithFeatures(database)) {
    select.Reset();
    if (!select.Bind(1, row).Step()) continue;  // its picture is gone: loading says so, before and after
    const std::string whole = rows::Join(select.Blob(0), select.Blob(1));
    select.Reset();
    update.Bind(1, row).BindBlob(2, std::as_bytes(std::span(whole))).Run();
  }
}

}  // namespace slamdb::sqlite
