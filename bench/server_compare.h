// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace slamdb::bench {

// A store on a server of its own, through its socket, beside one in a file, as markdown.
//
// Each row is measured in pairs, the one and the other in turn: medians, the processor time of the client and of the
// server, and the ratio of the pairs with its least and greatest. Rows that say so have something else beside them.
int CompareStores(const std::string& path, int rounds);

}  // namespace slamdb::bench
