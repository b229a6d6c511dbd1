// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/features_blob.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"
#include "slamdb/model/detail/record.h"

namespace slamdb::sqlite {
namespace {

// False: the numbers in the columns are not those in `exact`.
bool ReadReals(const Statement& row, int timestamp_column, int exact_column, KeyFrame& keyframe) {
  detail::KeyframeReals reals;
  bool same = true;
  const Bytes exact = row.Blob(exact_column);
  if (!exact.empty()) {
    ByteReader in(exact);
    std::array timestamp{in.Get<double>()};
    reals = in.Get<detail::KeyframeReals>();
    in.ExpectEnd();
    same = TakeColumns(row, timestamp_column, timestamp);
    same = TakeColumns(row, timestamp_column + 1, reals) && same;
    keyframe.timestamp = timestamp[0];
  } else {
    keyframe.timestamp = row.Real(timestamp_column);
    for (std::size_t i = 0; i < reals.size(); ++i) {
      reals[i] = static_cast<float>(row.Real(timestamp_column + 1 + static_cast<int>(i)));
    }
  }
  detail::SetReals(keyframe, reals);
  return same;
}

// False: as above.
bool ReadKeyframe(const Statement& row, KeyFrame& keyframe) {
  keyframe.id = KeyFrameId(static_cast<std::uint64_t>(row.Integer(1)));
  keyframe.frame_id = static_cast<std::uint64_t>(row.Integer(4));
  const bool same = ReadReals(row, 5, 38, keyframe);
  keyframe.camera = FromReference<CameraId>(row, 22);
  keyframe.right_camera = FromReference<CameraId>(row, 23);
  keyframe.parent = FromReference<KeyFrameId>(row, 24);
  keyframe.previous = FromReference<KeyFrameId>(row, 25);
  keyframe.next = FromReference<KeyFrameId>(row, 26);
  keyframe.origin_map = static_cast<std::uint32_t>(row.Integer(27));
  keyframe.features.count = static_cast<std::int32_t>(row.Integer(28));
  keyframe.features.left_count = static_cast<std::int32_t>(row.Integer(29));
  keyframe.features.right_count = static_cast<std::int32_t>(row.Integer(30));
  int column = 31;
  for (Flag* flag : {&keyframe.first_connection, &keyframe.not_erase, &keyframe.to_be_erased, &keyframe.bad,
                     &keyframe.imu_initialized, &keyframe.has_velocity}) {
    flag->recorded = static_cast<std::uint8_t>(row.Integer(column++));
  }
  detail::DecodeDetails(row.Blob(37), keyframe);
  return same;
}

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
      "SELECT row, id, hash, links_hash, frame_id, timestamp, qw, qx, qy, qz, tx, ty, tz, vx, vy, vz, bias_ax, "
      "bias_ay, "
      "bias_az, bias_wx, bias_wy, bias_wz, camera, right_camera, parent, previous, next, origin_map, features, "
      "left_features, right_features, first_connection, not_erase, to_be_erased, bad, imu_initialized, has_velocity, "
      "details, exact FROM keyframe WHERE row BETWEEN ?1 AND ?2 ORDER BY row",
      "table keyframe");
  statement.Bind(1, rows.front()).Bind(2, rows.back());
  CarriedReader carried(database, CarriedKind::kKeyframe);
  carried.Start(rows.front(), rows.back());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!statement.Step() || statement.Integer(0) != rows[i]) throw DamagedRow(database, "keyframe", rows[i]);
    bool same = true;
    DecodeAt(database, "keyframe", rows[i], [&] { same = ReadKeyframe(statement, keyframes[i]); });
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
        DecodeFeatures(statement.Blob(3), statement.Blob(2), keyframes[i]);
      else
        DecodeWholeFeatures(statement.Blob(2), keyframes[i]);
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
