// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/src/errors.h"
#include "python/src/files.h"
#include "python/src/held_atlas.h"
#include "python/src/module.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/info.h"

// Reading and writing. slamdb/files.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

NoticeList ListOf(const Notices& notices) {
  NoticeList list;
  for (const Notice& notice : notices.items()) {
    const char* kind = notice.kind == Notice::Kind::kLoss      ? "loss"
                       : notice.kind == Notice::Kind::kWarning ? "warning"
                                                               : "note";
    list.emplace_back(kind, notice.text);
  }
  return list;
}

Selection SelectionOf(const Part& part) {
  Selection selection;
  if (part.map) selection.map = MapId(*part.map);
  if (part.keyframes) std::tie(selection.first_keyframe, selection.last_keyframe) = *part.keyframes;
  if (part.time) std::tie(selection.begin_time, selection.end_time) = *part.time;
  if (part.box) selection.box = Eigen::AlignedBox3f(part.box->first, part.box->second);
  return selection;
}

namespace {

ReadOptions ReadOptionsOf(const std::string& format, const Part& part, int threads, py::handle progress) {
  return {.format = format, .selection = SelectionOf(part), .threads = threads, .progress = ProgressTo(progress)};
}

template <class Read>
py::tuple ReadWith(const ReadOptions& options, const Read& read) {
  Notices notices;
  auto held = [&] {
    const py::gil_scoped_release unlocked;
    return std::make_shared<HeldAtlas>(read(options, notices));
  }();
  return py::make_tuple(std::move(held), ListOf(notices));
}

WriteOptions WriteOptionsOf(const std::string& format, bool overwrite, bool strict, bool sync, int threads,
                            py::handle progress) {
  return {.format = format,
          .strict = strict,
          .overwrite = overwrite,
          .sync = sync,
          .threads = threads,
          .progress = ProgressTo(progress)};
}

}  // namespace

void DefineFiles(py::module_& module) {
  py::class_<Part>(module, "Part")
      .def(py::init<>())
      .def_readwrite("map", &Part::map)
      .def_readwrite("keyframes", &Part::keyframes)
      .def_readwrite("time", &Part::time)
      .def_readwrite("box", &Part::box);

  module.def("read", [](const std::string& path, const std::string& format, const Part& part, int threads,
                        const py::object& progress) {
    return ReadWith(ReadOptionsOf(format, part, threads, progress), [&](const ReadOptions& options, Notices& notices) {
      return ReadAtlas(Location(path), options, &notices);
    });
  });
  module.def("decode", [](const py::bytes& bytes, const std::string& format, const Part& part, int threads,
                          const py::object& progress) {
    const std::string_view held(bytes);  // by the caller's argument
    return ReadWith(ReadOptionsOf(format, part, threads, progress),
                    [&](const ReadOptions& options, Notices& notices) { return DecodeAtlas(held, options, &notices); });
  });
  module.def("write", [](const HeldAtlas& atlas, const std::string& path, const std::string& format, bool overwrite,
                         bool strict, bool sync, int threads, const py::object& progress) {
    const WriteOptions options = WriteOptionsOf(format, overwrite, strict, sync, threads, progress);
    const auto value = atlas.value();
    Notices notices;
    {
      const py::gil_scoped_release unlocked;
      WriteAtlas(*value, Location(path), options, &notices);
    }
    return ListOf(notices);
  });
  module.def("encode", [](const HeldAtlas& atlas, const std::string& format, bool strict, int threads,
                          const py::object& progress) {
    const WriteOptions options = WriteOptionsOf(format, false, strict, false, threads, progress);
    const auto value = atlas.value();
    Notices notices;
    const std::string bytes = [&] {
      const py::gil_scoped_release unlocked;
      return EncodeAtlas(*value, options, &notices);
    }();
    return py::make_tuple(py::bytes(bytes), ListOf(notices));
  });
  module.def("info", [](const std::string& path, const std::string& format, int threads, const py::object& progress) {
    const ReadOptions options = ReadOptionsOf(format, {}, threads, progress);
    Notices notices;
    const std::string json = [&] {
      const py::gil_scoped_release unlocked;
      return ToJson(ReadInfo(Location(path), options, &notices), -1);
    }();
    return py::make_tuple(json, ListOf(notices));
  });
}

}  // namespace slamdb::python
