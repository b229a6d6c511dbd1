// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

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

}  // namespace slamdb
