// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace slamdb::fuzz {

// The five files of a model in one input: `b` or `t`, then the files with a mark between them.
struct ColmapParts {
  bool binary = true;
  std::array<std::string, 5> files;
};

inline constexpr std::string_view kColmapMark = "\x1e<COLMAP>\x1e";

inline ColmapParts SplitColmap(std::string_view input) {
  ColmapParts parts{.binary = !input.starts_with('t'), .files = {}};
  input.remove_prefix(input.empty() ? 0 : 1);
  for (std::string& file : parts.files) {
    const std::size_t end = input.find(kColmapMark);
    file = input.substr(0, end);
    input.remove_prefix(end == input.npos ? input.size() : end + kColmapMark.size());
  }
  return parts;
}

inline std::string JoinColmap(const ColmapParts& parts) {
  std::string input = parts.binary ? "b" : "t";
  for (const std::string& file : parts.files) input.append(file).append(kColmapMark);
  return input;
}

}  // namespace slamdb::fuzz
