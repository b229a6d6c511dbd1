// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb {

// Where numbers stand on which the rest of an encoded file hangs, for tests that damage them.
struct GraphField {
  enum class Kind { kClass, kObject, kCount, kVersion, kMatrix } kind;
  std::size_t offset, bytes;
};

struct EncodedGraph {
  std::string bytes;
  std::vector<GraphField> fields;
};

// The map as ORB-SLAM2's BoostArchiver writes it, from the description of its bytes and not from our reader: objects
// stand where a pointer first leads to them, the inverted file has `words` lists. Null where an id leads to nothing.
EncodedGraph EncodeGraph(const Map& map, std::size_t words = 10);

}  // namespace slamdb
