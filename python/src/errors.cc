// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/errors.h"

#include <exception>
#include <string>

#include "python/src/unlocked.h"
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

namespace {

// With the GIL held. Python lets go of it now and then while the listener runs.
void Tell(py::handle listener, std::string_view stage, double fraction) {
  ThrowIfInterrupted();
  if (listener.is_none()) return;
  const py::tuple told = py::make_tuple(std::string(stage), fraction);
  PyObject* result = Parkable([&] { return PyObject_CallObject(listener.ptr(), told.ptr()); });
  if (result == nullptr) throw py::error_already_set();
  Py_DECREF(result);
}

}  // namespace

Progress ProgressTo(py::handle listener) {
  return [listener](std::string_view stage, double fraction) {
    Parking parking;
    const py::gil_scoped_acquire locked;
    parking.Disarm();
    Tell(listener, stage, fraction);
  };
}

}  // namespace slamdb::python
