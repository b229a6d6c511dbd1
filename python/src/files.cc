// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/files.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/src/arguments.h"
#include "python/src/errors.h"
#include "python/src/module.h"
#include "python/src/selections.h"
#include "python/src/unlocked.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/info.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/results.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/many/selected.h"

// Reading and writing. slamdb/files.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

py::list ListOf(const Notices& notices) {
  py::list list;
  for (const Notice& notice : notices.items()) {
    const char* kind = notice.kind == Notice::Kind::kLoss      ? "loss"
                       : notice.kind == Notice::Kind::kWarning ? "warning"
                                                               : "note";
    list.append(py::make_tuple(kind, TextOf(detail::WithoutPasswords(notice.text))));
  }
  return list;
}

void RefuseIdleSelection(const AtlasOrPath& source, const ReadOptions& read) {
  if (source.atlas && !read.selection.everything())
    throw Error(ErrorKind::kUsage,
                "map=, keyframes=, time= and box= are for a source that is a path; `Extract` keeps a "
                "part of an atlas");
}

ReadOptions ReadingOf(Arguments& given) {
  ReadOptions read;
  TakePart(given, read.selection);
  given.Take("format", read.format);
  read.of<Orbslam3ReadOptions>().layout = LayoutNamed(given.Path("layout"));
  given.Take("wait", read.of<StoreReadOptions>().lock_timeout, cli::kNonNegative);
  given.TakeRun(read);
  return read;
}

void LoseRest(const HeldAtlas& atlas, const Format& format, bool strict, Notices& notices) {
  if (!atlas.is_part() || !HasAny(format.writes, Content::kObservations)) return;
  const std::string loss =
      "only a part of the atlas was read: what refers to the rest leads nowhere; `Extract` makes a "
      "whole of a part";
  if (strict) throw Error(ErrorKind::kNotPossible, loss + "; WriteOptions::strict refuses that");
  notices.Lose(loss);
}

std::shared_ptr<HeldAtlas> MarkedAtlas(Atlas atlas, Selection selection) {
  auto held = std::make_shared<HeldAtlas>(std::move(atlas));
  selection.map.reset();  // whole maps refer to nothing else
  if (!selection.everything()) held->MarkAsPart();
  return held;
}

std::shared_ptr<const Atlas> Hold(const AtlasOrPath& source, const ReadOptions& read, Notices& notices) {
  if (source.atlas) return source.atlas;
  return std::make_shared<const Atlas>(ReadAtlas(Location(source.path), read, &notices));
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
  auto result = WithoutGil([&] { return work(notices); });
  return std::pair(std::move(result), ListOf(notices));
}

auto Read(const py::object& source, const py::dict& values) {
  Arguments given(values);
  const ReadOptions options = ReadingOf(given);
  given.RequireAllTaken();
  if (py::isinstance<py::bytes>(source))
    return Told([&, held = std::string_view(py::reinterpret_borrow<py::bytes>(source))](Notices& notices) {
      return MarkedAtlas(DecodeAtlas(held, options, &notices), options.selection);
    });
  return Told([&, path = TextOfPath(source)](Notices& notices) {
    const HeldSource held = HoldInput(Location(path), options);
    Atlas atlas = ReadAtlas(held, options, &notices);
    if (!options.selection.everything()) RefuseEmptySelection(atlas, path, held, options);
    return MarkedAtlas(std::move(atlas), options.selection);
  });
}

py::list Write(const HeldAtlas& atlas, const py::object& path, const py::dict& values) {
  Arguments given(values);
  const WriteOptions options = WritingOf(given);
  given.RequireAllTaken();
  const Location to(TextOfPath(path));
  const Format& format = FormatOfOutput(to, options.format);
  if (to.name.empty() && format.is_export) RefuseAtlas(to.path);
  return Told([&, value = atlas.value()](Notices& notices) {
           LoseRest(atlas, format, options.strict, notices);
           WriteAtlas(*value, to, options, &notices);
           return true;
         })
      .second;
}

py::tuple Encode(const HeldAtlas& atlas, const py::dict& values) {
  Arguments given(values);
  const WriteOptions options = WritingOf(given);
  given.RequireAllTaken();
  const auto [bytes, notices] = Told([&, value = atlas.value()](Notices& told) {
    LoseRest(atlas, FormatById(options.format), options.strict, told);
    return EncodeAtlas(*value, options, &told);
  });
  return py::make_tuple(py::bytes(bytes), notices);
}

auto Info(const py::object& path, const py::dict& values) {
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
