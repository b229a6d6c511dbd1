// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/statistics.h"

namespace slamdb {

// What is in one atlas: its header, what is in each map, and what takes the space on disk.
struct AtlasInfo {
  std::string input;  // as it was named
  std::string format_id, format_title;
  std::optional<std::uint64_t> bytes;       // of the input; a store's too
  std::optional<ArchiveEncoding> encoding;  // of an .osa file, or an atlas in a store
  std::string layout;  // of a fork's file: the id of a known one, or its JSON; empty: ORB-SLAM3's own
  Vocabulary vocabulary;
  Counters next_ids;
  std::vector<Camera> cameras;
  std::uint64_t repeated_maps = 0;  // entries of the list of maps that are null or listed before
  AtlasStatistics statistics;       // empty when only the header was asked for
  std::vector<PartSize> parts;      // where the format can tell
  // Of each map the camera centres of its good keyframes in order of time, world; with the statistics. Not in the JSON.
  std::vector<std::vector<Eigen::Vector3f>> paths;
};

// The header of an atlas that was read from `input`, without statistics.
[[nodiscard]] SLAMDB_EXPORT AtlasInfo InfoOf(const Atlas& atlas, const Format& format, const std::string& input);

// Reads an atlas and describes it.
// `header_only` leaves out the statistics, which take most of the time.
//
// Throws Error as ReadAtlas does.
// Cost: linear.
[[nodiscard]] SLAMDB_EXPORT AtlasInfo ReadInfo(const Location& location, ReadOptions options = {},
                                               Notices* notices = nullptr, bool header_only = false);

// As schema/info.schema.json describes it.
// `indent` -1: on one line.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const AtlasInfo& info, int indent = 2);

// `unknown`, `monocular`, `stereo-or-rgbd`, `fisheye-stereo`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(MapSensor sensor);
// `pinhole`, `kannala-brandt-8`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(CameraModel model);
// The parameters' names in their order: fx, fy, ...
[[nodiscard]] SLAMDB_EXPORT std::vector<std::string> ParameterNames(CameraModel model);

}  // namespace slamdb
