// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/base/error.h"
#include "slamdb/base/notices.h"

namespace slamdb {

// What the Error says that the work throws; `no error` when it throws none.
template <class Work>
std::string MessageOf(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// What notices say, a line each.
inline std::string TextOf(const Notices& notices) {
  std::string all;
  for (const Notice& notice : notices.items()) all += notice.text + "\n";
  return all;
}

}  // namespace slamdb
