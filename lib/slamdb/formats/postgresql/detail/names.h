// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/rows/detail/revision_names.h"

// Atlases, their revisions and tags by name.
namespace slamdb::postgresql {

using rows::Named;

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

// Store::GiveUp, of all atlases or one; inside the caller's transaction. What only revisions have that go is left where
// it is on another server, whose rows go once the revisions are gone for good: DeleteGivenUp.
GiveUpReport GiveUp(Connection& connection, const std::string& atlas, const GiveUpOptions& options);
struct GivenUpRows {
  std::uint64_t rows = 0, pictures = 0, bytes = 0;
};
// What no revision of an atlas has; nothing where there is no such atlas. Inside a transaction of its own.
GivenUpRows DeleteGivenUp(Connection& connection, const std::string& name);

}  // namespace slamdb::postgresql
