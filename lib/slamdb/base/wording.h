// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace slamdb {

// How a program that uses the library says its sentences, which speak of functions and options of the library: of
// `MakePoints` the command makes `slamdb landmarks to-points`. Empty: as they are.
using Wording = std::function<std::string(std::string_view sentence)>;

inline std::string Worded(std::string_view sentence, const Wording& wording) {
  return wording ? wording(sentence) : std::string(sentence);
}

}  // namespace slamdb
