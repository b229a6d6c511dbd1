// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/revisions.h"
#include "slamdb/formats/sqlite/detail/database.h"

// The tables `revision` and `tag`: which revisions of an atlas can be read, and what they are called.
namespace slamdb::sqlite {

using rows::Named;

// Throws Error: kNotFound naming the atlases or revisions that there are.
Named Find(Database& database, std::string_view text);

// By its number. Throws Error likewise.
Named Find(Database& database, const RevisionName& revision);

std::vector<RevisionChain> ReadChains(Database& database, const ChainQuery& query);

std::vector<std::string> NamesOf(Database& database);  // of all atlases, ascending

// Enters the newest revision of an atlas, which `history` tells of.
void AddRevision(Database& database, std::int64_t atlas, std::int64_t history, const std::optional<RevisionName>& from);

// What the log says was saved; nothing where it does not know.
std::optional<std::int64_t> HashOfRevision(Database& database, std::int64_t atlas, std::int64_t number);
RevisionName NameOf(Database& database, const Named& named);  // with its hash

void SetTag(Database& database, const Named& named, const std::string& tag);
void RemoveTag(Database& database, const Named& named, const std::string& tag);

// Store::GiveUp, of all atlases or one; inside the caller's transaction.
GiveUpReport GiveUp(Database& database, const std::string& atlas, const GiveUpOptions& options);

// The newest revision that both come from.
std::optional<RevisionName> FindBase(Database& database, const Named& first, const Named& second);

}  // namespace slamdb::sqlite
