// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/catalog.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/postgresql/detail/writer_lock.h"
#include "slamdb/formats/rows/detail/atlas_conditions.h"
#include "slamdb/formats/rows/detail/history_row.h"
#include "slamdb/formats/rows/detail/summary_columns.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

// What a row takes without its blobs and arrays, and an element of three of these, about.
constexpr std::uint64_t kPointBytes = 330, kObservationBytes = 16;

std::uint64_t Unsigned(const Row& row, std::size_t column) { return static_cast<std::uint64_t>(row.Integer(column)); }

std::optional<double> RealOrNone(const Row& row, std::size_t column) {
  return row.IsNull(column) ? std::nullopt : std::optional(row.Real(column));
}

// ---- search: the maps that match, of those in question

// As SQL, with parameters from $1 on, which it appends.
class Conditions {
 public:
  Conditions(const MapQuery& query, const Partition& partition) : partition_(partition) {
    if (query.times) AddTimes(*query.times);
    if (query.keyframes) AddIds(*query.keyframes);
    if (query.near) AddBall(*query.near);
  }
  const std::string& sql() const { return sql_; }
  const std::vector<Parameter>& parameters() const { return parameters_; }

 private:
  std::string Put(double value) {
    parameters_.emplace_back(value);
    return Concat("$", parameters_.size());
  }
  void AddTimes(const MapQuery::Times& times) {
    sql_ += Concat(" AND times && span(", Put(times.begin), ", ", Put(times.end), ", '[]')");
  }
  // Ids are unsigned: those from 2^63 on are negative here, and greater.
  void AddIds(const MapQuery::Ids& ids) {
    const auto number = [&](std::uint64_t id) {
      parameters_.emplace_back(static_cast<std::int64_t>(id ^ std::uint64_t{1} << 63));
      return Concat("$", parameters_.size());
    };
    const std::string first = number(ids.first), last = number(ids.last);
    sql_ += Concat(
        " AND EXISTS (SELECT 1 FROM ", partition_.Table("keyframe"),
        " WHERE keyframe.atlas = map.atlas AND keyframe.map = map.row AND keyframe.until = 2147483647 AND bad = 0 AND "
        "(id # (-9223372036854775808)::bigint) BETWEEN ",
        first, " AND ", last, ")");
  }
  // The box of the map first, by its index; its points where that is met. Of points the box first, too: squares of what
  // is far away, or of next to nothing, are errors in PostgreSQL, not infinite or 0.
  void AddBall(const MapQuery::Ball& ball) {
    constexpr double kLargest = 1e150, kInfinity = std::numeric_limits<double>::infinity();
    const double radius = std::min(ball.radius, kLargest);
    std::string in_box = "true", squares = "0";
    for (int axis = 0; axis < 3; ++axis) {
      const double center = ball.center[axis];
      const std::string name(1, static_cast<char>('x' + axis)), at = Put(center);
      const std::string least = Put(std::nextafter(center - radius, -kInfinity)),
                        most = Put(std::nextafter(center + radius, kInfinity));
      sql_ += Concat(" AND map.", name, " && span(", least, ", ", most, ", '[]')");
      in_box += Concat(" AND ", name, " BETWEEN ", least, " AND ", most);
      squares += Concat(" + CASE WHEN abs(", name, " - ", at, ") < 1e-150 THEN 0 ELSE (", name, " - ", at, ") * (",
                        name, " - ", at, ") END");
    }
    const std::string square = Put(radius * radius);
    const auto has = [&](std::string_view table, std::string_view good) {
      return Concat("EXISTS (SELECT 1 FROM (SELECT x::float8, y::float8, z::float8 FROM ", partition_.Table(table),
                    " WHERE ", table, ".atlas = map.atlas AND ", table,
                    ".row BETWEEN map.row << 32 AND (map.row << 32) + 4294967295 AND ", table, ".until = 2147483647",
                    good, ") AS place WHERE CASE WHEN ", in_box, " THEN ", squares, " <= ", square, " ELSE false END)");
    };
    sql_ += Concat(" AND (", has("map_point", " AND bad = 0"), " OR ", has("landmark", ""), ")");
  }

  const Partition& partition_;
  std::string sql_;
  std::vector<Parameter> parameters_;
};

std::string LikeOf(std::string_view text) {
  std::string pattern;
  for (const char letter : text) {
    if (letter == '%' || letter == '_' || letter == '\\') pattern += '\\';
    pattern += letter == '*' ? '%' : letter == '?' ? '_' : letter;
  }
  return pattern;
}

// What `where` tells apart, oldest first.
std::vector<HistoryEntry> ReadEntries(Connection& connection, std::string_view where,
                                      const std::vector<Parameter>& parameters) {
  const Result found = connection.Query(
      Concat(
          "SELECT ", TextOfTime("at"),
          ", tool, action, coalesce(history.atlas, ''), provenance, maps, keyframes, points, observations, inserted, "
          "updated, deleted, unchanged, history.hash, who, coalesce(history.revision, 0), revision.number IS NOT "
          "NULL, (SELECT string_agg(tag.name, E'\\n' ORDER BY tag.name COLLATE \"C\") FROM tag WHERE tag.atlas = "
          "revision.atlas AND tag.number = revision.number), from_atlas, from_number, from_hash, keyframes_added, "
          "keyframes_removed, keyframes_moved, points_added, points_removed, points_moved, observations_added, "
          "observations_removed FROM history LEFT JOIN revision ON revision.history = history.row WHERE ",
          where, " ORDER BY history.row"),
      parameters, "table history");
  std::vector<HistoryEntry> entries;
  for (std::size_t i = 0; i < found.rows(); ++i) entries.push_back(rows::HistoryEntryOf(found[i]));
  return entries;
}

std::vector<std::int64_t> Integers64(const Row& row, std::size_t column) {
  std::vector<std::int64_t> values;
  row.Integers64(column, values);
  return values;
}

// Of two columns: numbers, and hashes.
std::vector<RevisionChain::Link> ReadLinks(Connection& connection, const Row& row, std::size_t column) {
  const std::vector<std::int64_t> numbers = Integers64(row, column), hashes = Integers64(row, column + 1);
  if (numbers.size() != hashes.size())
    throw Error(ErrorKind::kDamaged, connection.path(), "table revision", "lists of different lengths");
  std::vector<RevisionChain::Link> links;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    links.push_back({static_cast<std::uint64_t>(numbers[i]), static_cast<std::uint64_t>(hashes[i])});
  return links;
}

RevisionChain ReadChain(Connection& connection, const Row& row) {
  RevisionChain chain{.name = std::string(row.Text(0)),
                      .links = ReadLinks(connection, row, 1),
                      .given_up = ReadLinks(connection, row, 5)};
  // Those that were made of something besides, and the hashes of that.
  std::size_t next = 0;
  const std::vector<RevisionChain::Link> made = ReadLinks(connection, row, 3);
  for (RevisionChain::Link& link : chain.links)
    if (next < made.size() && made[next].number == link.number) link.from_hash = made[next++].hash;
  const std::vector<std::string_view> words = detail::Split(row.Text(7), '\n');
  for (std::size_t i = 0; i + 1 < words.size(); i += 2)
    chain.tags.push_back({std::string(words[i]), detail::ParseNumber<std::uint64_t>(words[i + 1]).value_or(0)});
  return chain;
}

// Each kind of data, and how many bytes it takes, as SQL in a statement over `atlas` whose $1 is its row.
std::vector<std::pair<std::string_view, std::string>> BytesOfParts(const Partition& partition) {
  const auto newest = [&](std::string_view what, std::string_view table) {
    return Concat("(SELECT ", what, " FROM ", partition.Table(table), " WHERE ", table,
                  ".atlas = $1 AND until = 2147483647)");
  };
  const auto sum = [&](std::string_view bytes, std::string_view table) {
    return newest(Concat("coalesce(sum(", bytes, "), 0)::bigint"), table);
  };
  const std::string pictures =
      Concat("(SELECT coalesce(sum(octet_length(columns)), 0)::bigint FROM ", partition.Table("picture"),
             " WHERE picture.atlas = $1 AND picture.hash = ANY (array", newest("picture", "keyframe_features"), "))");
  return {{"features", Concat(sum("octet_length(keyframe_features.points)", "keyframe_features"), " + ", pictures)},
          {"keyframes", sum("octet_length(details) + 12 * cardinality(connections)", "keyframe")},
          {"points", Concat("atlas.points * ", kPointBytes)},
          {"observations", Concat("atlas.observations * ", kObservationBytes)},
          {"landmarks", sum("octet_length(landmark.features) + 144", "landmark")}};
}

}  // namespace

std::vector<StoredAtlas> ListAtlases(Connection& connection) {
  std::vector<StoredAtlas> atlases;
  connection.CopyOut(
      Concat(
          "SELECT name, maps, keyframes, points, observations, coalesce(number, 0), coalesce(newest.hash, 0), "
          "landmarks, "
          "bytes, ",
          TextOfTime("saved_at"),
          ", sensors, has_imu, is_metric, trajectory_length, duration, begin_time, end_time, atlas.revision IS "
          "DISTINCT "
          "FROM number OR atlas.hash IS DISTINCT FROM newest.hash FROM atlas LEFT JOIN LATERAL (SELECT number, hash "
          "FROM "
          "revision WHERE revision.atlas = row ORDER BY number DESC LIMIT 1) AS newest ON true ORDER BY name COLLATE "
          "\"C\""),
      [&](const Row& row) {
        StoredAtlas& atlas = atlases.emplace_back();
        std::size_t column = 0;
        atlas.name = row.Text(column++);
        for (std::uint64_t* value : {&atlas.maps, &atlas.keyframes, &atlas.points, &atlas.observations, &atlas.revision,
                                     &atlas.hash, &atlas.landmarks, &atlas.bytes})
          *value = Unsigned(row, column++);
        atlas.saved_at = row.Text(column++);
        atlas.sensors = rows::SensorsOf(row.Integer(column++));
        atlas.has_imu = row.Integer(column++) != 0;
        atlas.is_metric = row.Integer(column++) != 0;
        atlas.trajectory_length = row.Real(column++);
        atlas.duration = row.Real(column++);
        atlas.begin_time = RealOrNone(row, column++);
        atlas.end_time = RealOrNone(row, column++);
        atlas.problem = row.Integer(column) != 0 ? "another revision than the newest" : rows::ProblemOf(atlas);
      },
      "table atlas");
  return atlases;
}

std::vector<std::string> FindAtlases(Connection& connection, const MapQuery& query, const Partition& partition) {
  if (query.everything()) return NamesOf(connection);
  const Conditions conditions(query, partition);
  const Result found =
      connection.Query(Concat("SELECT name FROM atlas WHERE row IN (SELECT map.atlas FROM ", partition.Table("map"),
                              " WHERE map.until = 2147483647", conditions.sql(), ") ORDER BY name COLLATE \"C\""),
                       conditions.parameters(), "table map");
  return found.Texts();
}

std::vector<std::string> FindAtlases(Connection& connection, const AtlasQuery& query) {
  const rows::AtlasConditions conditions =
      rows::ConditionsOf(query, {.parameter = '$', .matches = "LIKE", .pattern = LikeOf});
  std::vector<Parameter> parameters;
  for (const auto& parameter : conditions.parameters)
    std::visit([&](const auto& value) { parameters.emplace_back(value); }, parameter);
  return connection
      .Query(Concat("SELECT name FROM atlas WHERE ", conditions.sql, " ORDER BY name COLLATE \"C\""), parameters,
             "table atlas")
      .Texts();
}

std::vector<HistoryEntry> ReadHistory(Connection& connection, const std::string& name) {
  return ReadEntries(connection, "$1 = '' OR history.atlas = $1", {name});
}

HistoryEntry ReadHistoryOf(Connection& connection, std::int64_t atlas, std::int64_t number) {
  std::vector<HistoryEntry> found =
      ReadEntries(connection, "revision.atlas = $1 AND revision.number = $2", {atlas, number});
  if (found.empty())
    throw Error(ErrorKind::kDamaged, connection.path(), "table history", Concat("tells nothing of revision ", number));
  return std::move(found.front());
}

std::vector<RevisionChain> ReadChains(Connection& connection, const ChainQuery& query) {
  const auto list = [](std::string_view column, std::string_view which = {}) {
    return Concat("array(SELECT ", column, "::bigint FROM revision WHERE atlas = page.row", which, " ORDER BY number)");
  };
  // What the log tells of an atlas that was removed means nothing to the next of that name.
  const auto given_up = [&](std::string_view column) {
    if (!query.given_up) return std::string("array[]::bigint[]");
    return Concat("array(SELECT history.", column,
                  "::bigint FROM history WHERE history.atlas = page.name AND history.revision > 0 AND history.row > "
                  "coalesce((SELECT max(removal.row) FROM history AS removal WHERE removal.atlas = page.name AND "
                  "removal.action = 'remove'), 0) AND NOT EXISTS (SELECT 1 FROM revision WHERE revision.history = "
                  "history.row) ORDER BY history.revision, history.row)");
  };
  constexpr std::string_view kMade = " AND from_hash IS NOT NULL";
  std::vector<Parameter> parameters{query.after, static_cast<std::int64_t>(query.count)};
  if (!query.names.empty()) parameters.emplace_back(std::span<const std::string>(query.names));
  const Result found = connection.Query(
      Concat(
          "SELECT name, ", list("number"), ", ", list("hash"), ", ", list("number", kMade), ", ",
          list("from_hash", kMade), ", ", given_up("revision"), ", ", given_up("hash"),
          ", (SELECT string_agg(tag.name || E'\\n' || number, E'\\n' ORDER BY tag.name COLLATE \"C\") FROM tag WHERE "
          "atlas = page.row) FROM (SELECT row, name FROM atlas WHERE name > $1",
          query.names.empty() ? "" : " AND name = ANY ($3)", " ORDER BY name LIMIT $2) AS page ORDER BY name"),
      parameters, "table revision");
  std::vector<RevisionChain> chains;
  for (std::size_t i = 0; i < found.rows(); ++i) chains.push_back(ReadChain(connection, found[i]));
  return chains;
}

StoreStats ReadStatistics(Connection& connection) {
  StoreStats stats;
  stats.version = VersionOf(connection);
  stats.page_bytes = static_cast<std::uint64_t>(connection.Integer("SELECT current_setting('block_size')::bigint"));
  // Partitions count as the table that they are of.
  connection.CopyOut(
      "SELECT coalesce(parent.relname, class.relname), sum(pg_total_relation_size(class.oid))::bigint FROM pg_class AS "
      "class LEFT JOIN pg_inherits ON inhrelid = class.oid LEFT JOIN pg_class AS parent ON parent.oid = inhparent "
      "WHERE "
      "class.relnamespace = 'slamdb'::regnamespace AND class.relkind IN ('r', 'p') GROUP BY 1 ORDER BY 2 DESC, 1",
      [&](const Row& row) {
        stats.tables.push_back({std::string(row.Text(0)), Unsigned(row, 1)});
        stats.file_bytes += Unsigned(row, 1);
      });
  stats.partitions_elsewhere =
      static_cast<std::uint64_t>(connection.Integer("SELECT count(*) FROM pg_inherits JOIN pg_class ON pg_class.oid = "
                                                    "inhrelid WHERE inhparent = 'slamdb.map'::regclass "
                                                    "AND relkind = 'f'"));
  stats.pages = stats.file_bytes / std::max<std::uint64_t>(stats.page_bytes, 1);
  if (connection.Integer("SELECT has_function_privilege('pg_ls_waldir()', 'EXECUTE')::integer") != 0)
    stats.log_bytes =
        static_cast<std::uint64_t>(connection.Integer("SELECT coalesce(sum(size), 0)::bigint FROM pg_ls_waldir()"));
  return stats;
}

std::vector<PartSize> PartSizesOf(Connection& connection, std::int64_t atlas, const Partition& partition) {
  std::vector<PartSize> parts;
  std::string sums;
  for (const auto& [part, bytes] : BytesOfParts(partition)) {
    parts.push_back({std::string(part), 0});
    sums += Concat(sums.empty() ? "" : ", ", bytes);
  }
  const Result found = connection.Query(Concat("SELECT ", sums, " FROM atlas WHERE row = $1"), {atlas}, "table atlas");
  if (found.rows() == 0) return {};
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i].bytes = Unsigned(found[0], i);
  return parts;
}

void WriteBytes(Connection& connection, std::int64_t atlas, const Partition& partition) {
  std::string sum;
  for (const auto& [part, bytes] : BytesOfParts(partition)) sum += Concat(sum.empty() ? "" : " + ", bytes);
  connection.Query(Concat("UPDATE atlas SET bytes = ", sum, " WHERE row = $1"), {atlas}, "table atlas");
}

bool IsAsSaved(Connection& connection, const Named& named) {
  if (PartitionOf(connection, named.atlas).is_remote) return false;
  const LocalSetting loops(connection, "enable_nestloop", "off");
  std::string edited;
  for (const std::string_view table : {"camera", "map", "keyframe", "keyframe_features", "map_point", "landmark"})
    edited +=
        Concat(edited.empty() ? "" : " OR ", "EXISTS (SELECT 1 FROM ", table, " WHERE atlas = $1 AND until = ", kNewest,
               " AND xmin::text::bigint NOT IN (SELECT xid FROM saves))");
  edited +=
      " OR EXISTS (SELECT 1 FROM picture WHERE atlas = $1 AND xmin::text::bigint NOT IN (SELECT xid FROM saves)) OR "
      "EXISTS (SELECT 1 FROM revision WHERE atlas = $1 AND xmin::text::bigint NOT IN (SELECT xid FROM saves)) OR "
      "EXISTS "
      "(SELECT 1 FROM keyframe_features AS features WHERE atlas = $1 AND until = 2147483647 AND NOT EXISTS (SELECT 1 "
      "FROM "
      "picture WHERE picture.atlas = $1 AND picture.hash = features.picture))";
  // And none is gone.
  const auto count = [](std::string_view table) {
    return Concat("(SELECT count(*) FROM ", table, " WHERE atlas = $1 AND until = 2147483647)");
  };
  edited += Concat(
      " OR ", count("keyframe"), " <> ", count("keyframe_features"),
      " OR EXISTS (SELECT 1 FROM history WHERE row = (SELECT history FROM revision WHERE atlas = $1 ORDER BY "
      "number DESC LIMIT 1) AND (history.maps <> ",
      count("map"), " OR history.keyframes <> ", count("keyframe"), " OR history.points <> ", count("map_point"), "))");
  return connection.Integer(Concat("WITH saves AS MATERIALIZED (SELECT xid FROM history WHERE atlas = $2) SELECT (",
                                   edited, ")::integer"),
                            {named.atlas, named.name}) == 0;
}

}  // namespace slamdb::postgresql
