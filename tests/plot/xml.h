// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace slamdb::testing {

// Why a text is no well-formed XML; empty when it is. Knows elements, attributes, text, the five entities and numbers,
// and the line that a document begins with.
std::string ProblemOfXml(std::string_view text);

}  // namespace slamdb::testing
