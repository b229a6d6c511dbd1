// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// Pictures of maps for papers, pages and logs. Drawn by Cairo.
namespace slamdb {

enum class PlotKind {
  kOverview,      // plan, side, and a small one of the most telling others
  kPlan,          // from above: points, trajectory, loop and merge edges
  kSide,          // the same from the side
  kCovisibility,  // how many points each pair of keyframes shares
  kTracks,        // points by how many keyframes observe them
  kObservations,  // keyframes by how many points they observe
  kReprojection,  // reprojection error over the image, and how it is distributed
  kTimeline,      // keyframes over time with what they observe, and the gaps between them
  kTrajectory,    // the trajectory alone, or laid onto a reference and coloured by its error
};

// `overview`, `plan`, ...; none of that name: nullopt.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(PlotKind kind);
[[nodiscard]] SLAMDB_EXPORT std::optional<PlotKind> PlotKindByName(std::string_view name);
[[nodiscard]] SLAMDB_EXPORT std::span<const PlotKind> PlotKinds();

enum class PlotFormat { kSvg, kPng };

// By the suffix of a file: .svg or .png; of a device or a pipe SVG.
//
// Throws Error (kUsage) for another one.
[[nodiscard]] SLAMDB_EXPORT PlotFormat PlotFormatOf(const std::string& path);

// A truth, and how far trajectories of the atlas are from it.
struct PlotReference {
  std::vector<TrajectoryPose> poses;  // all of the truth
  EvaluationReport evaluation;        // against it; errors are those that EvaluateTrajectories found
  std::string unit = "m";             // of the truth
};

struct PlotOptions {
  PlotKind kind = PlotKind::kOverview;
  PlotFormat format = PlotFormat::kSvg;
  int width = 800;        // pixels, 320 to 4000; the height follows
  double scale = 1;       // of PNG: pixels for each pixel of the width, 1 to 4
  bool dark = false;      // light ink on a dark page
  bool together = false;  // all maps in one frame, which they share only when something aligned them; otherwise each
                          // map of a plan has a place of its own
  std::string title;      // above the picture; empty: none
  std::optional<PlotReference> reference;  // what PlotKind::kTrajectory is held against; nullopt: nothing
  int threads = 0;                         // 0: every core
};

struct Plot {
  std::string bytes;         // an SVG document, or a PNG file
  double width = 0;          // pixels of the page
  double height = 0;         // likewise
  std::string text;          // what there is to see, in a sentence
  std::size_t points = 0;    // drawn of a plan or side view: those that are good, finite and near the rest
  std::size_t left_out = 0;  // points and keyframes of a plan or side view that are too far off, or at no place
};

// Whether plots can be drawn: slamdb was built with Cairo.
[[nodiscard]] SLAMDB_EXPORT bool CanPlot();

// Draws an atlas, which may hold anything.
// The same atlas and options give the same bytes wherever fonts and libraries are the same, whatever the threads.
//
// Throws Error:
//   kUnsupported  slamdb was built without Cairo
//   kUsage        width or scale out of range
//   kNotPossible  there is no evaluation beside the reference
// Cost: linear in keyframes, points and observations; the size of the file is bounded by that of the page.
// Thread-safe.
[[nodiscard]] SLAMDB_EXPORT Plot DrawPlot(const Atlas& atlas, const PlotOptions& options = {});

// Several pictures of one atlas, which is looked up and measured once for all of them.
//
// Throws Error as DrawPlot does.
[[nodiscard]] SLAMDB_EXPORT std::vector<Plot> DrawPlots(const Atlas& atlas, std::span<const PlotOptions> pictures);

// A plan without words and paper, as PNG of that many pixels; `dark`: for a dark page.
//
// Throws Error as DrawPlot does.
[[nodiscard]] SLAMDB_EXPORT Plot DrawThumbnail(const Atlas& atlas, int width, int height, bool dark = false);

}  // namespace slamdb
