// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/base/detail/text.h"
#include "slamdb/base/notices.h"

// Text whose last line has no end. Where lines are records, that alone tells of one that was cut off in a number: it is
// a shorter number.
namespace slamdb::detail {

// Whether the last line holds something and has no end.
inline bool HasOpenEnd(std::string_view text) {
  const std::size_t end = text.find_last_of("\r\n");
  return !Trimmed(end == std::string_view::npos ? text : text.substr(end + 1)).empty();
}

// What every reader of lines that are records says of a file that has one.
inline std::string OpenEndWarning(const std::string& path) {
  return path + ": the last line has no end of line: the file may be cut there";
}

inline void WarnOfOpenEnd(std::string_view text, const std::string& path, Notices& notices) {
  if (HasOpenEnd(text)) notices.Warn(OpenEndWarning(path));
}

}  // namespace slamdb::detail
