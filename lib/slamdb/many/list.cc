// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/list.h"

#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/report.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/sqlite/options.h"
#include "slamdb/formats/sqlite/store.h"
#include "slamdb/many/names.h"

namespace slamdb {
namespace {

// What a store tells of its atlases, and which of them match.
struct StoreRows {
  std::map<std::string, StoredAtlas> atlases;
  std::set<std::string> matching;
  std::string failure;
};

using Stores = std::map<std::string, StoreRows>;

StoreRows ReadStore(const std::string& path, const ListOptions& options) {
  StoreRows rows;
  try {
    Store store = Store::Open(path, options.lock_timeout);
    for (StoredAtlas& atlas : store.List()) rows.atlases.emplace(atlas.name, std::move(atlas));
    for (std::string& name : store.Find(options.query)) rows.matching.insert(std::move(name));
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
    if (IsStored(input) && HoldsNamedAtlases(input.location.path) && !stores.contains(input.location.path))
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
  Lister(const ListOptions& options, const Stores& stores, std::size_t count)
      : options_(options), stores_(stores), count_(count) {
    // What is left to one atlas when several are read at a time.
    threads_ = std::max(1, detail::ThreadCount(options.threads) / static_cast<int>(std::max<std::size_t>(count, 1)));
  }

  // Nothing when it does not match.
  std::optional<ListedAtlas> List(const AtlasInput& input) {
    ListedAtlas atlas{.input = input.location.ToString(), .name = NameOf(input.location), .failure = input.failure};
    bool matches = true;
    if (atlas.failure.empty()) {
      try {
        const auto store = stores_.find(input.location.path);
        matches = store != stores_.end() && !input.location.name.empty() ? ListStored(input, store->second, atlas)
                                                                         : ListFile(input, atlas);
      } catch (const Error& error) {
        atlas.failure = error.what();
      }
    }
    if (!atlas.failure.empty() && options_.check) atlas.verdict = Verdict({.failure = atlas.failure});
    Report();
    return matches ? std::optional(std::move(atlas)) : std::nullopt;
  }

 private:
  ReadOptions ReadOptionsOf() const {
    ReadOptions read{.format = options_.format, .features = FeatureColumns::kGeometry, .threads = threads_};
    if (options_.check) read.features = FeatureColumns::kAll;
    read.needs = Content::kPoints | Content::kLandmarks;
    read.of<StoreReadOptions>().lock_timeout = options_.lock_timeout;
    read.of<Orbslam3ReadOptions>().layout = options_.layout;
    if (options_.progress) read.progress = [this](std::string_view, double) { Tell(); };
    return read;
  }

  bool ListStored(const AtlasInput& input, const StoreRows& store, ListedAtlas& atlas) const {
    if (!store.failure.empty()) throw Error(ErrorKind::kDamaged, store.failure);
    const auto stored = store.atlases.find(input.location.name);
    if (stored == store.atlases.end()) {  // the reader knows what there is instead
      (void)ReadAtlas(input.location, ReadOptionsOf());
      return true;
    }
    if (!store.matching.contains(input.location.name)) return false;
    Describe(stored->second, atlas);
    if (!stored->second.problem.empty()) {
      atlas.bytes.reset();  // which the same row tells
      throw Error(ErrorKind::kDamaged, atlas.input, "table atlas",
                  "tells of " + stored->second.problem + ": edited outside slamdb, or damaged");
    }
    if (options_.check) Check(ReadAtlas(input.location, ReadOptionsOf()), *options_.check, threads_, atlas);
    return true;
  }

  bool ListFile(const AtlasInput& input, ListedAtlas& atlas) const {
    if (input.location.path != "-") DescribeFile(input.location.path, atlas);
    const HeldSource held = HoldInput(input.location, ReadOptionsOf());
    if (const Format* format = options_.format.empty() ? FindFormatOfInput(held) : &FormatById(options_.format))
      atlas.format = format->id;
    if (held.source().memory) atlas.bytes = held.source().memory->size();
    const Atlas whole = ReadAtlas(held, ReadOptionsOf());
    if (!Matches(whole, options_.query)) return false;
    atlas.summary = Summarize(whole);
    if (options_.check) Check(whole, *options_.check, threads_, atlas);
    return true;
  }

  // Throws what the listener throws, to end the work.
  void Tell() const {
    const std::lock_guard lock(mutex_);
    options_.progress(std::to_string(done_) + " of " + std::to_string(count_),
                      static_cast<double>(done_) / static_cast<double>(count_));
  }
  void Report() {
    if (!options_.progress) return;
    {
      const std::lock_guard lock(mutex_);
      ++done_;
    }
    Tell();
  }

  const ListOptions& options_;
  const Stores& stores_;
  const std::size_t count_;
  int threads_ = 1;
  mutable std::mutex mutex_;
  std::size_t done_ = 0;
};

}  // namespace

std::vector<ListedAtlas> ListAtlases(const AtlasInputs& inputs, const ListOptions& options) {
  const Stores stores = ReadStores(inputs, options);
  std::vector<std::optional<ListedAtlas>> found(inputs.atlases.size());
  Lister lister(options, stores, found.size());
  detail::ParallelFor(found.size(), 1, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) found[i] = lister.List(inputs.atlases[i]);
  });
  std::vector<ListedAtlas> atlases;
  for (std::optional<ListedAtlas>& atlas : found)
    if (atlas) atlases.push_back(std::move(*atlas));
  return atlases;
}

}  // namespace slamdb
