// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/save.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/postgresql/detail/catalog.h"
#include "slamdb/formats/rows/detail/map_rows.h"
#include "slamdb/formats/rows/detail/provenance.h"
#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/detail/summary_columns.h"
#include "slamdb/model/summary.h"

namespace slamdb::postgresql {

using detail::Concat;
using rows::Value;

namespace {

constexpr const char* kSummaryColumns =
    "hash, maps, keyframes, points, observations, landmarks, sensors, has_imu, is_metric, trajectory_length, duration, "
    "begin_time, end_time";

std::vector<Value> SummaryRow(std::int64_t hash, const AtlasSummary& summary) {
  const auto time = [](std::optional<double> value) { return value ? Value(*value) : Value(); };
  std::vector<Value> row{hash};
  for (const std::uint64_t count :
       {summary.maps, summary.keyframes, summary.points, summary.observations, summary.landmarks})
    row.emplace_back(rows::ToColumn(count));
  for (const std::int64_t number :
       {rows::BitsOf(summary.sensors), std::int64_t{summary.has_imu}, std::int64_t{summary.is_metric}})
    row.emplace_back(number);
  for (const double number : {summary.trajectory_length, summary.duration}) row.emplace_back(number);
  row.push_back(time(summary.begin_time));
  row.push_back(time(summary.end_time));
  return row;
}

// When a revision of another store was saved there; NULL: now.
Parameter RecordedAt(const SaveContext& context) {
  return context.options.recorded ? Parameter(context.options.recorded->at) : Parameter::Null();
}

// The project of what a new atlas was branched off; NULL: of nothing that is here to be seen.
Parameter ProjectOfSource(SaveContext& context) {
  if (!context.options.from) return Parameter::Null();
  const Result project = context.connection.Query("SELECT project FROM atlas WHERE name = $1",
                                                  {context.options.from->atlas}, "table atlas");
  return project.rows() == 0 ? Parameter::Null() : Parameter(project[0].Text(0));
}

// Writes the row of the atlas, and sets context.atlas.
void SaveAtlasRow(SaveContext& context, const std::string& name, std::int64_t hash, const AtlasSummary& summary) {
  std::vector<Parameter> parameters;
  for (const Value& value : SummaryRow(hash, summary)) parameters.push_back(ParameterOf(value));
  std::string numbers;
  for (std::size_t i = 1; i <= parameters.size(); ++i) numbers += Concat(i == 1 ? "$" : ", $", i);
  const std::string revision = Concat("$", parameters.size() + 1), key = Concat("$", parameters.size() + 3);
  const std::string at = Concat("coalesce($", parameters.size() + 2, "::text::timestamptz, now())");
  parameters.emplace_back(context.revision);
  parameters.push_back(RecordedAt(context));
  if (context.is_new) {
    parameters.emplace_back(name);
    parameters.push_back(ProjectOfSource(context));
    const std::string project =
        Concat("coalesce(nullif(current_setting('slamdb.project', true), ''), $", parameters.size(), "::text, '')");
    const Result made = context.connection.Query(
        Concat("INSERT INTO atlas (", kSummaryColumns, ", revision, name, saved_at, bytes, project) VALUES (", numbers,
               ", ", revision, ", ", key, ", ", at, ", 0, ", project, ") ON CONFLICT (name) DO NOTHING RETURNING row"),
        parameters, "table atlas");
    if (made.rows() == 0)
      throw Error(ErrorKind::kAlreadyExists, context.connection.path(), "",
                  Concat("holds an atlas named '", name, "' of a project that you do not see: take another name"));
    context.atlas = made[0].Integer(0);
    return;
  }
  parameters.emplace_back(context.atlas);
  const Result updated =
      context.connection.Query(Concat("UPDATE atlas SET (", kSummaryColumns, ", revision, saved_at) = (", numbers, ", ",
                                      revision, ", ", at, ") WHERE row = ", key),
                               parameters, "table atlas");
  RequireTaken(context.connection, "atlas", updated.changed(), 1);
}

void SaveContent(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes) {
  const MatchedMaps matched = MatchMaps(context, atlas);
  const std::vector<std::int64_t> numbers = NumbersOfMaps(context, matched.maps);
  std::vector<MapToSave> maps;
  for (std::size_t i = 0; i < atlas.maps.size(); ++i)
    maps.push_back({numbers[i], atlas.maps[i], hashes.maps[i], matched.lists[i]});
  const std::vector<ListPlans> plans = SaveLists(context, maps);
  SaveMapRows(context, atlas, hashes, matched.maps, numbers, plans);
  SaveCamerasAndRepeated(context, atlas, hashes, numbers);
}

// Returns its row.
std::int64_t Record(SaveContext& context, const std::string& name, const AtlasSummary& summary, std::int64_t hash,
                    bool is_unchanged) {
  const TableChanges rows = rows::TotalOf(context.changes);
  const auto number = [](std::uint64_t value) { return Parameter(static_cast<std::int64_t>(value)); };
  const MapChanges& map = context.map;
  // File names in it may be any bytes, which a text of PostgreSQL may not.
  const std::string provenance = detail::Visible(context.options.provenance);
  const std::optional<Recorded>& recorded = context.options.recorded;
  std::vector<Parameter> parameters{recorded ? detail::Visible(recorded->tool) : rows::ToolName(), name, provenance,
                                    recorded ? detail::Visible(recorded->who) : rows::Who(), hash};
  for (const std::uint64_t count : {summary.maps, summary.keyframes, summary.points, summary.observations,
                                    rows.inserted, rows.updated, rows.deleted, rows.unchanged})
    parameters.push_back(number(count));
  parameters.push_back(is_unchanged ? Parameter::Null() : Parameter(context.revision));
  for (const std::uint64_t count :
       {map.keyframes_added, map.keyframes_removed, map.keyframes_moved, map.points_added, map.points_removed,
        map.points_moved, map.observations_added, map.observations_removed})
    parameters.push_back(is_unchanged ? Parameter::Null() : number(count));
  parameters.push_back(RecordedAt(context));
  // Of an INSERT with VALUES a subquery is not what every server takes (Citus).
  const Result made = context.connection.Query(
      "INSERT INTO history (at, action, tool, atlas, provenance, who, hash, maps, keyframes, points, observations, "
      "inserted, updated, deleted, unchanged, revision, keyframes_added, keyframes_removed, keyframes_moved, "
      "points_added, points_removed, points_moved, observations_added, observations_removed, project) SELECT "
      "coalesce($23::text::timestamptz, now()), 'save', $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, "
      "$14::integer, $15::bigint, $16::bigint, $17::bigint, $18::bigint, $19::bigint, $20::bigint, $21::bigint, "
      "$22::bigint, project FROM atlas WHERE name = $2 RETURNING row",
      parameters, "table history");
  return made[0].Integer(0);
}

void AddRevision(SaveContext& context, const Atlas& atlas, std::int64_t hash, std::int64_t history) {
  std::vector<Value> row{context.atlas, context.revision, history, hash};
  const std::optional<RevisionName>& from = context.options.from;
  row.push_back(from ? Value(std::string_view(from->atlas)) : Value());
  row.push_back(from ? Value(rows::ToColumn(from->number)) : Value());
  row.push_back(from ? Value(rows::ToColumn(from->hash)) : Value());
  // Texts of files are any bytes, which PostgreSQL's are not.
  for (const Value& value : rows::HeaderRow(atlas)) {
    const auto* text = std::get_if<std::string_view>(&value);
    row.push_back(text == nullptr ? value : Value(std::as_bytes(std::span(*text))));
  }
  CarriedColumn carried;
  row.push_back(carried.Of(atlas.carried));
  InsertRow(context.connection,
            Concat("revision (atlas, number, history, hash, from_atlas, from_number, from_hash, ", rows::kHeaderColumns,
                   ", carried)"),
            row);
}

void SaveWordsAlone(SaveContext& context, const Atlas& atlas, const AtlasHashes& hashes, const LockOptions& lock) {
  context.partition = HoldPartition(context.connection, context.atlas, lock);
  std::vector<std::int64_t> numbers;
  for (const rows::StoredMap& map : ReadStoredMaps(context)) numbers.push_back(map.row);
  if (numbers.size() != atlas.maps.size()) return;
  const std::vector<StoredLists> lists = ReadStoredLists(context, numbers);
  std::vector<MapToSave> maps;
  for (std::size_t i = 0; i < atlas.maps.size(); ++i)
    maps.push_back({numbers[i], atlas.maps[i], hashes.maps[i], lists[i]});
  SaveWords(context, maps);
}

}  // namespace

Parameter ParameterOf(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return Parameter(*integer);
  if (const auto* real = std::get_if<double>(&value)) return std::isnan(*real) ? Parameter::Null() : Parameter(*real);
  if (const auto* text = std::get_if<std::string_view>(&value)) return Parameter(*text);
  if (const auto* blob = std::get_if<Bytes>(&value)) return Parameter(*blob);
  return Parameter::Null();
}

void RequireTaken(Connection& connection, std::string_view table, std::int64_t taken, std::int64_t wanted) {
  if (taken == wanted) return;
  throw Error(ErrorKind::kNotPossible, connection.path(), Concat("table ", table),
              Concat("took ", taken, " of ", wanted,
                     " rows: a trigger, a rule or a policy of the database keeps the others "
                     "out; nothing was saved"));
}

void InsertRow(Connection& connection, std::string_view columns, std::span<const Value> values) {
  std::vector<Parameter> parameters;
  std::string numbers;
  for (const Value& value : values) {
    parameters.push_back(ParameterOf(value));
    numbers += Concat(numbers.empty() ? "$" : ", $", parameters.size());
  }
  const std::string_view table = columns.substr(0, columns.find(' '));
  const Result made =
      connection.Query(Concat("INSERT INTO ", columns, " VALUES (", numbers, ")"), parameters, Concat("table ", table));
  RequireTaken(connection, table, made.changed(), 1);
}

void SaveContext::Report(std::size_t done) {
  entities_done += done;
  if (options.progress && entities > 0)
    options.progress("saving", std::min(1.0, static_cast<double>(entities_done) / static_cast<double>(entities)));
}

namespace {

// As in a file (sqlite/save.cc): another atlas that no revision tells of yet makes one.
bool HasNewSource(Connection& connection, std::int64_t atlas, const std::string& name, const SaveOptions& options) {
  if (!options.from || options.from->atlas == name) return false;
  return connection.Integer("SELECT count(*) FROM revision WHERE atlas = $1 AND from_atlas = $2 AND from_number = $3",
                            {atlas, options.from->atlas, static_cast<std::int64_t>(options.from->number)}) == 0;
}

}  // namespace

SaveReport SaveAtlas(Connection& connection, const std::string& name, const std::optional<StoredHead>& stored,
                     const Atlas& atlas, const AtlasHashes& hashes, const SaveOptions& options, const LockOptions& lock,
                     bool rewrite) {
  const std::int64_t hash = hashes.Combined();
  const StoredHead head = stored.value_or(StoredHead());
  SaveContext context{.connection = connection, .options = options, .atlas = head.atlas};
  context.is_new = !stored;
  context.rewrites = rewrite;
  context.revision = rows::NextNumber(connection.path(), options.recorded, head.revision);
  for (const Map& map : atlas.maps) context.entities += 100 * map.keyframes.size() + map.points.size();
  const AtlasSummary summary = Summarize(atlas);
  SaveReport report{.hash = static_cast<std::uint64_t>(hash), .replaced = !context.is_new};
  report.unchanged = stored && !rewrite && !options.recorded && head.hash == hash &&
                     !HasNewSource(connection, head.atlas, name, options);
  if (report.unchanged && options.verify && !HasAllOfThese(context, atlas)) {
    context.rewrites = true;
    report.unchanged = false;
  }
  if (report.unchanged) {
    context.revision = head.revision;
    rows::CountUnchanged(atlas, context.changes);
    if (!HasAllWords(context, atlas)) SaveWordsAlone(context, atlas, hashes, lock);
  } else {
    SaveAtlasRow(context, name, hash, summary);
    ++(context.is_new ? context.changes["atlas"].inserted : context.changes["atlas"].updated);
    context.partition = HoldPartition(connection, context.atlas, lock);
    UndoUnfinished(connection, context.partition, context.atlas, head.revision, context.rewrites);
    SaveContent(context, atlas, hashes);
    WriteBytes(connection, context.atlas, context.partition);
  }
  const std::int64_t history = Record(context, name, summary, hash, report.unchanged);
  if (!report.unchanged) AddRevision(context, atlas, hash, history);
  report.tables = context.changes.Take();
  report.map = context.map;
  report.revision = static_cast<std::uint64_t>(context.revision);
  return report;
}

}  // namespace slamdb::postgresql
