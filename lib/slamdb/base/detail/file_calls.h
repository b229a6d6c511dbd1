// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstddef>

namespace slamdb::detail {

// The system calls by which AtomicFile writes, so that tests can let each of them fail.
struct FileCalls {
  ssize_t (*write)(int, const void*, std::size_t);
  int (*fsync)(int);
  int (*close)(int);
  int (*rename)(const char*, const char*);
  int (*renameat2)(int, const char*, int, const char*, unsigned int);
  int (*link)(const char*, const char*);
  int (*unlink)(const char*);
};

// Those in use: the system's. Not to be changed while files are written on other threads.
FileCalls& CallsOfFiles();

}  // namespace slamdb::detail
