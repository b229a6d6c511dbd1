// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <cstdlib>

#include "slamdb/base/error.h"

namespace slamdb::fuzz {

// Ends the fuzzer with a find when what must hold does not.
inline void Require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

// Runs what may refuse its input, but only with an Error that is not the library's own fault.
template <class Work>
void MayRefuse(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    Require(error.kind() != ErrorKind::kInternal, error.what());
  }
}

}  // namespace slamdb::fuzz
