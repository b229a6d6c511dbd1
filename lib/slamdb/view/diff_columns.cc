// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/view/detail/encode.h"

namespace slamdb::view {
namespace {

void AddKind(const SceneDiff::Kind& kind, const std::string& name, Columns& columns) {
  columns.push_back({name + "/status", std::string(kind.status.begin(), kind.status.end())});
  VarintColumn moved;
  for (const std::uint32_t row : kind.moved_from) moved.AddDifference(row);
  columns.push_back({name + "/moved", moved.Take()});
}

}  // namespace

Columns EncodeDiff(const SceneDiff& diff) {
  Columns columns;
  AddKind(diff.points, "points", columns);
  AddKind(diff.keyframes, "keyframes", columns);
  return columns;
}

}  // namespace slamdb::view
