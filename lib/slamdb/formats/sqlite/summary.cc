// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/summary.h"

#include <cmath>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/save.h"
#include "slamdb/formats/sqlite/detail/statistics.h"

namespace slamdb::sqlite {
namespace {

using slamdb::detail::Concat;

// In the order of their bits in atlas.sensors.
constexpr MapSensor kSensors[] = {MapSensor::kMonocular, MapSensor::kStereoOrRgbd, MapSensor::kFisheyeStereo};

std::int64_t BitsOf(const std::vector<MapSensor>& sensors) {
  std::int64_t bits = 0;
  for (const MapSensor sensor : sensors)
    for (std::size_t i = 0; i < std::size(kSensors); ++i)
      if (kSensors[i] == sensor) bits |= std::int64_t{1} << i;
  return bits;
}

std::vector<MapSensor> SensorsOf(std::int64_t bits) {
  std::vector<MapSensor> sensors;
  for (std::size_t i = 0; i < std::size(kSensors); ++i)
    if ((bits >> i & 1) != 0) sensors.push_back(kSensors[i]);
  return sensors;
}

std::optional<double> RealOrNone(const Statement& statement, int column) {
  return statement.IsNull(column) ? std::nullopt : std::optional(statement.Real(column));
}

void BindRealOrNone(Statement& statement, int index, std::optional<double> value) {
  value ? statement.BindReal(index, *value) : statement.BindNull(index);
}

std::uint64_t BytesOf(Database& database, std::int64_t atlas) {
  std::uint64_t bytes = 0;
  for (const PartSize& part : PartSizesOf(database, atlas)) bytes += part.bytes;
  return bytes;
}

// What rows can be there at most, by the highest of each map.
class MostRows {
 public:
  explicit MostRows(Database& database)
      : statement_(database,
                   Concat("SELECT count(*), ", Most("keyframe"), ", ", Most("map_point"), ", ", Most("landmark"),
                          " FROM map WHERE atlas = ?1"),
                   "table map") {}

  // What the row of the atlas says that cannot be; empty: nothing.
  std::string ProblemOf(std::int64_t row, const StoredAtlas& atlas) {
    statement_.Bind(1, row).Step();
    int column = 0;
    std::string problem;
    const auto check = [&](std::string_view what, std::uint64_t told) {
      const auto most = static_cast<std::uint64_t>(statement_.Integer(column++));
      if (told > most && problem.empty())
        problem = Concat(static_cast<std::int64_t>(told), " ", what, " where at most ", most, " can be");
    };
    check("maps", atlas.maps);
    check("keyframes", atlas.keyframes);
    check("points", atlas.points);
    check("landmarks", atlas.landmarks);
    statement_.Reset();
    return problem;
  }

 private:
  static std::string Most(std::string_view table) {
    return Concat("coalesce(sum((SELECT max(row) + 1 FROM ", table,
                  " WHERE row BETWEEN map.row << 32 AND (map.row << 32) + 4294967295) - (map.row << 32)), 0)");
  }

  Statement statement_;
};

// As far as it can be told without the rows.
std::string ProblemOf(const StoredAtlas& atlas) {
  const auto is_negative = [](std::uint64_t count) { return static_cast<std::int64_t>(count) < 0; };
  if (is_negative(atlas.observations)) return "a negative count of observations";
  if (is_negative(atlas.bytes)) return "a negative size";
  if (!(std::isfinite(atlas.trajectory_length) && atlas.trajectory_length >= 0))
    return Concat("a trajectory of length ", atlas.trajectory_length);
  if (!(std::isfinite(atlas.duration) && atlas.duration >= 0)) return Concat("a duration of ", atlas.duration, " s");
  if (!std::isfinite(atlas.begin_time.value_or(0)) || !std::isfinite(atlas.end_time.value_or(0)))
    return "a time that is not finite";
  return {};
}

}  // namespace

void SaveSummary(Database& database, std::int64_t atlas, const AtlasSummary& summary) {
  Statement update(database,
                   "UPDATE atlas SET sensors = ?2, has_imu = ?3, is_metric = ?4, landmarks = ?5, trajectory_length = "
                   "?6, duration = ?7, begin_time = ?8, end_time = ?9, bytes = ?10 WHERE row = ?1",
                   "table atlas");
  update.Bind(1, atlas).Bind(2, BitsOf(summary.sensors)).Bind(3, std::int64_t{summary.has_imu});
  update.Bind(4, std::int64_t{summary.is_metric}).Bind(5, ToColumn(summary.landmarks));
  update.BindReal(6, summary.trajectory_length).BindReal(7, summary.duration);
  BindRealOrNone(update, 8, summary.begin_time);
  BindRealOrNone(update, 9, summary.end_time);
  update.Bind(10, ToColumn(BytesOf(database, atlas))).Run();
}

void SaveMissingSummaries(Database& database) {
  std::vector<std::int64_t> rows;
  {
    Statement statement(database, "SELECT row FROM atlas WHERE sensors IS NULL", "table atlas");
    while (statement.Step()) rows.push_back(statement.Integer(0));
  }
  for (const std::int64_t row : rows) {
    try {
      // One thread, as no other connection sees what the transaction has changed.
      SaveSummary(database, row,
                  Summarize(LoadAtlas(database, row, {.features = FeatureColumns::kGeometry, .threads = 1})));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
    }
  }
}

std::vector<StoredAtlas> ListAtlases(Database& database) {
  Statement statement(database,
                      "SELECT row, name, maps, keyframes, points, observations, revision, hash, saved_at, sensors, "
                      "has_imu, is_metric, landmarks, trajectory_length, duration, begin_time, end_time, bytes "
                      "FROM atlas ORDER BY name",
                      "table atlas");
  std::vector<StoredAtlas> atlases;
  MostRows most(database);
  while (statement.Step()) {
    StoredAtlas& atlas = atlases.emplace_back();
    int column = 1;
    const auto number = [&] { return static_cast<std::uint64_t>(statement.Integer(column++)); };
    atlas.name = statement.Text(column++);
    for (std::uint64_t* value :
         {&atlas.maps, &atlas.keyframes, &atlas.points, &atlas.observations, &atlas.revision, &atlas.hash})
      *value = number();
    atlas.saved_at = statement.Text(column++);
    if (statement.IsNull(column)) {
      atlas.bytes = BytesOf(database, statement.Integer(0));
    } else {
      atlas.sensors = SensorsOf(statement.Integer(column++));
      atlas.has_imu = number() != 0;
      atlas.is_metric = number() != 0;
      atlas.landmarks = number();
      atlas.trajectory_length = statement.Real(column++);
      atlas.duration = statement.Real(column++);
      atlas.begin_time = RealOrNone(statement, column++);
      atlas.end_time = RealOrNone(statement, column++);
      atlas.bytes = number();
    }
    atlas.problem = most.ProblemOf(statement.Integer(0), atlas);
    if (atlas.problem.empty()) atlas.problem = ProblemOf(atlas);
  }
  return atlases;
}

}  // namespace slamdb::sqlite
