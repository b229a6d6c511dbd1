// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/errors.h"

#include <exception>
#include <string>

#include "slamdb/base/error.h"

namespace slamdb::python {

namespace py = pybind11;

py::str TextOf(const std::string& text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
}

namespace {

void Raise(const Error& error) {
  const py::object made = py::module_::import("slamdb.errors")
                              .attr("make_error")(std::string(ToString(error.kind())), TextOf(error.path()),
                                                  TextOf(error.place()), TextOf(error.problem()));
  PyErr_SetObject(py::type::handle_of(made).ptr(), made.ptr());
}

}  // namespace

void TranslateErrors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      Raise(error);
    }
  });
}

Progress ProgressTo(py::handle listener) {
  return [listener](std::string_view stage, double fraction) {
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!listener.is_none()) listener(std::string(stage), fraction);
  };
}

}  // namespace slamdb::python
