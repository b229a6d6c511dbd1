// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/features_blob.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"

namespace slamdb::sqlite {
namespace {

// Runs `decode`, and says where when the bytes are damaged.
template <class Decode>
void DecodeAt(Database& database, const char* table, std::int64_t row, Decode decode) {
  try {
    decode();
  } catch (const Error& error) {
    if (!error.path().empty()) throw;
    throw Error(error.kind(), database.path(), PlaceOf(table, row), error.problem() + ": the store is damaged");
  }
}

void ReadRows(Database& database, std::span<const std::int64_t> rows, std::span<KeyFrame> keyframes,
              std::span<std::int64_t> hashes, std::span<std::int64_t> links_hashes) {
  Statement statement(
      database,
      detail::Concat("SELECT ", rows::kKeyframeColumns, " FROM keyframe WHERE row BETWEEN ?1 AND ?2 ORDER BY row"),
      "table keyframe");
  statement.Bind(1, rows.front()).Bind(2, rows.back());
  CarriedReader carried(database, CarriedKind::kKeyframe);
  carried.Start(rows.front(), rows.back());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!statement.Step() || statement.Integer(0) != rows[i]) throw DamagedRow(database, "keyframe", rows[i]);
    bool same = true;
    DecodeAt(database, "keyframe", rows[i], [&] { same = rows::ReadKeyframe(statement, keyframes[i]); });
    carried.Read(rows[i], keyframes[i].carried);
    hashes[i] = detail::HashOfRow(keyframes[i]);
    links_hashes[i] = statement.Integer(3);
    RequireSame(database, "keyframe", rows[i], keyframes[i].id.value(), same && hashes[i] == statement.Integer(2));
  }
}

void ReadLinks(Database& database, std::span<const std::int64_t> rows, std::span<KeyFrame> keyframes,
               std::span<const std::int64_t> links_hashes) {
  Statement statement(database,
                      "SELECT slamdb_visit(?1, keyframe, kind, target, weight) FROM keyframe_link "
                      "INDEXED BY sqlite_autoindex_keyframe_link_1 WHERE keyframe BETWEEN ?2 AND ?3",
                      "table keyframe_link");
  statement.Bind(2, rows.front()).Bind(3, rows.back());
  VisitRows(statement, [&](const Row& row) {
    const auto place = static_cast<std::uint64_t>(row.Integer(0) - rows.front());
    if (place >= keyframes.size()) return;  // an index that is damaged
    KeyFrame& keyframe = keyframes[place];
    const auto target = FromReference<KeyFrameId>(row, 2);
    const std::string_view kind = row.Text(1);
    if (kind == "covisible") {
      keyframe.connections.push_back({target, static_cast<std::int32_t>(row.Integer(3))});
    } else if (kind == "child") {
      keyframe.children.push_back(target);
    } else if (kind == "loop") {
      keyframe.loop_edges.push_back(target);
    } else {
      keyframe.merge_edges.push_back(target);
    }
  });
  for (std::size_t i = 0; i < rows.size(); ++i)
    RequireSame(database, "keyframe_link", rows[i], keyframes[i].id.value(),
                detail::HashOfLinks(keyframes[i]) == links_hashes[i]);
}

void ReadFeatures(Database& database, std::span<const std::int64_t> rows, std::span<KeyFrame> keyframes,
                  std::span<std::int64_t> hashes) {
  const bool has_pictures = VersionOf(database) >= kFirstVersionWithRevisions;  // what is salvaged may be older
  Statement statement(database,
                      has_pictures ? "SELECT keyframe, keyframe_features.hash, points, columns FROM keyframe_features "
                                     "LEFT JOIN picture ON picture.row = picture WHERE keyframe BETWEEN ?1 AND ?2 "
                                     "ORDER BY keyframe"
                                   : "SELECT keyframe, hash, columns FROM keyframe_features WHERE keyframe BETWEEN ?1 "
                                     "AND ?2 ORDER BY keyframe",
                      "table keyframe_features");
  statement.Bind(1, rows.front()).Bind(2, rows.back());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!statement.Step() || statement.Integer(0) != rows[i]) throw DamagedRow(database, "keyframe_features", rows[i]);
    DecodeAt(database, "keyframe_features", rows[i], [&] {
      if (has_pictures)
        rows::DecodeFeatures(statement.Blob(3), statement.Blob(2), keyframes[i]);
      else
        rows::DecodeWholeFeatures(statement.Blob(2), keyframes[i]);
    });
    hashes[i] = detail::HashOfFeatures(keyframes[i]);
    RequireSame(database, "keyframe_features", rows[i], keyframes[i].id.value(), hashes[i] == statement.Integer(1));
  }
}

}  // namespace

void LoadKeyframes(Database& database, std::span<const std::int64_t> rows, KeyframeParts parts,
                   std::span<KeyFrame> keyframes, std::span<std::int64_t> hashes, std::span<std::int64_t> links_hashes,
                   std::span<std::int64_t> features_hashes) {
  ForEachRun(rows, [&](std::size_t first, std::size_t count) {
    const auto run = rows.subspan(first, count);
    const auto frames = keyframes.subspan(first, count);
    ReadRows(database, run, frames, hashes.subspan(first, count), links_hashes.subspan(first, count));
    if (parts.links) ReadLinks(database, run, frames, links_hashes.subspan(first, count));
    if (parts.features) ReadFeatures(database, run, frames, features_hashes.subspan(first, count));
  });
}

}  // namespace slamdb::sqlite
