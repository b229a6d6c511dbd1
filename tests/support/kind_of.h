// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>

#include "slamdb/base/error.h"

namespace slamdb {

// The kind of the Error that the work throws; none when it throws none.
inline std::optional<ErrorKind> KindOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.kind();
  }
  return std::nullopt;
}

}  // namespace slamdb
