// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/unlocked.h"

#include <atomic>

namespace slamdb::python {

namespace {

// After the interpreter, when the states of its threads are freed, CPython no longer knows that it was finalized.
std::atomic<bool> is_gone = false;
[[maybe_unused]] const int is_registered = Py_AtExit([] { is_gone = true; });

}  // namespace

void TakeGilBack(PyThreadState* state) {
  Parking parking;
  if (is_gone) return;  // into the parking
  PyEval_RestoreThread(state);
  parking.Disarm();
}

}  // namespace slamdb::python
