// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/files.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/src/arguments.h"
#include "python/src/arrays.h"
#include "python/src/module.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/info.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/sqlite/options.h"

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

Selection ReadSelectionOf(Arguments& given) {
  Selection selection;
  if (given.Has("map")) selection.map = MapId(given.Get<std::uint64_t>("map"));
  std::tie(selection.first_keyframe, selection.last_keyframe) =
      given.Get("keyframes", std::pair(selection.first_keyframe, selection.last_keyframe));
  std::tie(selection.begin_time, selection.end_time) =
      given.Get("time", std::pair(selection.begin_time, selection.end_time));
  if (given.Has("box")) {
    RequireNumpy();
    const auto box = given.Get<std::pair<Eigen::Vector3f, Eigen::Vector3f>>("box");
    selection.box = Eigen::AlignedBox3f(box.first, box.second);
  }
  return selection;
}

ReadOptions ReadingOf(Arguments& given) {
  ReadOptions read{.selection = ReadSelectionOf(given)};
  given.Take("format", read.format);
  read.of<Orbslam3ReadOptions>().layout = LayoutNamed(given.Path("layout"));
  given.Take("wait", read.of<StoreReadOptions>().lock_timeout, cli::kNonNegative);
  given.TakeRun(read);
  return read;
}

namespace {

WriteOptions WritingOf(Arguments& given) {
  WriteOptions write;
  given.Take("format", write.format);
  given.Take("strict", write.strict);
  given.Take("overwrite", write.overwrite);
  given.Take("sync", write.sync);
  given.Take("wait", write.of<StoreWriteOptions>().lock_timeout, cli::kNonNegative);
  if (given.Has("layout")) write.of<Orbslam3WriteOptions>().layout = LayoutNamed(given.Path("layout"));
  given.TakeRun(write);
  return write;
}

// `work(notices)` without the GIL; its result, and what it had to say.
template <class Work>
auto Told(const Work& work) {
  Notices notices;
  auto result = [&] {
    const py::gil_scoped_release unlocked;
    return work(notices);
  }();
  return std::pair(std::move(result), ListOf(notices));
}

using Made = std::pair<std::shared_ptr<HeldAtlas>, NoticeList>;

Made Read(const py::object& source, const py::dict& values) {
  Arguments given(values);
  const ReadOptions options = ReadingOf(given);
  given.RequireAllTaken();
  if (py::isinstance<py::bytes>(source))
    return Told([&, held = std::string_view(py::reinterpret_borrow<py::bytes>(source))](Notices& notices) {
      return std::make_shared<HeldAtlas>(DecodeAtlas(held, options, &notices));
    });
  return Told([&, path = Location(TextOfPath(source))](Notices& notices) {
    return std::make_shared<HeldAtlas>(ReadAtlas(path, options, &notices));
  });
}

NoticeList Write(const HeldAtlas& atlas, const py::object& path, const py::dict& values) {
  Arguments given(values);
  const WriteOptions options = WritingOf(given);
  given.RequireAllTaken();
  const Location to(TextOfPath(path));
  return Told([&, value = atlas.value()](Notices& notices) {
           WriteAtlas(*value, to, options, &notices);
           return true;
         })
      .second;
}

py::tuple Encode(const HeldAtlas& atlas, const py::dict& values) {
  Arguments given(values);
  const WriteOptions options = WritingOf(given);
  given.RequireAllTaken();
  const auto [bytes, notices] =
      Told([&, value = atlas.value()](Notices& told) { return EncodeAtlas(*value, options, &told); });
  return py::make_tuple(py::bytes(bytes), notices);
}

std::pair<std::string, NoticeList> Info(const py::object& path, const py::dict& values) {
  Arguments given(values);
  const ReadOptions options = ReadingOf(given);
  given.RequireAllTaken();
  const Location from(TextOfPath(path));
  return Told([&](Notices& notices) { return ToJson(ReadInfo(from, options, &notices), -1); });
}

}  // namespace

void DefineFiles(py::module_& module) {
  module.def("read", &Read);
  module.def("write", &Write);
  module.def("encode", &Encode);
  module.def("info", &Info);
}

}  // namespace slamdb::python
