// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"

namespace slamdb::sqlite {
namespace {

// NULL: `value` stays what it is, not recorded.
template <class Integer>
void ReadRecorded(const Row& row, int column, Integer& value) {
  if (!row.IsNull(column)) value = static_cast<Integer>(row.Integer(column));
}

// False: the numbers in its columns are not those in `exact`.
bool ReadPoint(Database& database, const Row& row, MapPoint& point) {
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

// The observations of consecutive points.
class ObservationReader {
 public:
  explicit ObservationReader(Database& database)
      : rows_(database,
              "SELECT slamdb_visit(?1, point, keyframe, left_keypoint, right_keypoint) FROM observation "
              "INDEXED BY sqlite_autoindex_observation_1 WHERE point BETWEEN ?2 AND ?3",
              "table observation") {}

  // Reads those of all from `first` to `last`.
  void Start(std::int64_t first, std::int64_t last) {
    points_.clear();
    observations_.clear();
    next_ = 0;
    rows_.Bind(2, first).Bind(3, last);
    VisitRows(rows_, [this](const Row& row) {
      const auto keypoint = [&row](int column) {
        const std::int64_t value = row.Integer(column);  // 0 for NULL, too: rare enough to look twice
        return value == 0 && row.IsNull(column) ? Observation::kAbsent : static_cast<std::int32_t>(value);
      };
      points_.push_back(row.Integer(0));
      observations_.push_back({FromReference<KeyFrameId>(row, 1), keypoint(2), keypoint(3)});
    });
  }
  // Those of the next point.
  void Take(std::int64_t point, Column<Observation>& observations) {
    const std::size_t first = next_;
    while (next_ < points_.size() && points_[next_] == point) ++next_;
    observations.assign(observations_.data() + first, observations_.data() + next_);
  }

 private:
  Statement rows_;
  std::vector<std::int64_t> points_;  // of each of the
  std::vector<Observation> observations_;
  std::size_t next_ = 0;
};

}  // namespace

void LoadPoints(Database& database, std::span<const std::int64_t> rows, std::span<MapPoint> points,
                std::span<std::int64_t> hashes, std::span<std::int64_t> observations_hashes) {
  // What is salvaged may be of an older version, which has no such columns.
  const bool has_tracking = VersionOf(database) >= kFirstVersionWithTracking;
  Statement statement(
      database,
      detail::Concat(
          "SELECT slamdb_visit(?1, row, id, hash, observations_hash, x, y, z, nx, ny, nz, min_distance, max_distance, "
          "reference, replaced_by, first_keyframe, first_frame, observation_count, bad, descriptor, exact, "
          "descriptor_form, ",
          has_tracking ? "origin_map, visible_count, found_count" : "NULL, NULL, NULL",
          ") FROM map_point NOT INDEXED WHERE row BETWEEN ?2 AND ?3"),
      "table map_point");
  ObservationReader observations(database);
  CarriedReader carried(database, CarriedKind::kPoint);
  ForEachRun(rows, [&](std::size_t first, std::size_t count) {
    const std::size_t end = first + count;
    observations.Start(rows[first], rows[end - 1]);
    carried.Start(rows[first], rows[end - 1]);
    std::size_t i = first;
    statement.Bind(2, rows[first]).Bind(3, rows[end - 1]);
    VisitRows(statement, [&](const Row& row) {
      if (i == end || row.Integer(0) != rows[i]) throw DamagedRow(database, "map_point", rows[std::min(i, end - 1)]);
      const bool same = ReadPoint(database, row, points[i]);
      observations.Take(rows[i], points[i].observations);
      carried.Read(rows[i], points[i].carried);
      hashes[i] = detail::HashOfRow(points[i]);
      observations_hashes[i] = detail::HashOf(points[i].observations);
      const std::uint64_t id = points[i].id.value();
      RequireSame(database, "map_point", rows[i], id, same && hashes[i] == row.Integer(2));
      RequireSame(database, "observation", rows[i], id, observations_hashes[i] == row.Integer(3));
      ++i;
    });
    if (i < end) throw DamagedRow(database, "map_point", rows[i]);
  });
}

}  // namespace slamdb::sqlite
