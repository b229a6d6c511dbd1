// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "slamdb/base/progress.h"

// What goes wrong, and what is told meanwhile, between C++ and Python.
namespace slamdb::python {

// A path, or a sentence that names one, which may be any bytes: as os.fsdecode has it.
pybind11::str TextOf(const std::string& text);

// Makes an Error of the library the exception of slamdb/errors.py that its kind has.
void TranslateErrors();

// Calls `listener(stage, fraction)`, unless that is None, and stops the work where it throws or the user interrupts.
// `listener` must outlive the work.
Progress ProgressTo(pybind11::handle listener);

}  // namespace slamdb::python
