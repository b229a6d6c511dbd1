// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/list.h"

#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/report.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/each.h"
#include "slamdb/many/names.h"

namespace slamdb {
namespace {

// What a store tells of its atlases, and which of them match; both by name.
struct StoreRows {
  std::vector<StoredAtlas> atlases;
  std::optional<std::vector<std::string>> matching, matching_stored;  // the queries of maps, of atlases; none: all do
  std::vector<std::string> unsearched;                                // whether these match, their server does not say
  std::string failure;

  const StoredAtlas* Find(const std::string& name) const {
    const auto found = std::ranges::lower_bound(atlases, name, {}, &StoredAtlas::name);
    return found != atlases.end() && found->name == name ? &*found : nullptr;
  }
  // What a row tells that cannot be may hide that it matches.
  bool Matches(const StoredAtlas& atlas) const {
    const auto is_among = [&](const auto& names) { return !names || std::ranges::binary_search(*names, atlas.name); };
    return is_among(matching) && (is_among(matching_stored) || !atlas.problem.empty());
  }
};

using Stores = std::map<std::string, StoreRows>;

StoreRows ReadStore(const std::string& path, const ListOptions& options) {
  StoreRows rows;
  try {
    Store store = Store::Open(path, options.lock_timeout);
    rows.atlases = store.List();
    if (!options.query.everything()) rows.matching = store.Find(options.query, &rows.unsearched);
    if (!options.stored.everything()) rows.matching_stored = store.Find(options.stored);
    // A damaged index may tell them in another order.
    if (!std::ranges::is_sorted(rows.atlases, {}, &StoredAtlas::name))
      std::ranges::sort(rows.atlases, {}, &StoredAtlas::name);
    for (auto* names : {&rows.matching, &rows.matching_stored})
      if (*names) std::ranges::sort(**names);
  } catch (const Error& error) {
    rows.failure = error.what();
  }
  return rows;
}

// Whether it is an atlas of a store, by its name; what a name behind `#` means where no store is, reading says.
bool IsStored(const AtlasInput& input) { return input.failure.empty() && !input.location.name.empty(); }

Stores ReadStores(const AtlasInputs& inputs, const ListOptions& options) {
  Stores stores;
  for (const AtlasInput& input : inputs.atlases)
    if (IsStored(input) && !stores.contains(input.location.path) && HoldsNamedAtlases(input.location.path))
      stores.emplace(input.location.path, ReadStore(input.location.path, options));
  return stores;
}

void Describe(const StoredAtlas& stored, ListedAtlas& atlas) {
  atlas.summary = stored;
  atlas.format = "store";
  atlas.bytes = stored.bytes;
  atlas.saved_at = stored.saved_at;
  atlas.revision = stored.revision;
  atlas.hash = stored.hash;
}

void DescribeFile(const std::string& path, ListedAtlas& atlas) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return;
  atlas.bytes = static_cast<std::uint64_t>(status.st_size);
  atlas.saved_at = detail::DateTimeText(static_cast<double>(status.st_mtime)).value_or("");
}

double ValueOf(const ListedAtlas& atlas, AtlasQuery::Number number) {
  const AtlasSummary& summary = atlas.summary;
  using enum AtlasQuery::Number;
  switch (number) {
    case kMaps:
      return static_cast<double>(summary.maps);
    case kKeyframes:
      return static_cast<double>(summary.keyframes);
    case kPoints:
      return static_cast<double>(summary.points);
    case kObservations:
      return static_cast<double>(summary.observations);
    case kLandmarks:
      return static_cast<double>(summary.landmarks);
    case kLength:
      return summary.trajectory_length;
    case kDuration:
      return summary.duration;
    case kBytes:
      return static_cast<double>(atlas.bytes.value_or(0));
    case kRevision:
      return 0;
  }
  return 0;
}

// Nobody has recorded who saved a file.
bool MatchesAsFile(const ListedAtlas& atlas, const AtlasQuery& query) {
  const auto holds = [&](const AtlasQuery::Range& range) {
    const double value = ValueOf(atlas, range.number);
    return value >= range.low && value <= range.high;
  };
  return query.who.empty() && query.provenance.empty() && query.tag.empty() && std::ranges::all_of(query.ranges, holds);
}

void Check(const Atlas& atlas, CheckOptions options, int threads, ListedAtlas& listed) {
  options.threads = threads;
  options.max_findings = 0;
  const CheckReport report = CheckAtlas(atlas, options);
  listed.findings = {.errors = report.Count(Severity::kError),
                     .warnings = report.Count(Severity::kWarning),
                     .notes = report.Count(Severity::kNote)};
  listed.verdict = Verdict({.report = report});
}

class Lister {
 public:
  Lister(const ListOptions& options, const Stores& stores) : options_(options), stores_(stores) {}

  // False: it does not match.
  bool List(const AtlasInput& input, const ReadOptions& read, ListedAtlas& atlas) const {
    atlas.input = input.location.ToString();
    atlas.name = NameOf(input.location);
    atlas.failure = input.failure;
    bool matches = true;
    if (atlas.failure.empty()) {
      try {
        const auto store = stores_.find(input.location.path);
        matches = store != stores_.end() && !input.location.name.empty() ? ListStored(input, store->second, read, atlas)
                                                                         : ListFile(input, read, atlas);
      } catch (const Error& error) {
        atlas.failure = error.what();
      }
    }
    if (!atlas.failure.empty() && options_.check) atlas.verdict = Verdict({.failure = atlas.failure});
    return matches;
  }

 private:
  bool ListStored(const AtlasInput& input, const StoreRows& store, const ReadOptions& read, ListedAtlas& atlas) const {
    if (!store.failure.empty()) throw Error(ErrorKind::kDamaged, store.failure);
    const StoredAtlas* stored = store.Find(input.location.name);
    if (stored == nullptr && WithoutRevision(input.location) != input.location) return ListFile(input, read, atlas);
    if (stored == nullptr) {  // the reader knows what there is instead
      (void)ReadAtlas(input.location, read);
      throw Error(ErrorKind::kDamaged, atlas.input, "table atlas",
                  "is not among the atlases that the store tells of, but is found: the store is damaged");
    }
    if (std::ranges::binary_search(store.unsearched, input.location.name))
      throw Error(ErrorKind::kLocked, atlas.input, "",
                  "was not searched: the server that has it does not answer; 'slamdb fleet status' tells more");
    if (!store.Matches(*stored)) return false;
    Describe(*stored, atlas);
    if (!stored->problem.empty()) {
      atlas.bytes.reset();  // which the same row tells
      throw Error(ErrorKind::kDamaged, atlas.input, "table atlas",
                  "tells of " + stored->problem + ": edited outside slamdb, or damaged");
    }
    if (options_.check) Check(ReadAtlas(input.location, read), *options_.check, read.threads, atlas);
    return true;
  }

  bool ListFile(const AtlasInput& input, const ReadOptions& read, ListedAtlas& atlas) const {
    if (input.location.path != "-" && input.location.name.empty()) DescribeFile(input.location.path, atlas);
    const HeldSource held = HoldInput(input.location, read);
    if (const Format* format = options_.format.empty() ? FindFormatOfInput(held) : &FormatById(options_.format))
      atlas.format = format->id;
    if (held.source().memory) atlas.bytes = held.source().memory->size();
    const Atlas whole = ReadAtlas(held, read);
    if (!Matches(whole, options_.query)) return false;
    atlas.summary = Summarize(whole);
    if (!MatchesAsFile(atlas, options_.stored)) return false;
    if (options_.check) Check(whole, *options_.check, read.threads, atlas);
    return true;
  }

  const ListOptions& options_;
  const Stores& stores_;
};

ReadOptions ReadOptionsOf(const ListOptions& options) {
  ReadOptions read{.format = options.format, .features = FeatureColumns::kGeometry, .threads = options.threads};
  if (options.check) read.features = FeatureColumns::kAll;
  read.needs = Content::kPoints | Content::kLandmarks;
  read.of<StoreReadOptions>().lock_timeout = options.lock_timeout;
  read.of<Orbslam3ReadOptions>().layout = options.layout;
  read.progress = options.progress;
  return read;
}

}  // namespace

std::vector<ListedAtlas> ListAtlases(const AtlasInputs& inputs, const ListOptions& options) {
  const Stores stores = ReadStores(inputs, options);
  std::vector<ListedAtlas> atlases(inputs.atlases.size());
  std::vector<std::uint8_t> matches(atlases.size());
  const Lister lister(options, stores);
  ForEachRow(atlases.size(), ReadOptionsOf(options), [&](std::size_t row, const ReadOptions& read) {
    matches[row] = lister.List(inputs.atlases[row], read, atlases[row]);
  });
  std::size_t kept = 0;
  for (std::size_t row = 0; row < atlases.size(); ++row) {
    if (matches[row] == 0) continue;
    if (row != kept) atlases[kept] = std::move(atlases[row]);
    ++kept;
  }
  atlases.resize(kept);
  return atlases;
}

}  // namespace slamdb
