// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/detail/own.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/live/runtime.h"

namespace slamdb::live {

using slamdb::detail::Concat;

Runtime& NoAtlas() {
  static Runtime runtime;
  return runtime;
}

void RefuseNull(std::string_view what) { throw Error(ErrorKind::kUsage, Concat(what, " is a null pointer")); }

void RefuseForeign(std::string_view what) {
  throw Error(ErrorKind::kUsage, Concat(what, " is not of this atlas: objects of two atlases cannot be linked"));
}

}  // namespace slamdb::live
