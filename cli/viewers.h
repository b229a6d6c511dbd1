// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "cli/help/tree.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/formats/format.h"

// What exports for other viewers show: colours, cameras, the place on earth.
namespace slamdb::cli {

struct ViewerOptions {
  std::string color, origin;
  bool cameras = false;
  std::optional<std::size_t> most_points;
};

// --color, --cameras, --origin and --most-points.
void AddViewerOptions(CLI::App& verb, ViewerOptions& options);

// Throws CLI::ValidationError when one of them would be without effect on an output of the format.
void RefuseIdleViewerOptions(const Format& output, const ViewerOptions& options);

// Puts them into what is asked of the writer. `ascii`: point clouds as text.
void SetViewerOptions(const ViewerOptions& options, bool ascii, WriteOptions& write);

// Where on earth the maps of the input are, for an output that asks for it: as asked for, or as `transform` has kept it
// beside the input. Throws CLI::ValidationError where nothing tells it.
std::optional<Georeference> WhereOnEarth(const ViewerOptions& options, const std::string& input, const Format& output,
                                         Notices& notices);

}  // namespace slamdb::cli
