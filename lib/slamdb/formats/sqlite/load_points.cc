// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/point_row.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/visit_rows.h"

namespace slamdb::sqlite {
namespace {

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
  std::vector<std::int64_t> points_;  // of each of them
  std::vector<Observation> observations_;
  std::size_t next_ = 0;
};

}  // namespace

void LoadPoints(Database& database, std::span<const std::int64_t> rows, std::span<MapPoint> points,
                std::span<std::int64_t> hashes, std::span<std::int64_t> observations_hashes) {
  // What is salvaged may be of an older version, which has no such columns.
  const bool has_tracking = VersionOf(database) >= kFirstVersionWithTracking;
  Statement statement(database,
                      detail::Concat("SELECT slamdb_visit(?1, ", rows::kPointColumns, ", ",
                                     has_tracking ? rows::kPointTrackingColumns : "NULL, NULL, NULL",
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
      const bool same =
          rows::ReadPoint(row, points[i], [&] { return DamagedRow(database, "map_point", row.Integer(0)); });
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
