// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/revisions.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rows/detail/ancestry.h"
#include "slamdb/formats/rows/detail/find_revision.h"
#include "slamdb/formats/sqlite/detail/pictures.h"

namespace slamdb::sqlite {
namespace {

class Catalog : public rows::RevisionCatalog {
 public:
  explicit Catalog(Database& database) : database_(database) {}

  const std::string& path() const override { return database_.path(); }
  std::vector<std::string> Names() override { return NamesOf(database_); }
  std::optional<Named> Newest(std::string_view name) override {
    Statement select(database_, "SELECT row, revision FROM atlas WHERE name = ?1", "table atlas");
    if (!select.BindText(1, name).Step()) return std::nullopt;
    return Named{select.Integer(0), std::string(name), select.Integer(1), select.Integer(1)};
  }
  std::vector<std::int64_t> Numbers(std::int64_t atlas) override {
    Statement select(database_, "SELECT number FROM revision WHERE atlas = ?1 ORDER BY number", "table revision");
    return select.Bind(1, atlas).Integers();
  }
  bool HasNumber(std::int64_t atlas, std::int64_t number) override {
    Statement select(database_, "SELECT 1 FROM revision WHERE atlas = ?1 AND number = ?2", "table revision");
    return select.Bind(1, atlas).Bind(2, number).Step();
  }
  std::optional<std::int64_t> LastBy(std::int64_t atlas, const std::string& time) override {
    Statement select(
        database_,
        "SELECT number FROM revision JOIN history ON history.row = history WHERE revision.atlas = ?1 AND at <= ?2 "
        "ORDER BY number DESC LIMIT 1",
        "table revision");
    return FirstOf(select.Bind(1, atlas).BindText(2, time));
  }
  std::optional<std::int64_t> Tagged(std::int64_t atlas, std::string_view tag) override {
    Statement select(database_, "SELECT number FROM tag WHERE atlas = ?1 AND name = ?2", "table tag");
    return FirstOf(select.Bind(1, atlas).BindText(2, tag));
  }
  std::vector<std::string> Tags(std::int64_t atlas) override {
    Statement select(database_, "SELECT name FROM tag WHERE atlas = ?1 ORDER BY name", "table tag");
    select.Bind(1, atlas);
    std::vector<std::string> tags;
    while (select.Step()) tags.push_back(select.Text(0));
    return tags;
  }

 private:
  static std::optional<std::int64_t> FirstOf(Statement& select) {
    return select.Step() ? std::optional(select.Integer(0)) : std::nullopt;
  }

  Database& database_;
};

// What revisions of other atlases were made of: name of the atlas, number, hash.
using Sources = std::set<std::tuple<std::string, std::int64_t, std::int64_t>>;

Sources SourcesIn(Database& database) {
  Statement select(database,
                   "SELECT from_atlas, from_number, from_hash FROM revision JOIN atlas ON atlas.row = revision.atlas "
                   "WHERE from_atlas <> name",
                   "table revision");
  Sources sources;
  while (select.Step()) sources.emplace(select.Text(0), select.Integer(1), select.Integer(2));
  return sources;
}

// The numbers that stay, ascending. What the log has lost counts as saved long ago.
std::vector<std::int64_t> KeptOf(Database& database, const Named& atlas, const Sources& sources,
                                 const GiveUpOptions& options) {
  Statement select(
      database,
      "SELECT number, at, coalesce(from_atlas <> ?2, 0) OR number IN (SELECT number FROM tag WHERE atlas = ?1), "
      "history.hash, iif(from_atlas = ?2, from_number, 0) FROM revision LEFT JOIN history ON history.row = history "
      "WHERE revision.atlas = ?1 ORDER BY number",
      "table revision");
  select.Bind(1, atlas.atlas).BindText(2, atlas.name);
  std::vector<rows::KeptRevision> all;
  while (select.Step()) {
    const bool is_source = sources.contains({atlas.name, select.Integer(0), select.Integer(3)});
    all.push_back({select.Integer(0), select.Text(1), select.Integer(2) != 0 || is_source, select.Integer(4)});
  }
  return rows::KeptOf(all, options);
}

// Of several changes of the same part the earliest tells what it was in the revision before all of them.
void MergePast(Database& database, std::int64_t atlas, std::int64_t first, std::int64_t last) {
  constexpr std::int64_t kMerged = 0;  // until it has its number
  Statement move(database, "UPDATE OR IGNORE past SET until = ?3 WHERE atlas = ?1 AND until = ?2", "table past");
  Statement remove(database, "DELETE FROM past WHERE atlas = ?1 AND until = ?2", "table past");
  for (std::int64_t until = first; until <= last; ++until) {
    move.Bind(1, atlas).Bind(2, until).Bind(3, kMerged).Run();
    remove.Bind(1, atlas).Bind(2, until).Run();
  }
  move.Bind(1, atlas).Bind(2, kMerged).Bind(3, last).Run();
}

std::uint64_t FreeBytes(Database& database) {
  return static_cast<std::uint64_t>(database.Integer("PRAGMA freelist_count") * database.Integer("PRAGMA page_size"));
}

void GiveUpAllBut(Database& database, const Named& atlas, const std::vector<std::int64_t>& kept) {
  Statement older(database, "DELETE FROM past WHERE atlas = ?1 AND until <= ?2", "table past");
  older.Bind(1, atlas.atlas).Bind(2, kept.front()).Run();
  for (std::size_t i = 1; i < kept.size(); ++i)
    if (kept[i] > kept[i - 1] + 1) MergePast(database, atlas.atlas, kept[i - 1] + 1, kept[i]);
  Statement remove(database, "DELETE FROM revision WHERE atlas = ?1 AND number = ?2", "table revision");
  for (const std::int64_t number : Catalog(database).Numbers(atlas.atlas))
    if (!std::ranges::binary_search(kept, number)) remove.Bind(1, atlas.atlas).Bind(2, number).Run();
}

std::uint64_t Unsigned(const Statement& statement, int column) {
  return static_cast<std::uint64_t>(statement.Integer(column));
}

std::int64_t Signed(std::uint64_t value) { return static_cast<std::int64_t>(value); }

// An atlas and its newest revision.
struct Head {
  std::int64_t row = 0;
  std::string name;
  RevisionChain::Link newest;
};

std::vector<Head> HeadsOf(Database& database, const ChainQuery& query) {
  std::vector<Head> heads;
  Statement select(database,
                   query.names.empty()
                       ? "SELECT row, name, revision, hash FROM atlas WHERE name > ?1 ORDER BY name LIMIT ?2"
                       : "SELECT row, name, revision, hash FROM atlas WHERE name > ?1 AND name = ?3 LIMIT ?2",
                   "table atlas");
  select.BindText(1, query.after).Bind(2, static_cast<std::int64_t>(query.count));
  const auto take = [&] {
    while (select.Step())
      heads.push_back({select.Integer(0), select.Text(1), {Unsigned(select, 2), Unsigned(select, 3)}});
    select.Reset();
  };
  if (query.names.empty()) take();
  for (const std::string& name : query.names) {
    select.BindText(3, name);
    take();
  }
  std::ranges::sort(heads, {}, &Head::name);
  if (heads.size() > query.count) heads.resize(query.count);
  return heads;
}

// In one go through the log, as no index leads to what it tells of an atlas. What it tells of one that was removed
// means nothing to the next of that name.
void AddGivenUp(Database& database, std::vector<RevisionChain>& chains) {
  Statement log(database,
                "SELECT atlas, coalesce(revision, 0), coalesce(hash, 0), action = 'remove' FROM history WHERE atlas IS "
                "NOT NULL AND (revision > 0 OR action = 'remove') ORDER BY row",
                "table history");
  while (log.Step()) {
    const std::string name = log.Text(0);
    const auto chain = std::ranges::lower_bound(chains, name, {}, &RevisionChain::name);
    if (chain == chains.end() || chain->name != name) continue;
    const RevisionChain::Link link{Unsigned(log, 1), Unsigned(log, 2)};
    if (log.Integer(3) != 0)
      chain->given_up.clear();
    else if (!std::ranges::binary_search(chain->links, link.number, {}, &RevisionChain::Link::number))
      chain->given_up.push_back(link);
  }
  for (RevisionChain& chain : chains) std::ranges::sort(chain.given_up, {}, &RevisionChain::Link::number);
}

}  // namespace

std::vector<std::string> NamesOf(Database& database) {
  std::vector<std::string> names;
  Statement select(database, "SELECT name FROM atlas ORDER BY name", "table atlas");
  while (select.Step()) names.push_back(select.Text(0));
  return names;
}

Named Find(Database& database, std::string_view text) {
  Catalog catalog(database);
  return rows::FindRevision(catalog, text);
}

Named Find(Database& database, const RevisionName& revision) {
  Catalog catalog(database);
  return rows::FindRevision(catalog, revision);
}

std::vector<RevisionChain> ReadChains(Database& database, const ChainQuery& query) {
  std::vector<RevisionChain> chains;
  for (const Head& head : HeadsOf(database, query)) {
    RevisionChain& chain = chains.emplace_back(RevisionChain{.name = head.name});
    Statement links(
        database,
        "SELECT number, coalesce(history.hash, iif(number = ?2, ?3, 0)), from_hash FROM revision LEFT JOIN history ON "
        "history.row = history WHERE revision.atlas = ?1 ORDER BY number",
        "table revision");
    links.Bind(1, head.row).Bind(2, Signed(head.newest.number)).Bind(3, Signed(head.newest.hash));
    while (links.Step()) chain.links.push_back({Unsigned(links, 0), Unsigned(links, 1), Unsigned(links, 2)});
    if (chain.links.empty() || chain.links.back().number != head.newest.number) chain.links.push_back(head.newest);
    Statement tags(database, "SELECT name, number FROM tag WHERE atlas = ?1 ORDER BY name", "table tag");
    tags.Bind(1, head.row);
    while (tags.Step()) chain.tags.push_back({tags.Text(0), Unsigned(tags, 1)});
  }
  if (query.given_up) AddGivenUp(database, chains);
  return chains;
}

void AddRevision(Database& database, std::int64_t atlas, std::int64_t history,
                 const std::optional<RevisionName>& from) {
  Statement insert(database,
                   "INSERT OR REPLACE INTO revision SELECT row, revision, ?2, ?3, ?4, ?5 FROM atlas WHERE row = ?1",
                   "table revision");
  insert.Bind(1, atlas).Bind(2, history);
  if (from)
    insert.BindText(3, from->atlas)
        .Bind(4, static_cast<std::int64_t>(from->number))
        .Bind(5, static_cast<std::int64_t>(from->hash));
  insert.Run();
}

std::optional<std::int64_t> HashOfRevision(Database& database, std::int64_t atlas, std::int64_t number) {
  Statement select(
      database,
      "SELECT hash FROM revision JOIN history ON history.row = history WHERE revision.atlas = ?1 AND number "
      "= ?2",
      "table revision");
  if (!select.Bind(1, atlas).Bind(2, number).Step()) return std::nullopt;
  return select.Integer(0);
}

RevisionName NameOf(Database& database, const Named& named) {
  const std::int64_t hash = HashOfRevision(database, named.atlas, named.number).value_or(0);
  return {named.name, static_cast<std::uint64_t>(named.number), static_cast<std::uint64_t>(hash)};
}

void SetTag(Database& database, const Named& named, const std::string& tag) {
  Statement insert(database, "INSERT INTO tag VALUES (?1, ?2, ?3) ON CONFLICT DO NOTHING RETURNING 1", "table tag");
  if (insert.Bind(1, named.atlas).BindText(2, tag).Bind(3, named.number).Step()) {
    insert.Run();
    return;
  }
  Statement select(database, "SELECT number FROM tag WHERE atlas = ?1 AND name = ?2", "table tag");
  select.Bind(1, named.atlas).BindText(2, tag).Step();
  if (select.Integer(0) == named.number) return;
  throw rows::TagIsTaken(database.path(), named.name, tag, select.Integer(0));
}

void RemoveTag(Database& database, const Named& named, const std::string& tag) {
  Statement remove(database, "DELETE FROM tag WHERE atlas = ?1 AND name = ?2", "table tag");
  remove.Bind(1, named.atlas).BindText(2, tag).Run();
  if (sqlite3_changes(database.handle()) > 0) return;
  throw rows::NoSuchTag(database.path(), named.name, tag, Catalog(database).Tags(named.atlas));
}

GiveUpReport GiveUp(Database& database, const std::string& atlas, const GiveUpOptions& options) {
  GiveUpReport report;
  const std::uint64_t before = FreeBytes(database);
  std::vector<Named> atlases;
  {
    Statement select(database, "SELECT row, name, revision FROM atlas WHERE ?1 = '' OR name = ?1 ORDER BY name",
                     "table atlas");
    select.BindText(1, atlas);
    while (select.Step()) atlases.push_back({select.Integer(0), select.Text(1), select.Integer(2), select.Integer(2)});
  }
  if (atlases.empty() && !atlas.empty()) Find(database, atlas);  // which names those that there are
  const Sources sources = SourcesIn(database);
  for (const Named& each : atlases) {
    const std::vector<std::int64_t> kept = KeptOf(database, each, sources, options);
    std::vector<std::int64_t> gone;
    std::ranges::set_difference(Catalog(database).Numbers(each.atlas), kept, std::back_inserter(gone));
    report.atlases.push_back({each.name, {gone.begin(), gone.end()}, kept.size()});
    if (gone.empty() || kept.empty()) continue;
    const std::vector<std::int64_t> pictures = PicturesOf(database, each.atlas);
    GiveUpAllBut(database, each, kept);
    report.pictures += DeleteUnused(database, pictures);
  }
  const std::uint64_t after = FreeBytes(database);
  report.bytes = after - std::min(before, after);
  return report;
}

std::optional<RevisionName> FindBase(Database& database, const Named& first, const Named& second) {
  // Of the two, and of all that these were made of.
  Statement select(
      database,
      "WITH RECURSIVE family (name) AS (SELECT ?1 UNION SELECT ?2 UNION SELECT from_atlas FROM family JOIN atlas USING "
      "(name) JOIN revision ON revision.atlas = atlas.row WHERE from_atlas IS NOT NULL) SELECT name, number, "
      "history.hash, history, from_atlas, from_number, from_hash FROM family JOIN atlas USING (name) JOIN revision ON "
      "revision.atlas = atlas.row JOIN history ON history.row = history ORDER BY name, number",
      "table revision");
  select.BindText(1, first.name).BindText(2, second.name);
  std::vector<rows::RevisionOf> all;
  while (select.Step()) all.push_back(rows::RevisionOfRow(select));
  return rows::CommonBase(all, first, second);
}

}  // namespace slamdb::sqlite
