// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/locate_text.h"

#include "cli/report/layout.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::cli {
namespace {

using detail::Concat;
using detail::Digits;

std::string LineOf(const LocatedPicture& picture) {
  const Localization& found = picture.localization;
  std::string line = Concat(picture.name, ": ", NameOf(found.verdict));
  if (found.verdict == LocateVerdict::kFound)
    line += Concat(" in ", picture.atlas.empty() ? "" : picture.atlas + " ", found.map, " at ",
                   Digits(found.position.x(), 5), " ", Digits(found.position.y(), 5), " ",
                   Digits(found.position.z(), 5), ", like ", found.resembles, ", ", found.evidence.inliers, " points");
  if (found.verdict != LocateVerdict::kFound) line += ": " + found.reason;
  if (picture.error)
    line += Concat("; error ", Digits(picture.error->position, 3), ", ", Digits(picture.error->rotation_degrees, 3),
                   " degrees");
  std::string others;
  for (const AtlasLocalization& other : picture.others)
    if (other.localization.verdict == LocateVerdict::kFound)
      others += Concat(others.empty() ? "" : ", ", other.atlas, " (", other.localization.evidence.inliers, ")");
  return line + (others.empty() ? "" : "; also in " + others) + "\n";
}

}  // namespace

std::string LocateText(const LocateReport& report, bool benchmark, bool verbose) {
  std::string text;
  for (const LocatedPicture& picture : report.pictures)
    if (!benchmark || verbose || picture.localization.verdict != LocateVerdict::kFound) text += LineOf(picture);
  const auto share = 100.0 * static_cast<double>(report.found()) / static_cast<double>(report.pictures.size());
  text += Concat("found ", report.found(), " of ", Counted(report.pictures.size(), benchmark ? "keyframe" : "picture"),
                 " (", detail::Fixed(share, 0), "%)\n");
  if (const auto median = report.MedianError(), largest = report.LargestError(); median && largest)
    text += Concat("error: median ", Digits(median->position, 3), ", ", Digits(median->rotation_degrees, 3),
                   " degrees; largest ", Digits(largest->position, 3), ", ", Digits(largest->rotation_degrees, 3),
                   " degrees\n");
  return text;
}

}  // namespace slamdb::cli
