// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/warnings.h"

#include "slamdb/base/detail/concat.h"

namespace slamdb {

void WarnOfPoorCoverage(const Coverage& coverage, Notices& notices) {
  if (!coverage.poor()) return;
  notices.Warn(detail::Concat(
      "only ", coverage.covered, " of ", detail::Counted(coverage.covered_before, "place"),
      " that the atlas covers are left, less than 80%: from the others a camera will not be localised; keep more "
      "keyframes"));
}

}  // namespace slamdb
