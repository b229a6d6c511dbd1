// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/extract.h"

#include <algorithm>

#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

bool HoldsMap(const Subset& subset) {
  return std::ranges::any_of(subset.maps, [](const Subset::MapRows& rows) {
    return std::ranges::count(rows.keyframes, 1) > 0 || std::ranges::count(rows.landmarks, 1) > 0;
  });
}

}  // namespace

ExtractReport Extract(Atlas& atlas, const ExtractOptions& options) {
  if (options.part.except && options.border == Border::kCompletePoints)
    throw Error(ErrorKind::kUsage,
                "complete points would bring back what is excepted; settle the border strictly or smartly");
  detail::Steps steps(options.progress, "extracting", 2);
  ExtractReport report;
  Subset subset;
  {
    const AtlasIndex index(atlas);
    subset = Select(index, options.part);
    SettleBorder(index, options.border, subset, options.threads);
    if (!HoldsMap(subset))
      throw Error(ErrorKind::kNotPossible,
                  "no keyframe is in that part, only points; a region of points alone, or a border of complete points, "
                  "takes the keyframes that observe them");
    report.coverage = MeasureCoverage(index, subset);
  }
  steps.Next();
  report.removed = KeepSubset(atlas, subset, options.threads);
  steps.Next();
  return report;
}

}  // namespace slamdb
