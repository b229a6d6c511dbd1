// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "tests/fuzz/files.h"

namespace slamdb::fuzz {

// The five files of a model in one input: `b` or `t`, then the files.
struct ColmapParts {
  bool binary = true;
  std::array<std::string, 5> files;
};

inline ColmapParts SplitColmap(std::string_view input) {
  return {.binary = !input.starts_with('t'), .files = SplitFiles<5>(input.substr(input.empty() ? 0 : 1))};
}

inline std::string JoinColmap(const ColmapParts& parts) { return (parts.binary ? "b" : "t") + JoinFiles(parts.files); }

}  // namespace slamdb::fuzz
