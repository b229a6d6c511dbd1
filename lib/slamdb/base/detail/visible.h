// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/export.h"

// What is written for people never steers their terminal, nor shows otherwise than it is: names come from files.
namespace slamdb::detail {

// The text with escapes in place of what cannot be seen or moves what stands beside it:
//   \n \r \t \e   line ends, tabs, the escape character
//   \x07 \x9b     other control characters, and bytes that are no UTF-8
//   \u202e        control characters from U+0080 on, line separators, what has no width, what changes the direction
// Everything else stays, the backslash too. For names in sentences and tables.
SLAMDB_EXPORT std::string Visible(std::string_view text);

// The same of a whole text for people, whose line ends and tabs stay.
SLAMDB_EXPORT std::string VisibleText(std::string_view text);

// Why a text cannot be the name that a user gives to something; empty when it can. Names have 1 to 255 bytes of UTF-8,
// of which Visible escapes none.
SLAMDB_EXPORT std::string_view ProblemOfName(std::string_view name);

}  // namespace slamdb::detail
