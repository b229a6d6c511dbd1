// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/plot/detail/canvas.h"
#include "slamdb/plot/plot.h"

// What every page has around its panels.
namespace slamdb::plot {

inline constexpr double kMargin = 14, kTitleHeight = 44;

// Throws Error (kUsage) for a width or a scale out of range.
void RequireSizes(const PlotOptions& options);

// Where the panels begin.
inline double TopOfPage(const PlotOptions& options) { return options.title.empty() ? kMargin : kMargin + kTitleHeight; }

// The title in bold, and what there is to see below it.
void DrawTitle(Canvas& canvas, const Theme& theme, const std::string& title, const std::string& summary, double width);

}  // namespace slamdb::plot
