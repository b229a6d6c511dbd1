// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/unlocked.h"

namespace slamdb::python {

void TakeGilBack(PyThreadState* state) {
  Parking parking;
  PyEval_RestoreThread(state);
  parking.Disarm();
}

}  // namespace slamdb::python
