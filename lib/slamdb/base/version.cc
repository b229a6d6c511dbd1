// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/version.h"

#define SLAMDB_TEXT_OF(value) #value
#define SLAMDB_TEXT(value) SLAMDB_TEXT_OF(value)

namespace slamdb {

std::string_view Version() {
  return SLAMDB_TEXT(SLAMDB_VERSION_MAJOR) "." SLAMDB_TEXT(SLAMDB_VERSION_MINOR) "." SLAMDB_TEXT(SLAMDB_VERSION_PATCH);
}

}  // namespace slamdb
