// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/georeference.h"

#include <filesystem>

#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"

namespace slamdb {

std::vector<TimedPosition> PositionsIn(const LocalFrame& frame, const std::vector<GpsFix>& fixes) {
  std::vector<TimedPosition> positions;
  positions.reserve(fixes.size());
  for (const GpsFix& fix : fixes) positions.push_back({fix.timestamp, frame.FromGeodetic(fix.place)});
  return positions;
}

std::string GeoreferencePath(const std::string& atlas) { return atlas + ".georeference.json"; }

std::optional<Georeference> FindGeoreference(const std::string& atlas) {
  const std::string path = GeoreferencePath(atlas);
  std::error_code missing;
  if (detail::IsServer(atlas) || !std::filesystem::exists(path, missing)) return std::nullopt;
  const WholeFile file(path);
  try {
    const detail::Json json = detail::Json::parse(file.text());
    const detail::Json& origin = json.at("georeference");
    Georeference found{{origin.at("latitude"), origin.at("longitude"), origin.at("altitude")}, {}};
    for (const detail::Json& map : json.at("maps"))
      found.maps.emplace_back(detail::IntegerOf<std::uint64_t>(map.at("id")));
    if (IsPlace(found.origin)) return found;
  } catch (const detail::Json::exception&) {  // answered below
  }
  throw Error(ErrorKind::kDamaged, path, "",
              "holds no origin as georeferencing writes it: latitude, longitude, altitude");
}

}  // namespace slamdb
