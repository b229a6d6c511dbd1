// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/place_words.h"

#include <algorithm>

#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/model/picture_features.h"

namespace slamdb::sqlite {
namespace {

// A row of keyframe_words as it is stored.
struct StoredWords {
  std::int64_t row = 0, hash = 0;
};

std::vector<StoredWords> ReadStored(Database& database, std::int64_t map) {
  Statement statement(database,
                      "SELECT keyframe, hash, length(words) FROM keyframe_words WHERE keyframe BETWEEN ?1 AND ?2 "
                      "ORDER BY keyframe",
                      "table keyframe_words");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  std::vector<StoredWords> stored;
  while (statement.Step())
    if (statement.Integer(2) == sizeof(PlaceWords)) stored.push_back({statement.Integer(0), statement.Integer(1)});
  return stored;
}

class Writer {
 public:
  explicit Writer(Database& database)
      : insert_(database, "INSERT OR REPLACE INTO keyframe_words VALUES (?1, ?2, ?3)", "table keyframe_words") {}
  void Write(std::int64_t row, std::int64_t hash, const PlaceWords& words) {
    insert_.Bind(1, row).Bind(2, hash).BindBlob(3, std::as_bytes(std::span(words))).Run();
  }

 private:
  Statement insert_;
};

void RemoveOthers(Database& database, std::span<const StoredWords> stored, std::vector<std::int64_t> rows) {
  std::ranges::sort(rows);
  Statement remove(database, "DELETE FROM keyframe_words WHERE keyframe = ?1", "table keyframe_words");
  for (const StoredWords& each : stored)
    if (!std::ranges::binary_search(rows, each.row)) remove.Bind(1, each.row).Run();
}

void RebuildMap(Database& database, std::int64_t map) {
  Statement statement(database, "SELECT row FROM keyframe WHERE row BETWEEN ?1 AND ?2 ORDER BY row", "table keyframe");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  Writer writer(database);
  while (statement.Step()) {
    const std::int64_t row = statement.Integer(0);
    KeyFrame keyframe;
    std::int64_t hash = 0, links_hash = 0, features_hash = 0;
    try {
      LoadKeyframes(database, std::span(&row, 1), {.links = false}, std::span(&keyframe, 1), std::span(&hash, 1),
                    std::span(&links_hash, 1), std::span(&features_hash, 1));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
      continue;
    }
    writer.Write(row, features_hash, PlaceWordsOf(LeftDescriptors(keyframe.features)));
  }
}

}  // namespace

bool HasAllPlaceWords(Database& database, std::int64_t map_row, std::span<const std::int64_t> features_hashes) {
  std::vector<std::int64_t> stored, wanted(features_hashes.begin(), features_hashes.end());
  for (const StoredWords& each : ReadStored(database, map_row)) stored.push_back(each.hash);
  std::ranges::sort(stored);
  std::ranges::sort(wanted);
  return stored == wanted;
}

void SavePlaceWords(SaveContext& context, std::int64_t map_row, const Map& map, std::span<const std::int64_t> rows,
                    std::span<const std::int64_t> features_hashes) {
  const std::vector<StoredWords> stored = ReadStored(context.database, map_row);
  RemoveOthers(context.database, stored, {rows.begin(), rows.end()});
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto old = std::ranges::lower_bound(stored, rows[i], {}, &StoredWords::row);
    if (old == stored.end() || old->row != rows[i] || old->hash != features_hashes[i]) changed.push_back(i);
  }
  const std::vector<PlaceWords> words = rows::PlaceWordsOf(map, changed, context.options.threads);
  Writer writer(context.database);
  for (std::size_t i = 0; i < changed.size(); ++i)
    writer.Write(rows[changed[i]], features_hashes[changed[i]], words[i]);
}

void RebuildPlaceWords(Database& database) {
  database.Execute("DELETE FROM keyframe_words");
  for (const std::int64_t map : Statement(database, "SELECT row FROM map ORDER BY row", "table map").Integers())
    RebuildMap(database, map);
}

}  // namespace slamdb::sqlite
