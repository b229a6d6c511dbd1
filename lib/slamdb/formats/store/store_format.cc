// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/store/detail/store_format.h"

#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/formats/sqlite/detail/files_beside.h"
#include "slamdb/formats/sqlite/detail/identity.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/salvage.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kSuffixes[] = {".slamdb", ".db", ".sqlite", ".sqlite3"};
constexpr std::string_view kDefaultName = "atlas";

// The first page, which says what a database is, may be in the log alone: until the first checkpoint, which a killed
// program does not reach.
bool IsStoreByItsLog(const std::string& path) {
  if (!sqlite::HasContent(sqlite::FilesBeside(path).log)) return false;
  try {
    return sqlite::Database(path, sqlite::Access::kSalvage, 0).Integer("PRAGMA application_id") ==
           sqlite::kApplicationId;
  } catch (const Error&) {
    return false;
  }
}

bool Sniff(const Probe& probe) {
  const sqlite::Header header = sqlite::HeaderOf(probe.head);
  if (!header.is_sqlite) return false;
  return header.application_id == sqlite::kApplicationId || (!probe.memory && IsStoreByItsLog(probe.path));
}

void RefuseMemory(bool is_memory, const std::string& path) {
  if (is_memory)
    throw Error(ErrorKind::kNotPossible, path, "",
                "a store is a file, which is neither read from memory nor written to it");
}

Atlas Read(const Source& source, const ReadOptions& options, Notices&) {
  RefuseMemory(source.memory.has_value(), source.path);
  Store store = Store::Open(source.path, options.of<StoreReadOptions>().lock_timeout);
  return store.Load(source.name.empty() ? store.OnlyName() : source.name, options);
}

void Write(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  RefuseMemory(target.sink != nullptr, target.path);
  const StoreWriteOptions& how = options.of<StoreWriteOptions>();
  EnterOutput(target.path, "");  // as a store, before it is made; which of its atlases is seen when that is known
  Store store = Store::OpenForWriting(
      target.path, {.sync = options.sync, .lock_timeout = how.lock_timeout, .progress = options.progress});
  const std::vector<std::string> stored = target.name.empty() ? store.Names() : std::vector<std::string>();
  if (!stored.empty() && !options.overwrite)
    throw Error(ErrorKind::kAlreadyExists, target.path, "",
                "holds atlases already; name the new one, as " + target.path + "#NAME");
  std::string name = target.name;
  if (name.empty()) name = stored.empty() ? std::string(kDefaultName) : store.OnlyName();
  const SaveReport report = store.Save(name, atlas,
                                       {.provenance = how.provenance,
                                        .overwrite = options.overwrite,
                                        .verify = true,
                                        .from = how.from,
                                        .onto = how.onto,
                                        .before_commit = options.before_commit,
                                        .threads = options.threads,
                                        .progress = options.progress});
  if (report.unchanged) return notices.Note("atlas '" + name + "' is there as it is: no new revision");
  if (!report.replaced) return;
  const TableChanges rows = report.Total();
  notices.Note("replaced atlas '" + name + "': " + std::to_string(rows.inserted) + " rows new, " +
               std::to_string(rows.updated) + " changed, " + std::to_string(rows.deleted) + " removed, " +
               std::to_string(rows.unchanged) + " as they were");
}

Salvage SalvageOne(const Source& source, const ReadOptions& options) {
  RefuseMemory(source.memory.has_value(), source.path);
  return SalvageStore(source.path, source.name, options);
}

}  // namespace

const Format kStoreFormat = {
    .id = "store",
    .title = "slamdb store (a SQLite file, a PostgreSQL database), several atlases with history",
    .suffixes = kSuffixes,
    .kind = FileKind::kBinary,
    .named = true,
    .keeps_encoding = true,
    .reads = Content::kEverything,
    .writes = Content::kEverything,
    .sniff = &Sniff,
    .read = &Read,
    .write = &Write,
    .salvage = &SalvageOne,
};

}  // namespace slamdb::detail
