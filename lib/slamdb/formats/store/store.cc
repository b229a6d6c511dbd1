// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/store/store.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/postgresql/detail/errors.h"
#include "slamdb/formats/postgresql/detail/postgresql_store.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/detail/store_backend.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/sqlite_store.h"

namespace slamdb {

Store::Store(std::unique_ptr<detail::StoreBackend> backend) : backend_(std::move(backend)) {}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

Store Store::Open(const std::string& path, double lock_timeout) {
  return Store(detail::IsServer(path) ? postgresql::OpenStore(path, lock_timeout)
                                      : sqlite::OpenStore(path, lock_timeout));
}

bool Store::IsYetToBeMade(const std::string& path, double lock_timeout) {
  return detail::IsServer(path) ? postgresql::IsYetToBeMade(path, lock_timeout)
                                : sqlite::IsYetToBeMade(path, lock_timeout);
}

Store Store::OpenForWriting(const std::string& path, StoreOptions options) {
  return Store(detail::IsServer(path) ? postgresql::OpenStoreForWriting(path, options)
                                      : sqlite::OpenStoreForWriting(path, options));
}

const std::string& Store::path() const { return backend_->path(); }

std::vector<std::string> Store::Names() { return backend_->Names(); }

std::vector<StoredAtlas> Store::List() { return backend_->List(); }

std::vector<std::string> Store::Find(const MapQuery& query, std::vector<std::string>* unsearched) {
  return backend_->Find(query, unsearched);
}

std::vector<std::string> Store::Find(const AtlasQuery& query) { return backend_->Find(query); }

std::vector<HistoryEntry> Store::Log(const std::string& name) { return backend_->Log(name); }

HistoryEntry Store::LogOf(const RevisionName& revision) { return backend_->LogOf(revision); }

std::vector<RevisionChain> Store::Chains(const ChainQuery& query) { return backend_->Chains(query); }

StoredPlaces Store::PlacesLike(std::span<const std::span<const Descriptor>> pictures, const PlaceOptions& options) {
  return backend_->PlacesLike(pictures, options);
}

std::string Store::OnlyName() {
  const std::vector<std::string> names = Names();
  if (names.size() == 1) return names[0];
  if (names.empty()) throw Error(ErrorKind::kNotFound, path(), "", "the store holds no atlas");
  throw Error(ErrorKind::kUsage, path(), "", "say which atlas, as " + path() + "#NAME" + rows::ListOfNames(names));
}

SaveReport Store::Save(const std::string& name, const Atlas& atlas, const SaveOptions& options) {
  backend_->CheckWritable();
  return backend_->Save(name, atlas, options);
}

Atlas Store::Load(const std::string& name, const ReadOptions& options) { return backend_->Load(name, options); }

Atlas Store::LoadOnto(const RevisionName& revision, const Atlas& base, const ReadOptions& options) {
  return backend_->LoadOnto(revision, base, options);
}

RevisionName Store::FindRevision(const std::string& name) { return backend_->NameOf(backend_->FindNamed(name)); }

std::optional<RevisionName> Store::CommonBase(const std::string& first, const std::string& second) {
  return backend_->CommonBase(first, second);
}

SaveReport Store::Restore(const std::string& name, const SaveOptions& options) {
  backend_->CheckWritable();
  const rows::Named named = backend_->FindNamed(name);
  if (named.is_newest())
    throw Error(ErrorKind::kUsage, path(), "",
                detail::Concat("revision ", named.number, " is the newest of '", named.name,
                               "': say which other one, as ", path(), "#", named.name, "@-1"));
  SaveOptions how = options;
  if (how.provenance.empty()) how.provenance = detail::Concat("restore ", named.name, "@", named.number);
  how.from = backend_->NameOf(named);
  return Save(named.name, Load(detail::Concat(named.name, "@", named.number), {.threads = options.threads}), how);
}

SaveReport Store::Branch(const std::string& name, const std::string& branch, const SaveOptions& options) {
  backend_->CheckWritable();
  SaveOptions how = options;
  how.from = FindRevision(name);
  how.overwrite = false;
  if (backend_->Has(branch))
    throw Error(ErrorKind::kAlreadyExists, path(), "",
                detail::Concat("holds an atlas named '", branch, "' already: call the branch something else"));
  if (how.provenance.empty()) how.provenance = "branch " + how.from->ToString();
  return Save(branch, Load(how.from->ToString(), {.threads = options.threads}), how);
}

void Store::Tag(const std::string& name, const std::string& tag) {
  backend_->CheckWritable();
  if (!IsNameOfTag(tag))
    throw Error(
        ErrorKind::kUsage, path(), "",
        detail::Concat("'", tag, "' is no name for a revision: expected one such as 'release', without #, /, @, {, }, ",
                       "and not a number"));
  backend_->Tag(name, tag);
}

void Store::Untag(const std::string& name, const std::string& tag) {
  backend_->CheckWritable();
  backend_->Untag(name, tag);
}

GiveUpReport Store::GiveUp(const GiveUpOptions& options, const std::string& name) {
  backend_->CheckWritable();
  if (!name.empty())
    if (const rows::Named named = backend_->FindNamed(name); named.name != name)
      throw Error(ErrorKind::kUsage, path(), "",
                  detail::Concat("'", name, "' is one revision, and those of an atlas are given up as ", path(), "#",
                                 named.name));
  return backend_->GiveUp(options, name);
}

void Store::Remove(const std::string& name) {
  backend_->CheckWritable();
  const rows::Named named = backend_->FindNamed(name);
  if (named.name != name)
    throw Error(ErrorKind::kUsage, path(), "",
                detail::Concat("'", name, "' is one revision, and an atlas is removed with all of them, as ", path(),
                               "#", named.name, "; 'slamdb gc' gives up earlier revisions"));
  backend_->Remove(name);
}

StoreStats Store::Stats() { return backend_->Stats(); }

void Store::Vacuum() {
  backend_->CheckWritable();
  backend_->Vacuum();
}

void Store::Backup(const std::string& target, bool overwrite) { backend_->Backup(target, overwrite); }

bool IsWorthRetrying(const Error& error) {
  return error.kind() == ErrorKind::kLocked || postgresql::IsWorthRetrying(error);
}

MigrateReport MigrateStore(const std::string& path, const MigrateOptions& options) {
  return detail::IsServer(path) ? postgresql::Migrate(path, options)
                                : sqlite::Migrate(path, options, sqlite::Migrations());
}

}  // namespace slamdb
