// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace slamdb::orbslam3 {

// What programs did to a binary archive that they took for text, one after the other, as its bytes tell. In sentences
// for people, empty for nothing: `every line feed has a carriage return before it, as a transfer in text mode leaves
// it`.
struct Transfers {
  std::string undone;  // what can be taken back exactly
  std::string bytes;   // the file without that
  std::string left;    // what lost something
};

Transfers FindTransfers(std::string_view file);

}  // namespace slamdb::orbslam3
