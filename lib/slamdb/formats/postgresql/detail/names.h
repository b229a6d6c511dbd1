// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/writer_lock.h"
#include "slamdb/formats/rows/detail/revision_names.h"
#include "slamdb/formats/rows/stored.h"

// Atlases, their revisions and tags by name.
namespace slamdb::postgresql {

using rows::Named;

// The newest revision under a name; revision and hash 0: the atlas has none.
struct StoredHead {
  std::int64_t atlas = 0, revision = 0, hash = 0;
};
std::optional<StoredHead> FindHead(Connection& connection, std::string_view name);

// Throws Error: kNotFound naming the atlases or revisions that there are.
Named Find(Connection& connection, std::string_view text);
// By its number. Throws Error likewise.
Named Find(Connection& connection, const RevisionName& revision);
std::vector<std::string> NamesOf(Connection& connection);                          // ascending
std::vector<std::string> NamesIn(Connection& connection, std::int64_t partition);  // of it alone, ascending
bool Has(Connection& connection, const std::string& name);

RevisionName NameOf(Connection& connection, const Named& named);  // with its hash
std::optional<RevisionName> CommonBase(Connection& connection, const Named& first, const Named& second);

void SetTag(Connection& connection, const Named& named, const std::string& tag);
void RemoveTag(Connection& connection, const Named& named, const std::string& tag);

// Adds to the report what GiveUp would.
void TellGiveUp(Connection& connection, const std::string& name, const GiveUpOptions& options, GiveUpReport& report);
// Gives them up, and adds to the report; inside the caller's transaction. What only they have is left where it is on
// another server, whose rows go once the revisions are gone for good: DeleteGivenUp.
void GiveUp(Connection& connection, const std::string& name, const GiveUpOptions& options, const LockOptions& lock,
            GiveUpReport& report);
struct GivenUpRows {
  std::uint64_t rows = 0, pictures = 0, bytes = 0;
};
// What no revision of an atlas has; nothing where there is no such atlas. Inside a transaction of its own.
GivenUpRows DeleteGivenUp(Connection& connection, const std::string& name, const LockOptions& lock);

}  // namespace slamdb::postgresql
