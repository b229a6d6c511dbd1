// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/summary.h"

#include <optional>

#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/save.h"
#include "slamdb/formats/sqlite/detail/statistics.h"

namespace slamdb::sqlite {
namespace {

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
      continue;
    }
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
  return atlases;
}

}  // namespace slamdb::sqlite
