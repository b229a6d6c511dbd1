// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "slamdb/model/atlas.h"

// Where the records of a binary archive stand, found without knowing its layout: objects are numbered in the order of
// the file, so that each but the first of its class begins with `i16 class id | u32 number`.
namespace slamdb::layouts {

struct Record {
  std::uint64_t begin = 0;   // of its pointer
  std::uint64_t body = 0;    // of its members
  std::uint32_t object = 0;  // its number
};

// Records of one list, one behind the other.
struct RecordList {
  std::int16_t class_id = 0;
  std::uint64_t head = 0;       // of the list: its count, without class information
  std::uint64_t announced = 0;  // by the count; 0: unknown
  std::vector<Record> records;
};

// Where a record ends, since the next object stands behind it; 0: unknown.
inline std::uint64_t EndOf(const RecordList& list, std::size_t row) {
  const bool known = row + 1 < list.records.size() && list.records[row + 1].object == list.records[row].object + 1;
  return known ? list.records[row + 1].begin : 0;
}

// Of one map.
struct MapRecords {
  RecordList keyframes, points;
};

// The lists of keyframes and of their map points, in the order of the file. Keyframes are known by the size of the grid
// that each has near its beginning, map points by their numbers; those that are damaged are passed over. Empty where
// there are none, or no archive.
// Time grows with the file alone.
std::vector<MapRecords> FindRecords(std::string_view file, const ArchiveEncoding& encoding);

}  // namespace slamdb::layouts
