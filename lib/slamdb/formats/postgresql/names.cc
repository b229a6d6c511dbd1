// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/names.h"

#include <algorithm>
#include <iterator>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/postgresql/detail/writer_lock.h"
#include "slamdb/formats/rows/detail/ancestry.h"
#include "slamdb/formats/rows/detail/find_revision.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

class Catalog : public rows::RevisionCatalog {
 public:
  explicit Catalog(Connection& connection) : connection_(connection) {}

  const std::string& path() const override { return connection_.path(); }
  std::vector<std::string> Names() override { return NamesOf(connection_); }
  std::optional<Named> Newest(std::string_view name) override {
    const std::optional<StoredHead> head = FindHead(connection_, name);
    if (!head) return std::nullopt;
    return Named{head->atlas, std::string(name), head->revision, head->revision};
  }
  std::vector<std::int64_t> Numbers(std::int64_t atlas) override {
    return connection_.Query("SELECT number FROM revision WHERE atlas = $1 ORDER BY number", {atlas}, "table revision")
        .Integers();
  }
  bool HasNumber(std::int64_t atlas, std::int64_t number) override {
    return FirstOf("SELECT number FROM revision WHERE atlas = $1 AND number = $2", {atlas, number}).has_value();
  }
  std::optional<std::int64_t> LastBy(std::int64_t atlas, const std::string& time) override {
    return FirstOf(
        "SELECT number FROM revision JOIN history ON history.row = history WHERE revision.atlas = $1 AND "
        "date_trunc('second', at) <= $2::text::timestamptz ORDER BY number DESC LIMIT 1",
        {atlas, time});
  }
  std::optional<std::int64_t> Tagged(std::int64_t atlas, std::string_view tag) override {
    return FirstOf("SELECT number FROM tag WHERE atlas = $1 AND name = $2", {atlas, tag});
  }
  std::vector<std::string> Tags(std::int64_t atlas) override {
    return connection_.Query("SELECT name FROM tag WHERE atlas = $1 ORDER BY name COLLATE \"C\"", {atlas}, "table tag")
        .Texts();
  }

 private:
  std::optional<std::int64_t> FirstOf(const std::string& query, const std::vector<Parameter>& parameters) {
    const Result found = connection_.Query(query, parameters, "table revision");
    return found.rows() > 0 ? std::optional(found[0].Integer(0)) : std::nullopt;
  }

  Connection& connection_;
};

// The numbers that stay, ascending. What the log has lost counts as saved long ago.
std::vector<std::int64_t> KeptOf(Connection& connection, const Named& atlas, const GiveUpOptions& options) {
  const Result found = connection.Query(
      Concat(
          "SELECT number, coalesce(", TextOfTime("at"),
          ", ''), coalesce(from_atlas <> $2, false) OR number IN (SELECT number FROM tag WHERE atlas = $1) OR EXISTS "
          "(SELECT 1 FROM revision AS other WHERE other.from_atlas = $2 AND other.from_number = revision.number AND "
          "other.from_hash = revision.hash AND other.atlas <> $1), CASE WHEN from_atlas = $2 THEN from_number ELSE 0 "
          "END FROM revision LEFT JOIN history ON history.row = history WHERE revision.atlas = $1 ORDER BY number"),
      {atlas.atlas, atlas.name}, "table revision");
  std::vector<rows::KeptRevision> all;
  for (std::size_t i = 0; i < found.rows(); ++i)
    all.push_back({found[i].Integer(0), std::string(found[i].Text(1)), found[i].Integer(2) != 0, found[i].Integer(3)});
  return rows::KeptOf(all, options);
}

// Of rows of an atlas, $1, that no revision of those in $2, ascending, has: as many are before the first that has the
// row as up to the last one.
constexpr std::string_view kOfNone =
    "until <> 2147483647 AND width_bucket(since::bigint - 1, $2::bigint[]) = width_bucket(until::bigint - 1, "
    "$2::bigint[])";

std::string PicturesOfNone() {
  return Concat(
      "picture WHERE atlas = $1 AND NOT EXISTS (SELECT 1 FROM keyframe_features WHERE keyframe_features.atlas = $1 AND "
      "keyframe_features.picture = picture.hash AND NOT (",
      kOfNone, "))");
}

// `pictures`: how many, and their bytes.
GivenUpRows SizesOf(std::uint64_t rows, const Row& pictures) {
  constexpr std::uint64_t kRowBytes = 200;  // about
  return {rows, static_cast<std::uint64_t>(pictures.Integer(0)),
          kRowBytes * rows + static_cast<std::uint64_t>(pictures.Integer(1))};
}

// Deletes what only revisions have that are not kept.
GivenUpRows DeleteAllBut(Connection& connection, std::int64_t atlas, const std::vector<std::int64_t>& kept) {
  std::uint64_t rows = 0;
  const std::vector<Parameter> parameters = {atlas, std::span(kept)};
  const LocalSetting loops(connection, "enable_nestloop", "off");
  for (const Versioned& each : VersionedTables())
    rows += static_cast<std::uint64_t>(connection
                                           .Query(Concat("DELETE FROM ", each.table, " WHERE atlas = $1 AND ", kOfNone),
                                                  parameters, Concat("table ", each.table))
                                           .changed());
  const Result pictures = connection.Query(
      Concat("WITH gone AS (DELETE FROM ", PicturesOfNone(),
             " RETURNING octet_length(columns) AS bytes) SELECT count(*), coalesce(sum(bytes), 0)::bigint FROM gone"),
      parameters, "table picture");
  return SizesOf(rows, pictures[0]);
}

// What that would be.
GivenUpRows CountAllBut(Connection& connection, std::int64_t atlas, const std::vector<std::int64_t>& kept) {
  std::uint64_t rows = 0;
  const std::vector<Parameter> parameters = {atlas, std::span(kept)};
  const LocalSetting loops(connection, "enable_nestloop", "off");
  for (const Versioned& each : VersionedTables())
    rows += static_cast<std::uint64_t>(
        connection.Integer(Concat("SELECT count(*) FROM ", each.table, " WHERE atlas = $1 AND ", kOfNone), parameters));
  const Result pictures = connection.Query(
      Concat("SELECT count(*), coalesce(sum(octet_length(columns)), 0)::bigint FROM ", PicturesOfNone()), parameters,
      "table picture");
  return SizesOf(rows, pictures[0]);
}

void DeleteRevisionsBut(Connection& connection, std::int64_t atlas, const std::vector<std::int64_t>& kept) {
  connection.Query("DELETE FROM revision WHERE atlas = $1 AND number <> ALL ($2::bigint[])", {atlas, std::span(kept)},
                   "table revision");
}

// Tells what goes. Returns what stays; nothing where all does.
std::vector<std::int64_t> PlanGiveUp(Connection& connection, const Named& atlas, const GiveUpOptions& options,
                                     GiveUpReport& report) {
  std::vector<std::int64_t> gone, kept = KeptOf(connection, atlas, options);
  std::ranges::set_difference(Catalog(connection).Numbers(atlas.atlas), kept, std::back_inserter(gone));
  report.atlases.push_back({atlas.name, {gone.begin(), gone.end()}, kept.size()});
  if (gone.empty()) kept.clear();
  return kept;
}

}  // namespace

std::optional<StoredHead> FindHead(Connection& connection, std::string_view name) {
  // By the revisions themselves: what the row of the atlas says is for lists.
  const Result found = connection.Query(
      "SELECT row, coalesce(number, 0), revision.hash FROM atlas LEFT JOIN revision ON revision.atlas = row WHERE name "
      "= $1 ORDER BY number DESC LIMIT 1",
      {name}, "table atlas");
  if (found.rows() == 0) return std::nullopt;
  return StoredHead{found[0].Integer(0), found[0].Integer(1), found[0].Integer(2)};
}

Named Find(Connection& connection, std::string_view text) {
  Catalog catalog(connection);
  return rows::FindRevision(catalog, text);
}

Named Find(Connection& connection, const RevisionName& revision) {
  Catalog catalog(connection);
  return rows::FindRevision(catalog, revision);
}

std::vector<std::string> NamesOf(Connection& connection) {
  return connection.Query("SELECT name FROM atlas ORDER BY name COLLATE \"C\"", {}, "table atlas").Texts();
}

std::vector<std::string> NamesIn(Connection& connection, std::int64_t partition) {
  return connection
      .Query(
          Concat("SELECT name FROM atlas WHERE ", IsInPartition("row", "$1::integer"), " ORDER BY name COLLATE \"C\""),
          {static_cast<std::int32_t>(partition)}, "table atlas")
      .Texts();
}

bool Has(Connection& connection, const std::string& name) {
  return connection.Query("SELECT 1 FROM atlas WHERE name = $1", {name}, "table atlas").rows() > 0;
}

RevisionName NameOf(Connection& connection, const Named& named) {
  const Result found = connection.Query("SELECT hash FROM revision WHERE atlas = $1 AND number = $2",
                                        {named.atlas, named.number}, "table revision");
  return {named.name, static_cast<std::uint64_t>(named.number),
          static_cast<std::uint64_t>(found.rows() == 0 ? 0 : found[0].Integer(0))};
}

std::optional<RevisionName> CommonBase(Connection& connection, const Named& first, const Named& second) {
  // Of the two, and of all that these were made of.
  const Result found = connection.Query(
      "WITH RECURSIVE family (name) AS (SELECT $1::text UNION SELECT $2::text UNION SELECT from_atlas FROM family JOIN "
      "atlas USING (name) JOIN revision ON revision.atlas = atlas.row WHERE from_atlas IS NOT NULL) SELECT name, "
      "number, "
      "revision.hash, history, from_atlas, from_number, from_hash FROM family JOIN atlas USING (name) JOIN revision ON "
      "revision.atlas = atlas.row ORDER BY name, number",
      {first.name, second.name}, "table revision");
  std::vector<rows::RevisionOf> all;
  for (std::size_t i = 0; i < found.rows(); ++i) all.push_back(rows::RevisionOfRow(found[i]));
  return rows::CommonBase(all, first, second);
}

void SetTag(Connection& connection, const Named& named, const std::string& tag) {
  const Result made = connection.Query("INSERT INTO tag VALUES ($1, $2, $3) ON CONFLICT DO NOTHING",
                                       {named.atlas, tag, named.number}, "table tag");
  if (made.changed() > 0) return;
  const Result found =
      connection.Query("SELECT number FROM tag WHERE atlas = $1 AND name = $2", {named.atlas, tag}, "table tag");
  if (found.rows() > 0 && found[0].Integer(0) != named.number)
    throw rows::TagIsTaken(connection.path(), named.name, tag, found[0].Integer(0));
}

void RemoveTag(Connection& connection, const Named& named, const std::string& tag) {
  const Result removed =
      connection.Query("DELETE FROM tag WHERE atlas = $1 AND name = $2", {named.atlas, tag}, "table tag");
  if (removed.changed() == 0)
    throw rows::NoSuchTag(connection.path(), named.name, tag, Catalog(connection).Tags(named.atlas));
}

void TellGiveUp(Connection& connection, const std::string& name, const GiveUpOptions& options, GiveUpReport& report) {
  const Named atlas = Find(connection, name);
  const std::vector<std::int64_t> kept = PlanGiveUp(connection, atlas, options, report);
  if (kept.empty()) return;
  const GivenUpRows rows = CountAllBut(connection, atlas.atlas, kept);
  report.pictures += rows.pictures;
  report.bytes += rows.bytes;
}

void GiveUp(Connection& connection, const std::string& name, const GiveUpOptions& options, const LockOptions& lock,
            GiveUpReport& report) {
  LockAtlas(connection, name, lock);
  const Named atlas = Find(connection, name);
  const std::vector<std::int64_t> kept = PlanGiveUp(connection, atlas, options, report);
  if (kept.empty()) return;
  DeleteRevisionsBut(connection, atlas.atlas, kept);
  if (HoldPartition(connection, atlas.atlas, lock).is_remote) return;
  const GivenUpRows deleted = DeleteAllBut(connection, atlas.atlas, kept);
  report.pictures += deleted.pictures;
  report.bytes += deleted.bytes;
}

GivenUpRows DeleteGivenUp(Connection& connection, const std::string& name, const LockOptions& lock) {
  LockAtlas(connection, name, lock);
  const std::optional<Named> named = Catalog(connection).Newest(name);
  if (!named) return {};
  const Partition partition = HoldPartition(connection, named->atlas, lock);
  const std::uint64_t undone = UndoUnfinished(connection, partition, named->atlas, named->newest);
  GivenUpRows deleted = DeleteAllBut(connection, named->atlas, Catalog(connection).Numbers(named->atlas));
  deleted.rows += undone;
  return deleted;
}

}  // namespace slamdb::postgresql
