// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/formats/sqlite/revisions.h"

// The tables `revision` and `tag`: which revisions of an atlas can be read, and what they are called.
namespace slamdb::sqlite {

// What NAME or NAME@WHICH stands for.
struct Named {
  std::int64_t atlas = 0;  // its row
  std::string name;        // of the atlas
  std::int64_t number = 0, newest = 0;
  bool is_newest() const { return number == newest; }
};

// Throws Error: kNotFound naming the atlases or revisions that there are.
Named Find(Database& database, std::string_view text);

// `; it holds a, b`, for errors about names.
std::string AllNames(Database& database);

// Whether something that ends like this reads like a revision whatever the store has: a number, a date.
bool LooksLikeRevision(std::string_view name);

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
