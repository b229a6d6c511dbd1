// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/require_ceres.h"

#include "slamdb/base/error.h"
#include "slamdb/optimize/bundle_adjustment.h"

namespace slamdb::detail {

void RequireCeres() {
  if (!CanOptimize())
    throw Error(ErrorKind::kUnsupported,
                "this slamdb was built without Ceres, which optimises: install libceres-dev and build it again");
}

}  // namespace slamdb::detail
