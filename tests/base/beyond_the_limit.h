// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "slamdb/base/detail/sanitizers.h"
#include "slamdb/base/memory.h"

namespace slamdb {

inline constexpr std::size_t kMegabyte = std::size_t{1} << 20;
inline constexpr const char* kOnDisk = "/var/tmp";

class ColumnsBeyondTheLimit : public ::testing::Test {
 protected:
  void SetUp() override {
    if (SLAMDB_ADDRESS_SANITIZER || SLAMDB_THREAD_SANITIZER) GTEST_SKIP() << "columns are plain memory";
    SetMemoryLimit({.bytes = 1, .spill_folder = kOnDisk});
  }
  void TearDown() override { SetMemoryLimit({}); }
};

}  // namespace slamdb
