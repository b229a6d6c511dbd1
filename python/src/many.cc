// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/choices.h"
#include "python/src/arrays.h"
#include "python/src/errors.h"
#include "python/src/held_atlas.h"
#include "python/src/inputs.h"
#include "python/src/module.h"
#include "python/src/selections.h"
#include "python/src/unlocked.h"
#include "python/src/verb.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/many/list.h"
#include "slamdb/many/report.h"
#include "slamdb/many/sync.h"

// Many atlases, and what is told of them. slamdb/many.py and slamdb/outputs.py document what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

void DefineFind(py::module_& module) {
  module.def("find_atlases", [](const py::dict& values) {
    Arguments given(values);
    const ManyInputs inputs = InputsOf(given);
    given.RequireAllTaken();
    const AtlasInputs found = WithoutGil([&] { return inputs.Find(); });
    py::list atlases;
    for (const AtlasInput& atlas : found.atlases)
      atlases.append(py::make_tuple(TextOf(atlas.location.ToString()), TextOf(atlas.below), TextOf(atlas.failure)));
    return atlases;
  });
}

// time, near, keyframes.
MapQuery QueryOf(Arguments& given) {
  MapQuery query;
  if (given.Has("time")) {
    query.times = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    TakeRange(given, "time", query.times->begin, query.times->end);
  }
  if (given.Has("keyframes")) {
    query.keyframes = {0, std::numeric_limits<std::uint64_t>::max()};
    TakeRange(given, "keyframes", query.keyframes->first, query.keyframes->last);
  }
  if (given.Has("near")) {
    RequireNumpy();
    const auto [center, radius] = given.Get<std::pair<Eigen::Vector3d, double>>("near");
    query.near = {center, radius};
  }
  return query;
}

AtlasQuery StoredQueryOf(Arguments& given) {
  AtlasQuery query;
  using End = std::optional<double>;
  for (const auto& [word, ends] : given.Get<std::map<std::string, std::pair<End, End>>>("where")) {
    const SortKey key = SortKeyOf(word);
    const auto number = NumberOf(key.key);
    if (key.descending || !number)
      throw Error(ErrorKind::kUsage, "'" + word + "' is no number that a store tells of its atlases");
    AtlasQuery::Range range{.number = *number};
    if (ends.first) range.low = *ends.first;
    if (ends.second) range.high = *ends.second;
    query.ranges.push_back(range);
  }
  given.Take("who", query.who);
  given.Take("provenance", query.provenance);
  given.Take("tag", query.tag);
  return query;
}

void DefineList(py::module_& module) {
  DefineReport(module, "list_atlases", [](Arguments& given) {
    ListOptions options{.query = QueryOf(given), .stored = StoredQueryOf(given)};
    if (given.Get<bool>("check")) options.check.emplace();
    given.Take("format", options.format);
    options.layout = LayoutNamed(given.Path("layout"));
    given.Take("wait", options.lock_timeout, cli::kNonNegative);
    given.TakeRun(options);
    std::vector<SortKey> keys;
    for (const auto& word : given.Get<std::vector<std::string>>("sort")) keys.push_back(SortKeyOf(word));
    return [options, keys, inputs = InputsOf(given)](Notices&) {
      std::vector<ListedAtlas> atlases = ListAtlases(inputs.Find(), options);
      SortAtlases(atlases, keys);
      const std::vector<std::string> named = inputs.Named();
      return ToJson(atlases, named.size() == 1 ? named.front() : std::string());
    };
  });
}

void DefineSync(py::module_& module) {
  DefineReport(module, "sync", [](Arguments& given) {
    SyncOptions options{.names = given.Get<std::vector<std::string>>("name")};
    given.Take("one_way", options.one_way);
    given.TakeWord("diverged", cli::kDivergedWays, options.branch_diverged);
    given.Take("dry_run", options.dry_run);
    given.Take("retry", options.retries, cli::kRetries);
    given.Take("sync", options.sync);
    given.Take("wait", options.lock_timeout, cli::kNonNegative);
    given.TakeRun(options);
    return [options, first = given.Path("first"), second = given.Path("second")](Notices&) {
      return ToJson(SyncStores(first, second, options));
    };
  });
}

// Pages about atlases: the page or the index, its report, and the thumbnail of one.
void DefinePages(py::module_& module) {
  module.def("report", [](const py::dict& values) {
    Arguments given(values);
    const ManyInputs inputs = InputsOf(given);
    ReportOptions options{.read = ReadingOf(given), .check = CheckOptionsOf(given), .wording = cli::InCommandWords};
    const OutputFile output = given.Output("output");
    options.output = output.path;
    options.overwrite = output.options.overwrite;
    given.RequireAllTaken();
    Notices notices;
    const Reports reports = WithoutGil([&] { return WriteReports(inputs.Named(), inputs.Find(), options); });
    TellOutcomes(reports.outcomes, notices);
    const bool one = reports.outcomes.size() == 1;
    return py::make_tuple(TextOf(reports.page), Report(ToJson(reports, options.output)),
                          py::bytes(one ? reports.outcomes.front().result.thumbnail : std::string()), ListOf(notices));
  });
}

}  // namespace

void DefineMany(py::module_& module) {
  DefineFind(module);
  DefineList(module);
  DefineSync(module);
  DefinePages(module);
  module.def("summarize", [](const HeldAtlas& atlas) {
    const auto value = atlas.value();
    const Unlocked unlocked;
    return ToJson(Summarize(*value));
  });
  module.def("write_file", [](const py::object& path, const py::bytes& data, bool overwrite, bool sync) {
    const OutputFile file{.path = TextOfPath(path), .options = {.overwrite = overwrite, .sync = sync}};
    const std::string_view held(data);  // by the caller's argument
    const Unlocked unlocked;
    RefuseAtlas(file.path);
    file.Write(held);
  });
}

}  // namespace slamdb::python
