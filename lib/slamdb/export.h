// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Marks what the shared library gives to programs; everything else stays hidden in it.
#define SLAMDB_EXPORT __attribute__((visibility("default")))
