// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/sqlite_store.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/opened_input.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/sqlite/detail/backup.h"
#include "slamdb/formats/sqlite/detail/files_beside.h"
#include "slamdb/formats/sqlite/detail/identity.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/new_store.h"
#include "slamdb/formats/sqlite/detail/past.h"
#include "slamdb/formats/sqlite/detail/places.h"
#include "slamdb/formats/sqlite/detail/revisions.h"
#include "slamdb/formats/sqlite/detail/salvage.h"
#include "slamdb/formats/sqlite/detail/save.h"
#include "slamdb/formats/sqlite/detail/statistics.h"
#include "slamdb/formats/sqlite/detail/summary.h"
#include "slamdb/formats/sqlite/detail/writer_lock.h"

namespace slamdb::sqlite {

namespace {

constexpr int kLoadAttempts = 5;    // when another program saves the same atlas again and again meanwhile
constexpr int kOpenAttempts = 100;  // when others make the store and remove it again, because their saves failed

void CheckNotStandardStream(const std::string& path) {
  if (path == "-") throw Error(ErrorKind::kUsage, path, "", "a store is a file; it cannot be standard input or output");
  if (detail::IsStream(path))
    throw Error(ErrorKind::kUsage, path, "", "a store is a file; it cannot be a FIFO, a device or a socket");
}

bool HasAtlas(Database& database, const std::string& name) {
  return Statement(database, "SELECT 1 FROM atlas WHERE name = ?1", "table atlas").BindText(1, name).Step();
}

// What is recorded of what is done now.
Recorded RecordedNow() { return {.at = TimeOfDay(), .who = Who(), .tool = ToolName()}; }

// Returns its row.
std::int64_t Record(Database& database, const char* action, const std::string& name, const std::string& provenance,
                    const TableChanges& rows, const Recorded& recorded) {
  Statement insert(
      database,
      "INSERT INTO history (at, tool, action, atlas, provenance, maps, keyframes, points, observations, hash, "
      "inserted, updated, deleted, unchanged, who) SELECT ?1, ?2, ?3, ?4, ?5, maps, keyframes, points, "
      "observations, hash, ?6, ?7, ?8, ?9, ?10 FROM atlas WHERE name = ?4",
      "table history");
  insert.BindText(1, recorded.at)
      .BindText(2, recorded.tool)
      .BindText(3, action)
      .BindText(4, name)
      .BindText(5, provenance);
  insert.Bind(6, ToColumn(rows.inserted)).Bind(7, ToColumn(rows.updated)).Bind(8, ToColumn(rows.deleted));
  insert.Bind(9, ToColumn(rows.unchanged)).BindText(10, recorded.who).Run();
  return sqlite3_last_insert_rowid(database.handle());
}

void RecordChanges(Database& database, std::int64_t history, const SaveReport& report) {
  Statement update(
      database,
      "UPDATE history SET revision = ?2, keyframes_added = ?3, keyframes_removed = ?4, keyframes_moved = ?5, "
      "points_added = ?6, points_removed = ?7, points_moved = ?8, observations_added = ?9, "
      "observations_removed = ?10 WHERE row = ?1",
      "table history");
  const MapChanges& map = report.map;
  update.Bind(1, history).Bind(2, ToColumn(report.revision));
  int column = 3;
  for (const std::uint64_t count :
       {map.keyframes_added, map.keyframes_removed, map.keyframes_moved, map.points_added, map.points_removed,
        map.points_moved, map.observations_added, map.observations_removed})
    update.Bind(column++, ToColumn(count));
  update.Run();
}

struct State {
  Database database;
  StoreOptions options;
  bool writable = false;
  bool made = false;  // by this connection, and nothing was saved yet
  // Nothing was saved there when it was opened, so that whoever made it may remove it again (RemoveUnused).
  bool opened_unused = false;

  // Opens what may be a store, once nobody is making it.
  static std::unique_ptr<State> ToRead(const std::string& path, double lock_timeout);
  // Opens the store to write, and makes it where it is missing.
  static State ToWrite(const std::string& path, const StoreOptions& options);
  // The lock for a save. Where the store was removed because the save it was made for failed, in a new one.
  WriteTransaction Lock();

  bool Has(const std::string& name) { return HasAtlas(database, name); }
  bool Holds(const std::string& name, std::int64_t hash) {
    Statement statement(database, "SELECT 1 FROM atlas WHERE name = ?1 AND hash = ?2", "table atlas");
    return statement.BindText(1, name).Bind(2, hash).Step();
  }
  // A store that was made for a save that failed goes again. Others may have come to it meanwhile: it is removed by
  // who is alone with it, holds its lock and finds it empty; a writer who still waits for that lock notices
  // (CheckStillThere).
  void RemoveUnused() noexcept {
    if (!made) return;
    try {
      database.Execute("PRAGMA journal_mode=DELETE; BEGIN EXCLUSIVE");  // fails while others have it open
      const bool unused = IsUnused(database);
      if (unused && StillThere(database)) std::remove(database.path().c_str());
      database.Execute("ROLLBACK");
      if (!unused) database.UseLog();
    } catch (const Error&) {  // it stays, empty
    }
  }
  SaveReport Save(const std::string& name, const Atlas& atlas, const SaveOptions& save_options);
  SaveReport SaveUnderLock(const std::string& name, const Atlas& atlas, const AtlasHashes& hashes, bool was_edited,
                           const SaveOptions& save_options);
  // Without a log, which is for readers of what is there, a save writes each page once and not twice. Where others came
  // to the store meanwhile, the log stays.
  void LeaveLog() { sqlite3_exec(database.handle(), "PRAGMA journal_mode=DELETE", nullptr, nullptr, nullptr); }
  // And opens it, as long as the store has the name that this connection knows. Where somebody reads already, the next
  // who writes does it.
  void ReturnToLog() {
    sqlite3_exec(database.handle(), "PRAGMA journal_mode=WAL; SELECT 1 FROM atlas LIMIT 1", nullptr, nullptr, nullptr);
  }
  // Whether every row holds what its hash says. What another program saves meanwhile does.
  bool IsWhole(const std::string& name, int threads) {
    try {
      Transaction transaction(database, Transaction::Kind::kBegin);
      ReadOptions how;
      how.threads = threads;
      LoadAtlas(database, sqlite::Find(database, name).atlas, how);
      return true;
    } catch (const SnapshotChanged&) {
      return true;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
      return false;
    }
  }
  void CheckWritable() const {
    if (!writable) throw Error(ErrorKind::kUsage, database.path(), "", "opened for reading");
  }
};

// Where reading failed and rows differ from their hash, all of these rows: a person who edited the store in SQL wants
// to know them. Other damage is told behind them.
Error NamingEdits(Database& database, std::int64_t atlas, const Error& found) {
  constexpr std::size_t kNamed = 20;
  std::vector<EditedRow> edits;
  database.AcceptEdits(&edits);
  const Salvage salvage = SalvageRows(database, atlas);
  database.AcceptEdits(nullptr);
  const std::vector<std::string>& accepted = salvage.accepted;
  if (accepted.empty()) return found;
  std::string names = accepted[0];
  for (std::size_t i = 1; i < std::min(accepted.size(), kNamed); ++i)
    names += (i + 1 == accepted.size() ? " and " : ", ") + accepted[i];
  if (accepted.size() > kNamed) names += detail::Concat(" and ", accepted.size() - kNamed, " more");
  const std::string place = edits.empty() ? found.place() : PlaceOf(edits[0].table.c_str(), edits[0].row);
  const std::string others = salvage.damage.empty() ? "; StoreReadOptions::accept_edits takes them as they are"
                                                    : "; and others are gone or cannot be read: " + salvage.damage[0];
  return Error(ErrorKind::kDamaged, database.path(), place,
               "differs from its hash: edited outside slamdb, or damaged: " + names + others);
}

Error NamingRevision(const Named& named, const Error& error) {
  return Error(error.kind(), error.path(),
               detail::Concat("revision ", named.number, " of '", named.name, "'", error.place().empty() ? "" : ", ",
                              error.place()),
               error.problem());
}

Atlas LoadRevision(Database& database, const Named& named, const ReadOptions& options) {
  if (named.is_newest()) return LoadAtlas(database, named.atlas, options);
  PastRows past = ReadPast(database, named.atlas, named.number);
  return LoadPast(database, named.atlas, past, options);
}

std::unique_ptr<State> State::ToRead(const std::string& path, double lock_timeout) {
  CheckNotStandardStream(path);
  std::error_code ignored;
  const bool had_index = std::filesystem::exists(FilesBeside(path).index, ignored);
  auto state = std::make_unique<State>(
      State{Database(path, Access::kRead, lock_timeout), {.sync = true, .lock_timeout = lock_timeout}, false});
  NamingHolder(state->database, [&] { WaitUntilMade(state->database, had_index); });
  return state;
}

State State::ToWrite(const std::string& path, const StoreOptions& options) {
  for (int attempt = 1;; ++attempt) {
    std::error_code ignored;
    const bool is_new = !std::filesystem::exists(path, ignored);
    State state{Database(path, Access::kCreate, options.lock_timeout, options.progress), options, true, is_new};
    try {
      PrepareToWrite(state.database, options.sync);
      state.opened_unused = IsUnused(state.database);
      return state;
    } catch (const Error&) {
      if (StillThere(state.database) || attempt == kOpenAttempts) {
        state.RemoveUnused();
        throw;
      }
    } catch (...) {
      state.RemoveUnused();
      throw;
    }
  }
}

WriteTransaction State::Lock() {
  for (int attempt = 1;; ++attempt) {
    try {
      return WriteTransaction(database);
    } catch (const Error&) {
      if (!opened_unused || attempt == kOpenAttempts || StillThere(database)) throw;
    }
    const std::string path = database.path();
    *this = ToWrite(path, StoreOptions(options));
  }
}

SaveReport State::Save(const std::string& name, const Atlas& atlas, const SaveOptions& save_options) {
  rows::CheckName(database.path(), name);
  if (!save_options.recorded) {
    rows::CheckIsNoRevision(database.path(), name, [this](const std::string& each) { return Has(each); });
    detail::EnterOutput(database.path(), name);
  }
  const AtlasHashes hashes = detail::HashesOf(atlas, save_options.threads);
  // Before the lock, for which others wait, and with every core.
  const bool was_edited =
      save_options.verify && save_options.overwrite && Has(name) && !IsWhole(name, save_options.threads);
  if (!made) return SaveUnderLock(name, atlas, hashes, was_edited, save_options);
  LeaveLog();
  SaveReport report = SaveUnderLock(name, atlas, hashes, was_edited, save_options);
  ReturnToLog();
  return report;
}

SaveReport State::SaveUnderLock(const std::string& name, const Atlas& atlas, const AtlasHashes& hashes, bool was_edited,
                                const SaveOptions& save_options) {
  WriteTransaction transaction = Lock();
  if (save_options.keep_equal && Holds(name, hashes.Combined())) {
    transaction.Commit();
    return {.hash = static_cast<std::uint64_t>(hashes.Combined()), .unchanged = true};
  }
  if (!save_options.overwrite && Has(name)) throw rows::AtlasIsThere(database.path(), name);
  // What it is made of is there, or was given up since it was read.
  if (save_options.from && !save_options.recorded) sqlite::Find(database, *save_options.from);
  if (save_options.onto)
    rows::CheckIsNewest(database.path(), name, sqlite::Find(database, name).newest, *save_options.onto);
  const Recorded recorded = save_options.recorded ? *save_options.recorded : RecordedNow();
  SaveReport report;
  SaveAtlas(database, name, atlas, hashes, recorded.at, save_options,
            was_edited ? Rewrite::kAll : Rewrite::kWhatDiffers, report);
  const std::int64_t history = Record(database, "save", name, save_options.provenance, report.Total(), recorded);
  if (!report.unchanged) {
    RecordChanges(database, history, report);
    AddRevision(database, sqlite::Find(database, name).atlas, history, save_options.from);
  }
  if (save_options.before_commit) save_options.before_commit();
  transaction.Commit();
  return report;
}

class SqliteStore : public detail::StoreBackend {
 public:
  explicit SqliteStore(std::unique_ptr<State> state) : state_(std::move(state)) {}

  const std::string& path() const override { return state_->database.path(); }
  std::vector<std::string> Names() override { return NamesOf(state_->database); }
  std::vector<StoredAtlas> List() override { return ListAtlases(state_->database); }
  std::vector<std::string> Find(const MapQuery& query, std::vector<std::string>*) override {
    return FindAtlases(state_->database, query);
  }
  std::vector<std::string> Find(const AtlasQuery& query) override { return FindAtlases(state_->database, query); }
  std::vector<HistoryEntry> Log(const std::string& name) override { return ReadHistory(state_->database, name); }
  HistoryEntry LogOf(const RevisionName& revision) override {
    const Transaction transaction(state_->database, Transaction::Kind::kBegin);
    const Named named = sqlite::Find(state_->database, revision);
    return ReadHistoryOf(state_->database, named.atlas, named.number);
  }
  std::vector<RevisionChain> Chains(const ChainQuery& query) override {
    const Transaction transaction(state_->database, Transaction::Kind::kBegin);
    return ReadChains(state_->database, query);
  }
  StoredPlaces PlacesLike(std::span<const std::span<const Descriptor>> pictures, const PlaceOptions& options) override {
    const Transaction transaction(state_->database, Transaction::Kind::kBegin);
    return FindPlaces(state_->database, pictures, options);
  }
  bool Has(const std::string& name) override { return state_->Has(name); }

  void CheckWritable() const override { state_->CheckWritable(); }
  SaveReport Save(const std::string& name, const Atlas& atlas, const SaveOptions& options) override;
  Atlas Load(const std::string& name, const ReadOptions& options) override {
    detail::EnterInput(path(), name);
    return LoadNamed([&] { return sqlite::Find(state_->database, name); }, options);
  }
  // A file is read at once.
  Atlas LoadOnto(const RevisionName& revision, const Atlas&, const ReadOptions& options) override {
    return LoadNamed([&] { return sqlite::Find(state_->database, revision); }, options);
  }
  Named FindNamed(const std::string& name) override { return sqlite::Find(state_->database, name); }
  RevisionName NameOf(const Named& named) override { return sqlite::NameOf(state_->database, named); }
  std::optional<RevisionName> CommonBase(const std::string& first, const std::string& second) override {
    const Transaction transaction(state_->database, Transaction::Kind::kBegin);
    return FindBase(state_->database, FindNamed(first), FindNamed(second));
  }
  void Tag(const std::string& name, const std::string& tag) override;
  void Untag(const std::string& name, const std::string& tag) override {
    WriteTransaction transaction(state_->database);
    RemoveTag(state_->database, FindNamed(name), tag);
    transaction.Commit();
  }
  GiveUpReport GiveUp(const GiveUpOptions& options, const std::string& name) override {
    WriteTransaction transaction(state_->database);
    GiveUpReport report = sqlite::GiveUp(state_->database, name, options);
    if (!options.dry_run) transaction.Commit();
    return report;
  }

  void Remove(const std::string& name) override;
  StoreStats Stats() override { return ReadStatistics(state_->database); }
  void Vacuum() override;
  void Backup(const std::string& target, bool overwrite) override { BackupTo(state_->database, target, overwrite); }

 private:
  template <class FindIt>
  Atlas LoadNamed(const FindIt& find, const ReadOptions& options);

  std::unique_ptr<State> state_;
};

SaveReport SqliteStore::Save(const std::string& name, const Atlas& atlas, const SaveOptions& options) {
  try {
    SaveReport report = state_->Save(name, atlas, options);
    state_->made = state_->opened_unused = false;
    return report;
  } catch (...) {
    state_->RemoveUnused();
    throw;
  }
}

template <class FindIt>
Atlas SqliteStore::LoadNamed(const FindIt& find, const ReadOptions& options) {
  Database& database = state_->database;
  for (int attempt = 1;; ++attempt) {
    Named named;
    try {
      Transaction transaction(database, Transaction::Kind::kBegin);
      named = find();
      ReadOptions how = options;
      if (attempt == kLoadAttempts) how.threads = 1;  // one connection sees one moment, whoever saves
      Atlas atlas = LoadRevision(database, named, how);
      // What an earlier revision shares with the newest takes nothing of its own.
      if (options.part_sizes != nullptr && named.is_newest()) *options.part_sizes = PartSizesOf(database, named.atlas);
      return atlas;
    } catch (const SnapshotChanged&) {
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::kDamaged && named.atlas != 0)
        throw named.is_newest() ? NamingEdits(database, named.atlas, error) : NamingRevision(named, error);
      if (!database.is_image() || error.kind() != ErrorKind::kLocked) throw;
    }
    if (attempt == kLoadAttempts)
      throw Error(ErrorKind::kLocked, path(), "", "is being changed while it is read: try again");
    if (database.is_image()) database = Database(path(), Access::kRead, state_->options.lock_timeout);
  }
}

void SqliteStore::Tag(const std::string& name, const std::string& tag) {
  WriteTransaction transaction(state_->database);
  const Named named = FindNamed(name);
  if (const std::string other = named.name + "@" + tag; state_->Has(other))
    throw Error(ErrorKind::kAlreadyExists, path(), "",
                detail::Concat("holds an atlas named '", other, "', which would hide that tag: take another"));
  SetTag(state_->database, named, tag);
  transaction.Commit();
}

void SqliteStore::Remove(const std::string& name) {
  Database& database = state_->database;
  WriteTransaction transaction(database);
  const Named named = sqlite::Find(database, name);
  const std::int64_t row = named.atlas;
  ChangeCounter changes;
  // The history needs the counts of what goes, and how many rows went: it is entered before and completed after.
  const std::int64_t history = Record(database, "remove", name, "", {}, RecordedNow());
  DeleteAtlas(database, row, changes);
  const SaveReport report{.tables = changes.Take()};
  Statement complete(database, "UPDATE history SET deleted = ?1 WHERE row = ?2", "table history");
  complete.Bind(1, ToColumn(report.Total().deleted)).Bind(2, history).Run();
  transaction.Commit();
}

void SqliteStore::Vacuum() {
  Database& database = state_->database;
  // What VACUUM builds is as large as the store: it goes to a temporary file, not into memory.
  database.Execute("PRAGMA temp_store=FILE; PRAGMA cache_size=-8192");
  const int code = sqlite3_exec(database.handle(), "VACUUM", nullptr, nullptr, nullptr);
  if ((code & 0xff) == SQLITE_BUSY) throw LockedError(database);
  if (code != SQLITE_OK) throw database.Failure("", code);
  database.Execute("PRAGMA wal_checkpoint(TRUNCATE)");
}

}  // namespace

std::unique_ptr<detail::StoreBackend> OpenStore(const std::string& path, double lock_timeout) {
  std::unique_ptr<State> state = State::ToRead(path, lock_timeout);
  CheckIsStore(state->database, NewestVersion());
  return std::make_unique<SqliteStore>(std::move(state));
}

bool IsYetToBeMade(const std::string& path, double lock_timeout) {
  std::error_code missing;
  const std::uintmax_t bytes = std::filesystem::file_size(path, missing);
  if (missing ? !std::filesystem::exists(path) : bytes == 0) return true;
  return IsEmptyDatabase(State::ToRead(path, lock_timeout)->database);
}

std::unique_ptr<detail::StoreBackend> OpenStoreForWriting(const std::string& path, const StoreOptions& options) {
  CheckNotStandardStream(path);
  return std::make_unique<SqliteStore>(std::make_unique<State>(State::ToWrite(path, options)));
}

}  // namespace slamdb::sqlite
