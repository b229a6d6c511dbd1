// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/revisions.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <deque>
#include <iterator>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/formats/sqlite/detail/pictures.h"
#include "slamdb/formats/sqlite/store.h"

namespace slamdb {

bool IsNameOfTag(const std::string& name) {
  return IsNameOfAtlas(name) && name.find_first_of("@{}") == std::string::npos &&
         !sqlite::LooksLikeRevision("@" + name);
}

}  // namespace slamdb

namespace slamdb::sqlite {
namespace {

using detail::Concat;

struct Split {
  std::string_view name, which;
};

// At the last @; nothing when there is none.
std::optional<Split> SplitName(std::string_view text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string_view::npos) return std::nullopt;
  return Split{text.substr(0, at), text.substr(at + 1)};
}

std::optional<std::int64_t> NumberOf(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return number;
}

bool IsDate(std::string_view which) { return which.size() > 2 && which.front() == '{' && which.back() == '}'; }

// The last moment of what is in braces: of a day, a minute or a second. Nothing when it is no time.
std::optional<std::string> EndOf(std::string_view which) {
  std::string time(which.substr(1, which.size() - 2));
  if (time.ends_with('Z')) time.pop_back();
  if (time.size() > 10 && time[10] == ' ') time[10] = 'T';
  constexpr std::string_view kLast = "9999-12-31T23:59:59";
  if (time.size() != 10 && time.size() != 16 && time.size() != kLast.size()) return std::nullopt;
  time += std::string(kLast.substr(time.size())) + "Z";
  if (!detail::ParseDateTime(time, {})) return std::nullopt;
  return time;
}

std::optional<Named> FindNewest(Database& database, std::string_view name) {
  Statement select(database, "SELECT row, revision FROM atlas WHERE name = ?1", "table atlas");
  if (!select.BindText(1, name).Step()) return std::nullopt;
  return Named{select.Integer(0), std::string(name), select.Integer(1), select.Integer(1)};
}

std::vector<std::int64_t> NumbersOf(Database& database, std::int64_t atlas) {
  Statement select(database, "SELECT number FROM revision WHERE atlas = ?1 ORDER BY number", "table revision");
  return select.Bind(1, atlas).Integers();
}

// `2, 5 to 9`.
std::string Ranges(const std::vector<std::int64_t>& numbers) {
  std::string text;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += Concat(text.empty() ? "" : ", ", numbers[first]);
    if (last > first) text += Concat(last == first + 1 ? ", " : " to ", numbers[last]);
    first = last + 1;
  }
  return text;
}

std::vector<std::string> TagsOf(Database& database, std::int64_t atlas) {
  Statement select(database, "SELECT name FROM tag WHERE atlas = ?1 ORDER BY name", "table tag");
  select.Bind(1, atlas);
  std::vector<std::string> tags;
  while (select.Step()) tags.push_back(select.Text(0));
  return tags;
}

Error NotFound(Database& database, const Named& of, std::string_view which, std::string_view why = {}) {
  std::string known = "; it has " + Ranges(NumbersOf(database, of.atlas));
  const std::vector<std::string> tags = TagsOf(database, of.atlas);
  for (const std::string& tag : tags) known += (&tag == tags.data() ? ", tagged " : ", ") + tag;
  return Error(ErrorKind::kNotFound, database.path(), "",
               Concat("no revision '", which, "' of '", of.name, "'", why, known));
}

// What stands behind the @ of an atlas.
std::int64_t NumberIn(Database& database, const Named& newest, std::string_view which) {
  if (IsDate(which)) {
    const std::optional<std::string> end = EndOf(which);
    if (!end)
      throw Error(
          ErrorKind::kUsage, database.path(), "",
          Concat("'", which, "' is no date: expected {2026-11-20}, {2026-11-20T08:30} or {2026-11-20T08:30:15}, UTC"));
    Statement select(
        database,
        "SELECT max(number) FROM revision JOIN history ON history.row = history WHERE revision.atlas = ?1 AND "
        "at <= ?2",
        "table revision");
    if (!select.Bind(1, newest.atlas).BindText(2, *end).Step() || select.IsNull(0))
      throw NotFound(database, newest, which, ": none that is left was saved by then");
    return select.Integer(0);
  }
  if (const std::optional<std::int64_t> number = NumberOf(which))
    return *number < 0 ? newest.newest + *number : *number;
  Statement select(database, "SELECT number FROM tag WHERE atlas = ?1 AND name = ?2", "table tag");
  if (!select.Bind(1, newest.atlas).BindText(2, which).Step()) throw NotFound(database, newest, which);
  return select.Integer(0);
}

// ---- giving revisions up

std::string DaysAgo(double days) {
  const auto now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return detail::DateTimeText(std::max(0.0, std::floor(now - days * 86400))).value_or("");
}

// The numbers that stay, ascending.
std::vector<std::int64_t> KeptOf(Database& database, const Named& atlas, const GiveUpOptions& options) {
  Statement select(
      database,
      "SELECT number FROM revision JOIN history ON history.row = history WHERE revision.atlas = ?1 AND ("
      "number >= ?2 OR at >= ?3 OR from_hash IS NOT NULL OR number IN (SELECT number FROM tag WHERE atlas = ?1) OR "
      "number IN (SELECT from_number FROM revision AS other WHERE other.from_atlas = ?4 AND other.from_hash "
      "= history.hash)) ORDER BY number",
      "table revision");
  const std::string since = options.keep_days ? DaysAgo(*options.keep_days) : std::string("9999");
  const std::vector<std::int64_t> numbers = NumbersOf(database, atlas.atlas);
  const std::size_t last =
      std::min<std::uint64_t>(std::max<std::uint64_t>(options.keep.value_or(1), 1), numbers.size());
  if (numbers.empty()) return {};
  return select.Bind(1, atlas.atlas)
      .Bind(2, numbers[numbers.size() - last])
      .BindText(3, since)
      .BindText(4, atlas.name)
      .Integers();
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
  for (const std::int64_t number : NumbersOf(database, atlas.atlas))
    if (!std::ranges::binary_search(kept, number)) remove.Bind(1, atlas.atlas).Bind(2, number).Run();
}

}  // namespace

std::string AllNames(Database& database) {
  std::string names;
  Statement select(database, "SELECT name FROM atlas ORDER BY name", "table atlas");
  while (select.Step()) names += (names.empty() ? "; it holds " : ", ") + select.Text(0);
  return names.empty() ? "; the store is empty" : names;
}

Named Find(Database& database, std::string_view text) {
  if (std::optional<Named> whole = FindNewest(database, text)) return *whole;
  const std::optional<Split> split = SplitName(text);
  std::optional<Named> named = split ? FindNewest(database, split->name) : std::nullopt;
  if (!named)
    throw Error(ErrorKind::kNotFound, database.path(), "",
                Concat("no atlas named '", split ? split->name : text, "'", AllNames(database)));
  named->number = NumberIn(database, *named, split->which);
  Statement select(database, "SELECT 1 FROM revision WHERE atlas = ?1 AND number = ?2", "table revision");
  const bool is_known = select.Bind(1, named->atlas).Bind(2, named->number).Step();
  if (!is_known && !named->is_newest()) throw NotFound(database, *named, split->which);
  return *named;
}

bool LooksLikeRevision(std::string_view name) {
  const std::optional<Split> split = SplitName(name);
  return split && (IsDate(split->which) || NumberOf(split->which));
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
  throw Error(ErrorKind::kAlreadyExists, database.path(), "",
              Concat("revision ", select.Integer(0), " of '", named.name, "' has the tag '", tag,
                     "' already: remove it there first"));
}

void RemoveTag(Database& database, const Named& named, const std::string& tag) {
  Statement remove(database, "DELETE FROM tag WHERE atlas = ?1 AND name = ?2", "table tag");
  remove.Bind(1, named.atlas).BindText(2, tag).Run();
  if (sqlite3_changes(database.handle()) > 0) return;
  std::string known;
  for (const std::string& each : TagsOf(database, named.atlas)) known += (known.empty() ? "; it has " : ", ") + each;
  throw Error(ErrorKind::kNotFound, database.path(), "", Concat("no tag '", tag, "' of '", named.name, "'", known));
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
  for (const Named& each : atlases) {
    const std::vector<std::int64_t> kept = KeptOf(database, each, options);
    std::vector<std::int64_t> gone;
    std::ranges::set_difference(NumbersOf(database, each.atlas), kept, std::back_inserter(gone));
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

namespace {

// A revision. One that is an earlier one of its atlas again, as after a restore, is that.
struct Ancestor {
  std::string atlas;
  std::int64_t number = 0, hash = 0;
  auto operator<=>(const Ancestor&) const = default;
};

// Which revisions those of a store were made of.
class Ancestry {
 public:
  explicit Ancestry(Database& database)
      : find_(
            database,
            "SELECT first.number, history.hash FROM atlas JOIN revision AS asked ON asked.atlas = atlas.row JOIN "
            "history "
            "ON history.row = asked.history JOIN revision AS first ON first.atlas = atlas.row JOIN history AS of_first "
            "ON "
            "of_first.row = first.history WHERE atlas.name = ?1 AND asked.number = ?2 AND of_first.hash = history.hash "
            "AND first.number <= ?2 ORDER BY first.number LIMIT 1",
            "table revision"),
        parents_(database,
                 "SELECT from_atlas, from_number, from_hash, (SELECT max(number) FROM revision AS earlier WHERE "
                 "earlier.atlas = revision.atlas AND earlier.number < revision.number) FROM revision JOIN atlas ON "
                 "atlas.row = revision.atlas WHERE atlas.name = ?1 AND number = ?2",
                 "table revision") {}

  // Nothing when it cannot be read any more, or another atlas has the name by now.
  std::optional<Ancestor> Find(const std::string& atlas, std::int64_t number, std::optional<std::int64_t> hash = {}) {
    find_.Reset();
    if (!find_.BindText(1, atlas).Bind(2, number).Step()) return std::nullopt;
    if (hash && *hash != find_.Integer(1)) return std::nullopt;
    return Ancestor{atlas, find_.Integer(0), find_.Integer(1)};
  }
  std::vector<Ancestor> ParentsOf(const Ancestor& of) {
    std::vector<Ancestor> parents;
    const auto add = [&](std::optional<Ancestor> parent) {
      if (parent) parents.push_back(std::move(*parent));
    };
    parents_.Reset();
    if (!parents_.BindText(1, of.atlas).Bind(2, of.number).Step()) return parents;
    if (!parents_.IsNull(3)) add(Find(of.atlas, parents_.Integer(3)));
    if (!parents_.IsNull(0)) add(Find(parents_.Text(0), parents_.Integer(1), parents_.Integer(2)));
    return parents;
  }
  // The revision itself and all that it was made of, nearest first.
  std::vector<Ancestor> Of(const Named& named) {
    std::vector<Ancestor> all;
    std::set<Ancestor> seen;
    std::deque<Ancestor> waiting;
    if (std::optional<Ancestor> self = Find(named.name, named.number)) waiting.push_back(std::move(*self));
    while (!waiting.empty()) {
      Ancestor next = std::move(waiting.front());
      waiting.pop_front();
      if (!seen.insert(next).second) continue;
      std::ranges::copy(ParentsOf(next), std::back_inserter(waiting));
      all.push_back(std::move(next));
    }
    return all;
  }

 private:
  Statement find_, parents_;
};

}  // namespace

std::optional<RevisionName> FindBase(Database& database, const Named& first, const Named& second) {
  Ancestry ancestry(database);
  const std::vector<Ancestor> others = ancestry.Of(second);
  const std::set<Ancestor> of_second(others.begin(), others.end());
  std::vector<Ancestor> common;
  for (const Ancestor& each : ancestry.Of(first))
    if (of_second.contains(each)) common.push_back(each);
  // What a common one was made of is common, too, and lies behind it.
  std::set<Ancestor> behind;
  for (const Ancestor& each : common) std::ranges::copy(ancestry.ParentsOf(each), std::inserter(behind, behind.end()));
  for (const Ancestor& each : common)
    if (!behind.contains(each))
      return RevisionName{each.atlas, static_cast<std::uint64_t>(each.number), static_cast<std::uint64_t>(each.hash)};
  return std::nullopt;
}

}  // namespace slamdb::sqlite
