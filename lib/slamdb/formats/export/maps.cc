// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/maps.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"

namespace slamdb::detail {

std::vector<const Map*> ChooseMaps(const Atlas& atlas, const WriteOptions& options, const Target& target) {
  const std::optional<MapId> map = options.of<ExportOptions>().map;
  std::vector<const Map*> chosen;
  std::string known;
  for (const Map& candidate : atlas.maps) {
    if (!map || candidate.id == *map) chosen.push_back(&candidate);
    known += (known.empty() ? "" : ", ") + ToString(candidate.id);
  }
  if (map && chosen.empty())
    throw Error(ErrorKind::kNotFound, target.path, "",
                Concat("the atlas has no ", *map, "; it has ", known.empty() ? "no map at all" : known));
  return chosen;
}

void WarnOfSeveralFrames(const std::vector<const Map*>& maps, const std::string& how_told_apart, Notices& notices) {
  std::size_t filled = 0;
  for (const Map* map : maps) filled += map->keyframes.empty() && map->points.empty() ? 0 : 1;
  WarnOfSeveralFrames(filled, how_told_apart, notices);
}

void WarnOfSeveralFrames(std::size_t maps, const std::string& how_told_apart, Notices& notices) {
  if (maps < 2) return;
  notices.Warn(
      Concat(Thousands(maps),
             " maps are in one file, each in a frame of reference of its own and not aligned with the others: ",
             how_told_apart, ", and ExportOptions::map writes one alone"));
}

void WarnOfEdgesOutside(std::size_t edges, Notices& notices) {
  if (edges > 0)
    notices.Warn("left out, since they lead to keyframes that are not written with these: " + Counted(edges, "edge"));
}

}  // namespace slamdb::detail
