// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <utility>

#include "python/src/held_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "slamdb/formats/formats.h"

// Copies of an atlas, here and in other processes.
namespace slamdb::python {

namespace py = pybind11;

namespace {

std::string Encoded(const Atlas& atlas, const char* format) {
  WriteOptions options;
  options.format = format;
  options.strict = true;
  return EncodeAtlas(atlas, options);
}

// In the quicker of two formats that loses nothing. Files of forks may take a layout that only their user has.
std::pair<std::string, std::string> Kept(const Atlas& atlas) {
  if (!atlas.layout.empty()) return {"ndjson", Encoded(atlas, "ndjson")};
  try {
    return {"orbslam3", Encoded(atlas, "orbslam3")};
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kNotPossible) throw;
    return {"ndjson", Encoded(atlas, "ndjson")};
  }
}

py::tuple Reduced(const HeldAtlas& atlas) {
  const auto [format, bytes] = WithoutGil([value = atlas.value()] { return Kept(*value); });
  const py::object decode = py::module_::import("slamdb.pickling").attr("unpickled");
  return py::make_tuple(decode, py::make_tuple(format, py::bytes(bytes)));
}

std::shared_ptr<HeldAtlas> Unpickled(const std::string& format, const py::bytes& bytes) {
  const std::string_view held(bytes);  // by the caller's argument
  return WithoutGil([&] {
    ReadOptions options;
    options.format = format;
    return std::make_shared<HeldAtlas>(DecodeAtlas(held, options));
  });
}

std::shared_ptr<HeldAtlas> CopyOf(const HeldAtlas& atlas) {
  return WithoutGil([value = atlas.value()] { return std::make_shared<HeldAtlas>(*value); });
}

}  // namespace

void DefinePickling(py::module_& module) {
  module.def("unpickled", &Unpickled);
  Reopen<py::class_<HeldAtlas, std::shared_ptr<HeldAtlas>>>(module, "Atlas")
      .def("copy", &CopyOf, "An atlas of its own, with the same content, and no history.")
      .def("__copy__", &CopyOf)
      .def("__deepcopy__", [](const HeldAtlas& atlas, const py::dict&) { return CopyOf(atlas); })
      .def("__reduce__", &Reduced);
}

}  // namespace slamdb::python
