// SPDX-License-Identifier: BSD-3-Clause
#include "cli/libraries.h"

namespace slamdb::cli {

void RememberWords(char**) {}

void GoOnWithLibraries() {}

}  // namespace slamdb::cli
