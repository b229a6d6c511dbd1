// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace slamdb::bench {

// The rows of one table as a binary COPY sends them.
struct RawRows {
  std::string target;  // `table (columns)`
  std::string bytes;
};

// Copies the rows of the newest revisions out of a store and into another one, as they are: nothing is decoded, hashed
// or looked at, so that no load and no save of them can take less. Not to `keep` them leaves their bytes empty.
std::vector<RawRows> CopyRawOut(const std::string& uri, bool keep);
void CopyRawIn(const std::string& uri, const std::vector<RawRows>& tables);

}  // namespace slamdb::bench
