// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace slamdb::cli {

// A sentence of the library, which speaks of its own options and functions, in the words of the command:
// `is there already; WriteOptions::overwrite replaces it` becomes `is there already; -O/--overwrite replaces it`.
std::string InCommandWords(std::string_view sentence);

// The sentence, and the verb that helps where it tells of an atlas that is cut or damaged.
std::string WithRemedy(std::string_view sentence);

}  // namespace slamdb::cli
