// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

// Skips a test where /proc is not mounted, as in a bare chroot: `/dev/stdout`, `/dev/fd/3` and bash's `<(...)` lead
// through it.
#define SLAMDB_NEEDS_PROC() \
  if (!std::filesystem::exists("/proc/self/fd")) GTEST_SKIP() << "/proc is not mounted"
