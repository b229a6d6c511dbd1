// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"

// Words of the command line come out again everywhere: in errors, reports, pages, histories. So the command takes the
// passwords of servers out of them before anything else sees them; what connects asks for them here.
//
// One list for the process, which nothing but the command fills: in a program of several users the password of one must
// not open the database for another. Thread-safe.
namespace slamdb::detail {

// A word of the command line without the password of the URI that is it, or that it ends with
// (`--onto=postgresql://...`), and remembers that. Of one URI with several passwords the last one counts. Also without
// that of `host=lab password=x`, which is forgotten.
SLAMDB_EXPORT std::string HidePassword(std::string word);

// The path of a location as it was before; as it is where nothing was hidden.
SLAMDB_EXPORT std::string WithHiddenPassword(const std::string& path);

}  // namespace slamdb::detail
