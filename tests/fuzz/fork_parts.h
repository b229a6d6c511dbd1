// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace slamdb::fuzz {

// A layout, as JSON or by its id, and an archive behind it, in one input.
struct ForkParts {
  std::string_view layout, archive;
};

inline constexpr std::string_view kForkMark = "\x1e<ARCHIVE>\x1e";

inline ForkParts SplitFork(std::string_view input) {
  const std::size_t end = input.find(kForkMark);
  if (end == input.npos) return {input, {}};
  return {input.substr(0, end), input.substr(end + kForkMark.size())};
}

inline std::string JoinFork(std::string_view layout, std::string_view archive) {
  return std::string(layout).append(kForkMark).append(archive);
}

}  // namespace slamdb::fuzz
