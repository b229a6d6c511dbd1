// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/rows/atlas_query.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/rows/places.h"
#include "slamdb/formats/rows/revisions.h"
#include "slamdb/formats/rows/stored.h"
#include "slamdb/model/map_query.h"
#include "slamdb/model/summary.h"

namespace slamdb {

namespace detail {
class StoreBackend;
}

// Many atlases, each under a name: in one SQLite file, or in a database of a PostgreSQL server
// (`postgresql://user@host/database`).
// The schema of a file is in schema/*.sql and explained in schema/store.md, that of a server in schema/postgresql/ and
// schema/postgresql.md.
// Saves are transactions: a killed program, a full disk or an exception leaves the store as it was.
// Readers work while another program writes, and see the store as of before.
//
// All functions throw Error with the path, and with the table and row where the store is damaged.
// Kinds beyond those named below: kLocked (another program writes), kDamaged, kOutOfResources (the disk is full),
// kPermission.
// Not thread-safe: one Store per thread.
// On a server a thread keeps its connection until it ends, for the next Store that it opens there.
class SLAMDB_EXPORT Store {
 public:
  // Opens to read: never changes the file, never makes one, works on read-only disks.
  //
  // A store that another program is making right now is waited for, as for a lock.
  //
  // Throws Error:
  //   kNotFound     it is missing
  //   kUnsupported  it is a database of another program, or a store of a newer or older version than this library's
  //                 (MigrateStore)
  //   kDamaged      it is no database at all
  static Store Open(const std::string& path, double lock_timeout = 5);

  // Whether a store is yet to be made there: there is no file, an empty one, or a database without tables, such as a
  // program leaves that was killed while it made the store. OpenForWriting makes one out of each.
  //
  // Throws Error as Open does for what cannot be read, or is no database.
  [[nodiscard]] static bool IsYetToBeMade(const std::string& path, double lock_timeout = 5);

  // Opens to write; makes the store where it is yet to be made.
  //
  // Throws Error as Open does.
  static Store OpenForWriting(const std::string& path, StoreOptions options = {});

  ~Store();
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;

  const std::string& path() const;
  std::vector<std::string> Names();  // ascending; without a look at what they name
  std::vector<StoredAtlas> List();   // by name
  // The atlases that match (model/map_query.h), ascending. Where the server of a partition (postgresql/fleet.h) does
  // not answer, the others are searched, and the names of its atlases come into `unsearched`; without that, it throws.
  std::vector<std::string> Find(const MapQuery& query, std::vector<std::string>* unsearched = nullptr);
  // Those of which the store tells what is asked for, ascending.
  std::vector<std::string> Find(const AtlasQuery& query);
  std::vector<HistoryEntry> Log(const std::string& name = {});  // oldest first; empty name: everything
  // What the log says of one revision, by its number.
  //
  // Throws Error: kNotFound when it cannot be read any more.
  HistoryEntry LogOf(const RevisionName& revision);
  // The revisions of many atlases by their hashes, by name: what stores are compared by. Cost: some 20 bytes a
  // revision; of those that were given up a reading of the log of these atlases, in a file of the whole log.
  std::vector<RevisionChain> Chains(const ChainQuery& query);

  // Which keyframes look like each of some pictures, by what the store keeps beside the atlases: reads none of them.
  // A picture is its ORB descriptors. What looks alike need not be the same place: Locator tells.
  //
  // Cost: reads about 600 bytes a keyframe once, and for each picture some 0.3 microseconds a keyframe.
  StoredPlaces PlacesLike(std::span<const std::span<const Descriptor>> pictures, const PlaceOptions& options = {});

  // The name to use where the user gave none: that of the only atlas.
  //
  // Throws Error: kNotFound when there is none, kUsage naming the atlases when there are several.
  std::string OnlyName();

  // Saves under `name`, as the next revision of the atlas of that name if there is one, by writing only the rows that
  // differ. What they were stays, for the revisions before. Where nothing differs, there is no next one.
  //
  // A name is 1 to 255 bytes of UTF-8 without `#`, `/` and control characters. A file that was made for a save that
  // fails is removed again.
  //
  // Throws Error: kUsage when the store was opened to read, for another name, or for one that stands for a revision;
  // kAlreadyExists without `overwrite`;
  // kLocked when another program writes longer than `lock_timeout`, or removed the file.
  SaveReport Save(const std::string& name, const Atlas& atlas, const SaveOptions& options = {});

  // Loads all or the selected part of NAME, or of a revision (NAME@3, revisions.h); the rest is not read, but rows
  // of a server without their pictures.
  // Every row is compared with its hash, a whole atlas also with the atlas' hash.
  //
  // Cost: an earlier revision takes what the newest takes, and about as much again for what was changed since.
  //
  // Throws Error: kNotFound naming the atlases or revisions that there are; kDamaged naming the first row that differs.
  Atlas Load(const std::string& name, const ReadOptions& options = {});

  // Loads a whole revision, by its number, with the help of an atlas that has much of it, such as the revision before
  // it: from a server comes only what `base` does not have, besides 24 bytes for each keyframe and point. Of the
  // options, threads and progress count. What it gives is compared with the atlas' hash as Load's is, whatever `base`
  // holds.
  //
  // Throws Error as Load does.
  Atlas LoadOnto(const RevisionName& revision, const Atlas& base, const ReadOptions& options = {});

  // The revision that NAME or NAME@WHICH stands for.
  //
  // Throws Error: kNotFound naming what there is.
  RevisionName FindRevision(const std::string& name);
  // The newest revision that two come from; nothing when they have none in common.
  //
  // Throws Error as FindRevision does.
  std::optional<RevisionName> CommonBase(const std::string& first, const std::string& second);
  // Makes a revision the newest again, by saving it anew; those between stay.
  //
  // Throws Error as Load and Save do; kUsage when it is the newest.
  SaveReport Restore(const std::string& name, const SaveOptions& options = {});
  // A new atlas `branch` that begins as that revision; what they share of pictures is stored once.
  //
  // Throws Error as Load and Save do; kAlreadyExists when there is an atlas of that name.
  SaveReport Branch(const std::string& name, const std::string& branch, const SaveOptions& options = {});
  // Gives a revision a name, or takes one from its atlas.
  //
  // Throws Error: kUsage when it is no name (IsNameOfTag), kAlreadyExists when another revision of the atlas has it;
  // kNotFound when none has it.
  void Tag(const std::string& name, const std::string& tag);
  void Untag(const std::string& name, const std::string& tag);
  // Gives up earlier revisions of one atlas, or of all where `name` is empty: in one transaction, on a server in one
  // for each atlas.
  //
  // Throws Error: kNotFound when there is no such atlas.
  GiveUpReport GiveUp(const GiveUpOptions& options, const std::string& name = {});

  void Remove(const std::string& name);  // with all its revisions; throws Error (kNotFound) when there is none
  StoreStats Stats();
  void Vacuum();  // gives free pages back to the disk; on a server Error (kNotPossible)
  // Copies the store as it is now, also while others write (SQLite's online backup).
  // A new target appears whole or not, with the permissions of the store. With `overwrite` the store that is there
  // becomes the copy in one transaction of its own: links are followed, and whatever fails leaves it as it was.
  //
  // Throws Error: kAlreadyExists when it is there and not to be overwritten; kLocked when another program saves there
  // meanwhile; kUnsupported when what is there is no store; kNotPossible for a server.
  void Backup(const std::string& target, bool overwrite = false);

 private:
  explicit Store(std::unique_ptr<detail::StoreBackend> backend);
  std::unique_ptr<detail::StoreBackend> backend_;
};

// Brings a store to the version of this library, or with `back` to the one before its own.
// Nothing happens when it is of this version already.
//
// Throws Error: kUnsupported for newer stores and the databases of others; kNotPossible when going back would lose
// something, or would be a second step back.
SLAMDB_EXPORT MigrateReport MigrateStore(const std::string& path, const MigrateOptions& options = {});

// Whether doing it again may succeed: another program was at work on it, or the server does not answer, or no more.
[[nodiscard]] SLAMDB_EXPORT bool IsWorthRetrying(const Error& error);

}  // namespace slamdb
