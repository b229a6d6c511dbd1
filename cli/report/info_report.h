// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/model/statistics.h"

namespace slamdb::cli {

// What `slamdb info` knows of one atlas.
struct InfoReport {
  std::string file;
  std::string format_id, format_title;
  std::optional<std::uint64_t> size_bytes;  // of the file; a store's too
  Vocabulary vocabulary;
  ArchiveEncoding encoding;
  bool has_encoding = false;  // an .osa file, or an atlas in a store
  Counters next_ids;
  std::vector<Camera> cameras;
  std::uint64_t repeated_maps = 0;  // entries of the list of maps that are null or listed before
  AtlasStatistics statistics;
  std::vector<PartSize> parts;
};

// As schema/info.schema.json describes it.
nlohmann::ordered_json InfoJson(const InfoReport& report);

// For people.
std::string InfoText(const InfoReport& report);

// "Boost 1.73 to 1.75" for an archive library version; empty for one that is not known.
std::string BoostReleases(std::uint32_t version);

// "monocular", "stereo-or-rgbd", ...
std::string SensorName(MapSensor sensor);
std::string CameraModelName(CameraModel model);
// The parameters' names in their order: fx, fy, ...
std::vector<std::string> ParameterNames(CameraModel model);

}  // namespace slamdb::cli
