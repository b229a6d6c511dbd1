// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/postgresql_store.h"

#include <algorithm>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/formats/postgresql/detail/catalog.h"
#include "slamdb/formats/postgresql/detail/find_places.h"
#include "slamdb/formats/postgresql/detail/kept_connection.h"
#include "slamdb/formats/postgresql/detail/load.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/postgresql/detail/writer_lock.h"
#include "slamdb/formats/rows/detail/provenance.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

bool IsRowSecurityActive(Connection& connection) {
  return connection.Integer("SELECT row_security_active('slamdb.keyframe')") != 0;
}

class PostgresqlStore : public detail::StoreBackend {
  template <class Work>
  auto Reading(const Work& work) {
    const Transaction transaction(connection_, Transaction::Kind::kRead);
    return work();
  }
  template <class Work>
  void Writing(const Work& work) {
    Transaction transaction(connection_, Transaction::Kind::kWrite);
    work();
    transaction.Commit();
  }
  // Calls work(partition) for all at once, Partition(); or, when one of the servers that have partitions does not
  // answer, for each, and names the atlases of those that fail. Throws what fails where nobody asks for these.
  template <class Work>
  void OfAll(const Work& work, std::vector<std::string>* failed) {
    try {
      return Reading([&] { work(Partition()); });
    } catch (const Error& error) {
      if (failed == nullptr || connection_.is_lost() || !IsOfOtherServer(error)) throw;
    }
    OfEach(work, *failed);
  }
  // Calls it for each partition.
  template <class Work>
  void OfEach(const Work& work, std::vector<std::string>& failed) {
    for (const Partition& partition : Reading([&] { return PartitionsOf(connection_); })) {
      try {
        Reading([&] { work(Partition{partition.number, true}); });  // also of its own server: by name
      } catch (const Error& error) {
        if (connection_.is_lost() || !IsOfOtherServer(error)) throw;
        const auto names = Reading([&] { return NamesIn(connection_, partition.number); });
        failed.insert(failed.end(), names.begin(), names.end());
      }
    }
    std::ranges::sort(failed);
  }

 public:
  PostgresqlStore(const std::string& uri, const StoreOptions& options, bool writable)
      : kept_(uri, {.progress = options.progress}), connection_(*kept_), options_(options), writable_(writable) {
    writable ? MakeStore(connection_) : CheckIsStore(connection_);
    if (!writable) return;
    connection_.set_has_row_security(IsRowSecurityActive(connection_));
  }

  const std::string& path() const override { return connection_.path(); }
  std::vector<std::string> Names() override {
    return Reading([&] { return NamesOf(connection_); });
  }
  std::vector<StoredAtlas> List() override {
    return Reading([&] { return ListAtlases(connection_); });
  }
  std::vector<std::string> Find(const MapQuery& query, std::vector<std::string>* unsearched) override {
    std::vector<std::string> found;
    const auto search = [&](const Partition& partition) {
      for (std::string& name : FindAtlases(connection_, query, partition)) found.push_back(std::move(name));
    };
    OfAll(search, unsearched);
    std::ranges::sort(found);
    return found;
  }
  std::vector<std::string> Find(const AtlasQuery& query) override {
    return Reading([&] { return FindAtlases(connection_, query); });
  }
  std::vector<HistoryEntry> Log(const std::string& name) override {
    return Reading([&] { return ReadHistory(connection_, name); });
  }
  HistoryEntry LogOf(const RevisionName& revision) override {
    return Reading([&] {
      const Named named = postgresql::Find(connection_, revision);
      return ReadHistoryOf(connection_, named.atlas, named.number);
    });
  }
  std::vector<RevisionChain> Chains(const ChainQuery& query) override {
    return Reading([&] { return ReadChains(connection_, query); });
  }
  StoredPlaces PlacesLike(std::span<const std::span<const Descriptor>> pictures, const PlaceOptions& options) override {
    PlaceFinder finder(pictures, options);
    std::vector<std::string> unreachable;
    const auto read = [&](const Partition& partition) { finder.Read(connection_, partition); };
    // Of a fleet each: asked for all at once, another server would send all that it has. But where rows are shown by
    // project, nobody may name a partition.
    const bool by_partition = Reading([&] { return IsFleet(connection_) && !IsRowSecurityActive(connection_); });
    by_partition ? OfEach(read, unreachable) : OfAll(read, &unreachable);
    StoredPlaces found = std::move(finder).Find();
    std::ranges::sort(unreachable);
    found.unreachable = std::move(unreachable);
    return found;
  }
  bool Has(const std::string& name) override {
    return Reading([&] { return postgresql::Has(connection_, name); });
  }

  void CheckWritable() const override {
    if (!writable_) throw Error(ErrorKind::kUsage, path(), "", "opened for reading");
  }
  SaveReport Save(const std::string& name, const Atlas& atlas, const SaveOptions& options) override;
  Atlas Load(const std::string& name, const ReadOptions& options) override {
    detail::EnterInput(path(), name);
    Named read;
    try {
      return LoadOnce(name, options, read);
    } catch (const Error& error) {
      // Another server may have answered when the atlas was removed already, or the revision given up.
      if (error.kind() != ErrorKind::kDamaged || !IsGone(name, read)) throw;
    }
    return LoadOnce(name, options, read);
  }
  Atlas LoadOnto(const RevisionName& revision, const Atlas& base, const ReadOptions& options) override {
    return Reading(
        [&] { return postgresql::LoadOnto(connection_, postgresql::Find(connection_, revision), base, options); });
  }
  Named FindNamed(const std::string& name) override {
    return Reading([&] { return postgresql::Find(connection_, name); });
  }
  RevisionName NameOf(const Named& named) override {
    return Reading([&] { return postgresql::NameOf(connection_, named); });
  }
  std::optional<RevisionName> CommonBase(const std::string& first, const std::string& second) override {
    return Reading([&] {
      return postgresql::CommonBase(connection_, postgresql::Find(connection_, first),
                                    postgresql::Find(connection_, second));
    });
  }
  void Tag(const std::string& name, const std::string& tag) override {
    Writing([&] {
      LockAtlas(connection_, NameAlone(name), lock_options());  // so that nobody gives the revision up meanwhile
      const Named named = postgresql::Find(connection_, name);
      if (const std::string other = named.name + "@" + tag; postgresql::Has(connection_, other))
        throw Error(ErrorKind::kAlreadyExists, path(), "",
                    Concat("holds an atlas named '", other, "', which would hide that tag: take another"));
      SetTag(connection_, named, tag);
    });
  }
  void Untag(const std::string& name, const std::string& tag) override {
    Writing([&] { RemoveTag(connection_, postgresql::Find(connection_, name), tag); });
  }
  GiveUpReport GiveUp(const GiveUpOptions& options, const std::string& name) override;

  void Remove(const std::string& name) override;
  StoreStats Stats() override {
    return Reading([&] { return ReadStatistics(connection_); });
  }
  void Vacuum() override {
    throw Error(ErrorKind::kNotPossible, path(), "",
                "a server gives space back by itself (autovacuum); VACUUM FULL in psql does at once");
  }
  void Backup(const std::string&, bool) override {
    throw Error(ErrorKind::kNotPossible, path(), "",
                "a server is backed up by its own tools: pg_dump --schema=slamdb, or pg_basebackup");
  }

 private:
  // That what the atlas `name` is made of is there, and stays until that is saved.
  void HoldSource(const std::string& name, const RevisionName& source) {
    if (source.atlas != name) LockAtlas(connection_, source.atlas, lock_options());
    postgresql::Find(connection_, source);
  }
  // Of the atlas that NAME or NAME@WHICH stands for.
  std::string NameAlone(const std::string& name) { return postgresql::Find(connection_, name).name; }
  LockOptions lock_options() const { return {options_.lock_timeout, options_.progress}; }

  Atlas LoadOnce(const std::string& name, const ReadOptions& options, Named& named) {
    return Reading([&] {
      named = postgresql::Find(connection_, name);
      if (options.part_sizes != nullptr && named.is_newest())
        *options.part_sizes = PartSizesOf(connection_, named.atlas, PartitionOf(connection_, named.atlas));
      return LoadAtlas(connection_, named, options);
    });
  }
  // Whether the name means another revision than `read` by now, of a store with other servers.
  // Throws Error (kNotFound) when it means none.
  bool IsGone(const std::string& name, const Named& read) {
    return Reading([&] {
      if (!IsFleet(connection_)) return false;
      const Named now = postgresql::Find(connection_, name);
      return now.atlas != read.atlas || now.number != read.number;
    });
  }

  // Whether every row holds what its hash says. What another program saves meanwhile does. Rows that only saves have
  // written do; others are loaded and looked at.
  bool IsWhole(const std::string& name, int threads) {
    try {
      Reading([&] {
        const Named named = postgresql::Find(connection_, name);
        if (IsAsSaved(connection_, named)) return;
        ReadOptions how;
        how.threads = threads;
        LoadAtlas(connection_, named, how);
      });
      return true;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
      return false;
    }
  }

  KeptConnection kept_;
  Connection& connection_;
  StoreOptions options_;
  bool writable_;
};

SaveReport PostgresqlStore::Save(const std::string& name, const Atlas& atlas, const SaveOptions& options) {
  rows::CheckName(path(), name);
  if (!options.recorded) detail::EnterOutput(path(), name);
  const AtlasHashes hashes = detail::HashesOf(atlas, options.threads);
  // Before the lock, for which others wait.
  const bool was_edited = options.verify && options.overwrite && Has(name) && !IsWhole(name, options.threads);
  Transaction transaction(connection_,
                          options_.sync ? Transaction::Kind::kWrite : Transaction::Kind::kWriteWithoutSync);
  LockAtlas(connection_, name, lock_options());
  const std::optional<StoredHead> stored = FindHead(connection_, name);
  if (!options.recorded)
    rows::CheckIsNoRevision(path(), name, [&](const std::string& each) {
      return each == name ? stored.has_value() : postgresql::Has(connection_, each);
    });
  if (options.keep_equal && stored && stored->hash == hashes.Combined())
    return {.hash = static_cast<std::uint64_t>(stored->hash), .unchanged = true};
  if (!options.overwrite && stored) throw rows::AtlasIsThere(path(), name);
  if (options.from && !options.recorded) HoldSource(name, *options.from);
  if (options.onto)
    rows::CheckIsNewest(path(), name, stored ? stored->revision : postgresql::Find(connection_, name).newest,
                        *options.onto);
  SaveReport report = SaveAtlas(connection_, name, stored, atlas, hashes, options, lock_options(), was_edited);
  if (options.before_commit) options.before_commit();
  transaction.Commit();
  return report;
}

// An atlas at a time, so that nobody waits for all of them. On another server rows go once the store has forgotten them
// for good, as that server commits by itself.
GiveUpReport PostgresqlStore::GiveUp(const GiveUpOptions& options, const std::string& name) {
  GiveUpReport report;
  const std::vector<std::string> names = name.empty() ? Names() : std::vector<std::string>{name};
  for (const std::string& each : names) {
    try {
      if (options.dry_run)
        Reading([&] { TellGiveUp(connection_, each, options, report); });
      else
        Writing([&] { postgresql::GiveUp(connection_, each, options, lock_options(), report); });
    } catch (const Error& error) {
      if (!name.empty() || error.kind() != ErrorKind::kNotFound) throw;
      continue;  // somebody removed it meanwhile
    }
    if (options.dry_run || report.atlases.back().revisions.empty()) continue;
    if (!Reading([&] { return IsFleet(connection_); })) continue;
    Writing([&] {
      const GivenUpRows deleted = DeleteGivenUp(connection_, each, lock_options());
      report.pictures += deleted.pictures;
      report.bytes += deleted.bytes;
    });
  }
  return report;
}

void PostgresqlStore::Remove(const std::string& name) {
  std::int64_t atlas = 0;
  Partition partition;
  Writing([&] {
    LockAtlas(connection_, name, lock_options());
    atlas = postgresql::Find(connection_, name).atlas;
    partition = HoldPartition(connection_, atlas, lock_options());
    const std::int64_t deleted = partition.is_remote ? CountRows(connection_, atlas) : DeleteRows(connection_, atlas);
    connection_.Query(
        "INSERT INTO history (at, tool, action, atlas, provenance, maps, keyframes, points, observations, hash, "
        "inserted, updated, deleted, unchanged, who, project) SELECT now(), $2, 'remove', name, '', maps, keyframes, "
        "points, observations, hash, 0, 0, $3, 0, $4, project FROM atlas WHERE row = $1",
        {atlas, rows::ToolName(), deleted, rows::Who()}, "table history");
    connection_.Query("DELETE FROM atlas WHERE row = $1", {atlas}, "table atlas");  // and its revisions and tags
  });
  if (!partition.is_remote) return;
  Writing([&] {
    HoldPartition(connection_, atlas, lock_options());
    DeleteRows(connection_, atlas);
  });
}

}  // namespace

std::unique_ptr<detail::StoreBackend> OpenStore(const std::string& uri, double lock_timeout) {
  return std::make_unique<PostgresqlStore>(uri, StoreOptions{.lock_timeout = lock_timeout}, false);
}

std::unique_ptr<detail::StoreBackend> OpenStoreForWriting(const std::string& uri, const StoreOptions& options) {
  return std::make_unique<PostgresqlStore>(uri, options, true);
}

bool IsYetToBeMade(const std::string& uri, double) {
  const KeptConnection connection(uri, {});
  return VersionOf(*connection) == 0;
}

}  // namespace slamdb::postgresql
