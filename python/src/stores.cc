// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/src/arguments.h"
#include "python/src/errors.h"
#include "python/src/files.h"
#include "python/src/module.h"
#include "python/src/selections.h"
#include "python/src/unlocked.h"
#include "python/src/verb.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/location.h"
#include "slamdb/formats/store/report.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/add.h"
#include "slamdb/many/inputs.h"
#include "slamdb/many/selected.h"

// Stores. slamdb/store.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

// Every call opens the store for itself: threads may share it, no lock is held between calls, and all that other
// programs save is seen.
struct StoreFile {
  std::string path;
  double wait = 5;
  bool sync = true;

  Store Reader() const { return Store::Open(path, wait); }
  Store Writer(const Progress& progress) const {
    return Store::OpenForWriting(path, {.sync = sync, .lock_timeout = wait, .progress = progress});
  }
  // A name that is mistyped must not make a store.
  Store WriterOfPresent(const Progress& progress) const {
    Reader();
    return Writer(progress);
  }
};

py::dict RowsOf(const TableChanges& rows) {
  py::dict dict;
  dict["inserted"] = rows.inserted;
  dict["updated"] = rows.updated;
  dict["deleted"] = rows.deleted;
  dict["unchanged"] = rows.unchanged;
  return dict;
}

py::tuple SaveTo(const StoreFile& file, const std::string& name, const HeldAtlas& atlas, bool overwrite,
                 bool keep_equal, const std::string& provenance, int threads, const py::object& listener) {
  const Progress progress = ProgressTo(listener);
  const SaveOptions options{.provenance = provenance,
                            .overwrite = overwrite,
                            .keep_equal = keep_equal,
                            .verify = true,
                            .threads = threads,
                            .progress = progress};
  Notices notices;
  LoseRest(atlas, FormatById("store"), /*strict=*/false, notices);
  const auto value = atlas.value();
  const SaveReport report = WithoutGil([&] { return file.Writer(progress).Save(name, *value, options); });
  py::dict told;
  told["replaced"] = report.replaced;
  told["unchanged"] = report.unchanged;
  told["revision"] = report.revision == 0 ? py::object(py::none()) : py::object(py::int_(report.revision));
  told["rows"] = RowsOf(report.Total());
  return py::make_tuple(told, ListOf(notices));
}

// map, keyframes, time, box, features, threads, progress.
std::shared_ptr<HeldAtlas> LoadFrom(const StoreFile& file, const std::string& name, const py::dict& values) {
  Arguments given(values);
  ReadOptions options{.features = given.Get<bool>("features") ? FeatureColumns::kAll : FeatureColumns::kNone};
  TakePart(given, options.selection);
  given.TakeRun(options);
  given.RequireAllTaken();
  return WithoutGil([&] {
    Atlas atlas = file.Reader().Load(name, options);
    if (!options.selection.everything())
      RefuseEmptySelection(atlas, name, HoldInput(Location(file.path, name)), options);
    auto held = MarkedAtlas(std::move(atlas), options.selection);
    if (options.features != FeatureColumns::kAll) held->MarkAsPart();
    return held;
  });
}

py::tuple AddTo(const StoreFile& file, const std::vector<std::string>& paths, bool recursive, const std::string& name,
                const std::string& name_from, bool overwrite, bool dry_run, const std::string& format,
                const std::string& layout, int threads, const py::object& listener) {
  if (name_from != "stem" && name_from != "path") throw py::value_error("name_from is 'stem' or 'path'");
  const Progress progress = ProgressTo(listener);
  const AddOptions options{.name_from = name_from == "path" ? AddOptions::NameFrom::kPath : AddOptions::NameFrom::kStem,
                           .name = name,
                           .overwrite = overwrite,
                           .dry_run = dry_run,
                           .format = format,
                           .layout = layout,
                           .sync = file.sync,
                           .lock_timeout = file.wait,
                           .provenance = "add ",
                           .threads = threads,
                           .progress = progress};
  const AddReport report = WithoutGil([&] {
    const AtlasInputs inputs =
        FindAtlases(paths, {.recursive = recursive, .lock_timeout = file.wait, .progress = progress});
    return AddToStore(file.path, inputs, options);
  });
  py::list told;
  for (const AddedAtlas& atlas : report.atlases)
    for (const py::handle each : ListOf(atlas.notices))
      told.append(py::make_tuple(each[py::int_(0)], TextOf(atlas.input + ": ") + py::str(each[py::int_(1)])));
  return py::make_tuple(Report(ToJson(report)), told);
}

py::dict MigrateFile(const StoreFile& file, bool back, bool dry_run, bool backup) {
  const bool is_server = Location(file.path).is_server();  // of which pg_dump makes a copy
  const MigrateReport report = WithoutGil([&] {
    return MigrateStore(file.path,
                        {.back = back, .dry_run = dry_run, .backup = backup && !is_server, .lock_timeout = file.wait});
  });
  py::dict told;
  told["from_version"] = report.from;
  told["to_version"] = report.to;
  told["steps"] = report.steps;
  told["backup"] = report.backup.empty() ? py::object(py::none()) : py::object(TextOf(report.backup));
  return told;
}

py::list NamesIn(const StoreFile& file) {
  py::list names;
  for (const std::string& name : WithoutGil([&] { return file.Reader().Names(); })) names.append(TextOf(name));
  return names;
}

void DefineLooking(py::class_<StoreFile>& store) {
  store.def("names", &NamesIn)
      .def("load", &LoadFrom)
      .def(
          "is_made",
          [](const StoreFile& file) { return !WithoutGil([&] { return Store::IsYetToBeMade(file.path, file.wait); }); })
      .def("log",
           [](const StoreFile& file, const std::string& name) {
             const auto entries = WithoutGil([&] { return file.Reader().Log(name); });
             return Report(ToJson(entries, Location(file.path, name).ToString()));
           })
      .def("stats", [](const StoreFile& file) {
        return Report(WithoutGil([&] { return ToJson(file.Reader().Stats(), file.path); }));
      });
}

void DefineRevisions(py::class_<StoreFile>& store) {
  store
      .def("restore",
           [](const StoreFile& file, const std::string& name, int threads, const py::object& listener) {
             const Progress progress = ProgressTo(listener);
             const SaveOptions options{.threads = threads, .progress = progress};
             return WithoutGil([&] { return file.WriterOfPresent(progress).Restore(name, options).revision; });
           })
      .def("branch",
           [](const StoreFile& file, const std::string& name, const std::string& branch, int threads,
              const py::object& listener) {
             const Progress progress = ProgressTo(listener);
             const SaveOptions options{.threads = threads, .progress = progress};
             WithoutGil([&] { file.WriterOfPresent(progress).Branch(name, branch, options); });
           })
      .def("tag",
           [](const StoreFile& file, const std::string& name, const std::string& tag, bool remove) {
             WithoutGil([&] {
               Store writer = file.WriterOfPresent({});
               remove ? writer.Untag(name, tag) : writer.Tag(name, tag);
             });
           })
      .def("gc", [](const StoreFile& file, const std::string& name, std::optional<std::uint64_t> keep,
                    std::optional<double> keep_days, bool dry_run) {
        const GiveUpOptions options{.keep = keep, .keep_days = keep_days, .dry_run = dry_run};
        const GiveUpReport report = WithoutGil([&] { return file.WriterOfPresent({}).GiveUp(options, name); });
        return Report(ToJson(report, Location(file.path, name).ToString()));
      });
}

void DefineKeeping(py::class_<StoreFile>& store) {
  store.def("save", &SaveTo)
      .def("add", &AddTo)
      .def("migrate", &MigrateFile)
      .def("remove",
           [](const StoreFile& file, const std::string& name, const py::object& listener) {
             const Progress progress = ProgressTo(listener);
             WithoutGil([&] { file.WriterOfPresent(progress).Remove(name); });
           })
      .def("vacuum",
           [](const StoreFile& file, const py::object& listener) {
             const Progress progress = ProgressTo(listener);
             detail::RefuseOnServer(file.path, "the server gives space back by itself, or by VACUUM in SQL");
             WithoutGil([&] { file.WriterOfPresent(progress).Vacuum(); });
           })
      .def("backup", [](const StoreFile& file, const std::string& target, bool overwrite) {
        detail::RefuseOnServer(file.path, "pg_dump makes a copy, and add() one of its atlases in a file");
        detail::RequireFile(target);
        WithoutGil([&] { file.Reader().Backup(target, overwrite); });
      });
}

}  // namespace

void DefineStore(py::module_& module) {
  module.def("without_password", [](const std::string& path) { return TextOf(detail::WithoutPassword(path)); });
  py::class_<StoreFile> store(module, "StoreFile");
  store.def(py::init([](const std::string& path, double wait, bool sync) {
    if (const std::string name = Location(path).name; !name.empty())
      throw Error(ErrorKind::kUsage, path, "", "a store is named without an atlas; load(\"" + name + "\") takes it");
    return StoreFile{path, wait, sync};
  }));
  DefineLooking(store);
  DefineKeeping(store);
  DefineRevisions(store);
}

}  // namespace slamdb::python
