// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/store_format.h"

#include <filesystem>

#include "slamdb/formats/sqlite/detail/identity.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/store.h"

namespace slamdb {
namespace {

constexpr std::string_view kSuffixes[] = {".slamdb", ".db", ".sqlite", ".sqlite3"};
constexpr std::string_view kDefaultName = "atlas";

bool Sniff(const Probe& probe) {
  const sqlite::Header header = sqlite::HeaderOf(probe.head);
  return header.is_sqlite && header.application_id == sqlite::kApplicationId;
}

Atlas Read(const Location& location, const ReadOptions& options, Notices&) {
  Store store = Store::Open(location.path, options.lock_timeout);
  return store.Load(location.name.empty() ? store.OnlyName() : location.name, options);
}

void Write(const Atlas& atlas, const Location& location, const WriteOptions& options, Notices& notices) {
  Store store = Store::OpenForWriting(location.path, {.sync = options.sync, .lock_timeout = options.lock_timeout});
  const std::vector<StoredAtlas> stored = store.List();
  std::string name = location.name;
  if (name.empty()) name = stored.empty() ? std::string(kDefaultName) : store.OnlyName();
  for (const StoredAtlas& other : stored) {
    if (other.name == name && !options.overwrite) {
      throw Error(location.path, "", "holds an atlas named '" + name + "' already; use --overwrite to replace it");
    }
  }
  const SaveReport report = store.Save(
      name, atlas, {.provenance = options.provenance, .threads = options.threads, .progress = options.progress});
  if (!report.replaced) return;
  const TableChanges rows = report.Total();
  notices.Note("replaced atlas '" + name + "': " + std::to_string(rows.inserted) + " rows new, " +
               std::to_string(rows.updated) + " changed, " + std::to_string(rows.deleted) + " removed, " +
               std::to_string(rows.unchanged) + " as they were");
}

}  // namespace

const Format kStoreFormat = {
    .id = "store",
    .title = "slamdb store (SQLite), several atlases with history in one file",
    .suffixes = kSuffixes,
    .reads = kEverything,
    .writes = kEverything,
    .sniff = &Sniff,
    .read = &Read,
    .write = &Write,
};

}  // namespace slamdb
