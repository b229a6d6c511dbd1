// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

// Colours for what people read. Text comes in as it would be printed without them, escaped already, so that nothing in
// it can steer a terminal but what is added here.
namespace slamdb::cli {

enum class Colour { kBold, kDim, kRed, kYellow, kGreen };

std::string Painted(std::string_view text, Colour colour);

using Painter = std::string (*)(std::string_view text);

// Lines that begin at the margin are headings, without what stands behind two blanks: bold.
std::string PaintHeadings(std::string_view text);

// The report of `check`: its verdicts and the names of broken rules, by their severity.
std::string PaintFindings(std::string_view text);

}  // namespace slamdb::cli
