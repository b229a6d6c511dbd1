// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/stat.h>

namespace slamdb::detail {

// Gives an open file that nobody has seen yet the mode, owner and group of another, as far as the system permits. Where
// the group cannot stay, the new one gets no more than the old group and others both had. Returns whether the mode
// could be set.
bool TakeRights(const struct stat& of, int descriptor);

}  // namespace slamdb::detail
