// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"

namespace slamdb::sqlite {
namespace {

// NULL: `value` stays what it is, not recorded.
template <class Integer>
void ReadRecorded(const Statement& row, int column, Integer& value) {
  if (!row.IsNull(column)) value = static_cast<Integer>(row.Integer(column));
}

// False: the numbers in its columns are not those in `exact`.
bool ReadPoint(Database& database, const Statement& row, MapPoint& point) {
  bool same = true;
  point.id = MapPointId(static_cast<std::uint64_t>(row.Integer(1)));
  std::array<float, 8> reals;
  const Bytes exact = row.Blob(19);
  if (!exact.empty()) {
    if (exact.size() != sizeof(reals)) throw DamagedRow(database, "map_point", row.Integer(0));
    std::memcpy(reals.data(), exact.data(), sizeof(reals));
    same = TakeColumns(row, 4, reals);
  } else {
    for (std::size_t i = 0; i < reals.size(); ++i) reals[i] = static_cast<float>(row.Real(4 + static_cast<int>(i)));
  }
  point.position = {reals[0], reals[1], reals[2]};
  point.normal = {reals[3], reals[4], reals[5]};
  point.min_distance = reals[6];
  point.max_distance = reals[7];
  point.reference = FromReference<KeyFrameId>(row, 12);
  point.replaced_by = FromReference<MapPointId>(row, 13);
  point.first_keyframe = row.Integer(14);
  point.first_frame = row.Integer(15);
  point.observation_count = static_cast<std::int32_t>(row.Integer(16));
  point.bad.recorded = static_cast<std::uint8_t>(row.Integer(17));
  const Bytes descriptor = row.Blob(18);
  if (descriptor.size() != point.descriptor.size()) throw DamagedRow(database, "map_point", row.Integer(0));
  std::memcpy(point.descriptor.data(), descriptor.data(), descriptor.size());
  point.descriptor_form = static_cast<MatrixForm>(row.Integer(20) & 3);
  ReadRecorded(row, 21, point.origin_map);
  ReadRecorded(row, 22, point.visible_count);
  ReadRecorded(row, 23, point.found_count);
  return same;
}

// Reads the observations of points one after the other, in step with the points.
class ObservationReader {
 public:
  explicit ObservationReader(Database& database)
      : database_(database),
        rows_(database,
              "SELECT point, keyframe, left_keypoint, right_keypoint, position FROM observation WHERE point BETWEEN ?1 "
              "AND "
              "?2 ORDER BY point, position",
              "table observation") {}

  void Start(std::int64_t first, std::int64_t last) {
    rows_.Reset();
    has_row_ = rows_.Bind(1, first).Bind(2, last).Step();
  }
  void Read(std::int64_t point, Column<Observation>& observations) {
    scratch_.clear();
    while (has_row_ && rows_.Integer(0) == point) {
      const auto keypoint = [this](int column) {
        const std::int64_t value = rows_.Integer(column);  // 0 for NULL, too: rare enough to look twice
        return value == 0 && rows_.IsNull(column) ? Observation::kAbsent : static_cast<std::int32_t>(value);
      };
      scratch_.push_back({FromReference<KeyFrameId>(rows_, 1), keypoint(2), keypoint(3)});
      has_row_ = rows_.Step();
    }
    observations.assign(scratch_.begin(), scratch_.end());
  }
  // Observations of points that do not exist would make Read skip everything after them.
  void Finish() {
    if (has_row_) {
      throw Error(ErrorKind::kDamaged, database_.path(), PlaceOf("observation", rows_.Integer(0)),
                  "belongs to no point: the store is damaged");
    }
  }

 private:
  Database& database_;
  Statement rows_;
  bool has_row_ = false;
  std::vector<Observation> scratch_;
};

}  // namespace

void LoadPoints(Database& database, std::span<const std::int64_t> rows, std::span<MapPoint> points,
                std::span<std::int64_t> hashes, std::span<std::int64_t> observations_hashes) {
  // What is salvaged may be of an older version, which has no such columns.
  const bool has_tracking = VersionOf(database) >= kFirstVersionWithTracking;
  Statement statement(
      database,
      detail::Concat(
          "SELECT row, id, hash, observations_hash, x, y, z, nx, ny, nz, min_distance, max_distance, reference, "
          "replaced_by, first_keyframe, first_frame, observation_count, bad, descriptor, exact, descriptor_form, ",
          has_tracking ? "origin_map, visible_count, found_count " : "NULL, NULL, NULL ",
          "FROM map_point WHERE row BETWEEN ?1 AND ?2 ORDER BY row"),
      "table map_point");
  ObservationReader observations(database);
  CarriedReader carried(database, CarriedKind::kPoint);
  ForEachRun(rows, [&](std::size_t first, std::size_t count) {
    statement.Reset();
    statement.Bind(1, rows[first]).Bind(2, rows[first + count - 1]);
    observations.Start(rows[first], rows[first + count - 1]);
    carried.Start(rows[first], rows[first + count - 1]);
    for (std::size_t i = first; i < first + count; ++i) {
      if (!statement.Step() || statement.Integer(0) != rows[i]) throw DamagedRow(database, "map_point", rows[i]);
      const bool same = ReadPoint(database, statement, points[i]);
      observations.Read(rows[i], points[i].observations);
      carried.Read(rows[i], points[i].carried);
      hashes[i] = detail::HashOfRow(points[i]);
      observations_hashes[i] = detail::HashOf(points[i].observations);
      const std::uint64_t id = points[i].id.value();
      RequireSame(database, "map_point", rows[i], id, same && hashes[i] == statement.Integer(2));
      RequireSame(database, "observation", rows[i], id, observations_hashes[i] == statement.Integer(3));
    }
    observations.Finish();
  });
}

}  // namespace slamdb::sqlite
