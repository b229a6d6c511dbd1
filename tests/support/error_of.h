// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "slamdb/base/error.h"

namespace slamdb {

// The Error that the work throws; one of kind kInternal when it throws none.
inline Error ErrorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  return {ErrorKind::kInternal, "no error"};
}

// What a reader says of what it refuses: `line 3: expected a number`; `read` when it does not.
inline std::string RefusalOf(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    return (error.place().empty() ? "" : error.place() + ": ") + error.problem();
  }
  return "read";
}

}  // namespace slamdb
