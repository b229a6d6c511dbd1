// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rtabmap/fixes.h"

#include <algorithm>

#include "slamdb/formats/rtabmap/detail/nodes.h"
#include "slamdb/formats/sqlite/detail/foreign.h"

namespace slamdb {

std::vector<GpsFix> ReadRtabmapFixes(const Location& location) {
  const Source source(location.path);
  sqlite::Database database = sqlite::OpenForeign(source);
  std::vector<GpsFix> fixes;
  for (const rtabmap::Node& node : rtabmap::ReadGraph(database, {}).nodes)
    if (node.gps) fixes.push_back(*node.gps);
  if (fixes.empty()) throw Error(ErrorKind::kNotFound, source.path, "table Node", "no node has a GPS fix");
  std::ranges::stable_sort(fixes, {}, &GpsFix::timestamp);
  return fixes;
}

}  // namespace slamdb
