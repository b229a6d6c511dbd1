// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/formats/results.h"
#include "slamdb/plot/plot.h"

// Outputs that are no atlases.
namespace slamdb::cli {

// RefuseAtlas, of an output that nobody named, which is no symbolic link either: that would lead to what nobody meant.
void GuardDefaultName(const std::string& output);

// Ends with exit code 2 where browsers would not take it for a page.
void RequirePageName(const std::string& output);

// What a picture of that name is; - is SVG. Ends with exit code 2 where the name does not say it.
PlotFormat PictureFormatOf(const std::string& output);

}  // namespace slamdb::cli
