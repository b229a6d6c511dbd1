// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/page.h"

#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::plot {
namespace {

using detail::Concat;

// Cut off at a letter, with an ellipsis.
std::string Shortened(Canvas& canvas, std::string text, const TextStyle& style, double width) {
  if (canvas.WidthOf(text, style) <= width) return text;
  std::vector<std::size_t> ends;  // of letters; UTF-8 is cut between them
  for (std::size_t i = 0; i < text.size(); ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) ends.push_back(i);
  while (!ends.empty() && canvas.WidthOf(text.substr(0, ends.back()) + "\u2026", style) > width) ends.pop_back();
  return text.substr(0, ends.empty() ? 0 : ends.back()) + "\u2026";
}

}  // namespace

void RequireSizes(const PlotOptions& options) {
  constexpr int kLeast = 320, kMost = 4000;
  if (options.width < kLeast || options.width > kMost)
    throw Error(ErrorKind::kUsage, Concat("a plot is ", kLeast, " to ", kMost, " pixels wide, not ", options.width));
  if (!(options.scale >= 1 && options.scale <= 4))
    throw Error(ErrorKind::kUsage, Concat("a plot is scaled by 1 to 4, not by ", options.scale));
}

void DrawTitle(Canvas& canvas, const Theme& theme, const std::string& title, const std::string& summary, double width) {
  const TextStyle large{.color = theme.ink, .size = 15, .bold = true};
  const TextStyle below{.color = theme.faint_ink, .size = 11};
  const double room = width - 2 * kMargin;
  canvas.Text({kMargin, kMargin + 13}, Shortened(canvas, title, large, room), large);
  canvas.Text({kMargin, kMargin + 31}, Shortened(canvas, summary, below, room), below);
}

}  // namespace slamdb::plot
