// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/rows/atlas_query.h"
#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/rows/places.h"
#include "slamdb/formats/rows/revisions.h"
#include "slamdb/formats/rows/stored.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/map_query.h"

namespace slamdb::detail {

// What keeps the atlases of a Store (formats/store/store.h), whose functions these are: a SQLite file, a server.
class StoreBackend {
 public:
  virtual ~StoreBackend() = default;

  virtual const std::string& path() const = 0;
  virtual std::vector<std::string> Names() = 0;
  virtual std::vector<StoredAtlas> List() = 0;
  virtual std::vector<std::string> Find(const MapQuery& query, std::vector<std::string>* unsearched) = 0;
  virtual std::vector<std::string> Find(const AtlasQuery& query) = 0;
  virtual std::vector<HistoryEntry> Log(const std::string& name) = 0;
  virtual HistoryEntry LogOf(const RevisionName& revision) = 0;
  virtual std::vector<RevisionChain> Chains(const ChainQuery& query) = 0;
  virtual StoredPlaces PlacesLike(std::span<const std::span<const Descriptor>> pictures,
                                  const PlaceOptions& options) = 0;
  virtual bool Has(const std::string& name) = 0;

  // Throws Error (kUsage) when it was opened to read.
  virtual void CheckWritable() const = 0;
  // The name may be that of an atlas, and of no revision.
  virtual SaveReport Save(const std::string& name, const Atlas& atlas, const SaveOptions& options) = 0;
  virtual Atlas Load(const std::string& name, const ReadOptions& options) = 0;
  virtual Atlas LoadOnto(const RevisionName& revision, const Atlas& base, const ReadOptions& options) = 0;
  virtual rows::Named FindNamed(const std::string& name) = 0;
  virtual RevisionName NameOf(const rows::Named& named) = 0;
  virtual std::optional<RevisionName> CommonBase(const std::string& first, const std::string& second) = 0;
  virtual void Tag(const std::string& name, const std::string& tag) = 0;
  virtual void Untag(const std::string& name, const std::string& tag) = 0;
  virtual GiveUpReport GiveUp(const GiveUpOptions& options, const std::string& name) = 0;

  virtual void Remove(const std::string& name) = 0;
  virtual StoreStats Stats() = 0;
  virtual void Vacuum() = 0;
  virtual void Backup(const std::string& target, bool overwrite) = 0;
};

}  // namespace slamdb::detail
