// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/base/file.h"
#include "slamdb/export.h"

// What pages and pictures hold of texts and bytes from files.
namespace slamdb::detail {

// The text as text of HTML and XML, also in an attribute in quotes: nothing in it is markup, steers or hides.
SLAMDB_EXPORT std::string EscapedMarkup(std::string_view text);

// RFC 4648, with padding.
SLAMDB_EXPORT std::string Base64(Bytes bytes);

// What a content security policy calls an inline script or style: `'sha256-...'`.
SLAMDB_EXPORT std::string PolicySource(std::string_view inline_text);

}  // namespace slamdb::detail
