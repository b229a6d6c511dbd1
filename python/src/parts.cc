// SPDX-License-Identifier: BSD-3-Clause
#include "cli/choices.h"
#include "python/src/arrays.h"
#include "python/src/module.h"
#include "python/src/selections.h"
#include "python/src/unlocked.h"
#include "python/src/verb.h"
#include "slamdb/align/shrink_for_locating.h"
#include "slamdb/edit/part/cull.h"
#include "slamdb/edit/part/extract.h"
#include "slamdb/edit/part/fragments.h"
#include "slamdb/edit/part/shrink.h"
#include "slamdb/edit/part/split.h"
#include "slamdb/edit/part/warnings.h"
#include "slamdb/model/index.h"

// Verbs that keep a part of an atlas. slamdb/parts.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

constexpr double kMegabyte = 1e6;  // bytes

SelectOptions SelectionOf(Arguments& given) {
  SelectOptions select;
  TakePart(given, select);
  if (given.Has("polygon")) RequireNumpy();
  given.TakeIds("keyframe", select.keyframes);
  given.Take("polygon", select.polygon);
  given.TakeWord("plane", cli::kPlanes, select.plane);
  given.TakeWord("region", cli::kRegions, select.region);
  given.Take("session", select.session);
  given.Take("component", select.component, cli::kPositive);
  given.Take("every", select.every, cli::kPositive);
  given.Take("except_", select.except);
  return select;
}

void DefineExtract(py::module_& module) {
  DefineChange(module, "extract", [](Arguments& given) {
    ExtractOptions options{.part = SelectionOf(given)};
    given.TakeWord("border", cli::kBorders, options.border);
    given.TakeRun(options);
    return [options](Atlas& atlas, Notices&) { return ToJson(Extract(atlas, options)); };
  });
}

// 0: ORB-SLAM3's number for the sensor.
template <class Number>
void TakeOfSensor(Arguments& given, const char* name, std::optional<OrOfSensor<Number>>& into) {
  std::optional<Number> asked;
  given.Take(name, asked);
  if (!asked) return;
  into = *asked == Number{0} ? OrOfSensor<Number>(OfSensor()) : OrOfSensor<Number>(*asked);
}

void DefineCull(py::module_& module) {
  DefineChange(module, "cull", [](Arguments& given) {
    CullOptions rules;
    TakeOfSensor(given, "redundant", rules.redundancy);
    given.Take("observers", rules.redundant_observers);
    TakeOfSensor(given, "min_observations", rules.min_observations);
    given.Take("max_error", rules.max_error);
    given.Take("min_parallax", rules.min_parallax);
    given.Take("unseen_since", rules.unseen_since);
    given.TakeRun(rules);
    rules.UseOrbslam3UnlessAsked();
    return [rules](Atlas& atlas, Notices& notices) {
      const CullReport report = Cull(atlas, rules);
      WarnOfPoorCoverage(report.coverage, notices);
      return ToJson(report);
    };
  });
}

void DefineShrink(py::module_& module) {
  DefineChange(module, "shrink", [](Arguments& given) {
    ShrinkOptions options;
    std::optional<double> megabytes;
    given.Take("target_mb", megabytes, cli::kPositive);
    if (megabytes) options.target_bytes = static_cast<std::uint64_t>(*megabytes * kMegabyte);
    given.Take("target_keyframes", options.target_keyframes, cli::kPositive);
    bool ShrinkOptions::*purpose = nullptr;
    given.TakeWord("for_", cli::kPurposes, purpose);
    if (purpose != nullptr) options.*purpose = true;
    given.Take("largest_map", options.largest_map);
    given.Take("min_points", options.min_points, cli::kPositive);
    given.TakeRun(options);
    return [options, vocabulary = given.Path("vocabulary")](Atlas& atlas, Notices& notices) {
      HoldWords(vocabulary, options.threads, atlas, notices);
      const ShrinkReport report = ShrinkForLocating(atlas, options);
      WarnOfPoorCoverage(report.coverage, notices);
      return ToJson(report);
    };
  });
}

void DefineFragments(py::module_& module) {
  DefineChange(module, "fragments", [](Arguments& given) {
    FragmentOptions options;
    given.Take("min_keyframes", options.min_keyframes, cli::kPositive);
    given.Take("largest", options.largest, cli::kPositive);
    given.TakeWord("order", cli::kMapOrders, options.order);
    given.TakeRun(options);
    return [options](Atlas& atlas, Notices&) { return ToJson(DropFragments(atlas, options)); };
  });
}

struct Parts {
  std::vector<std::pair<std::string, Atlas>> atlases;  // by the part's name
  std::string report;
};

Parts TakeParts(const Atlas& atlas, const SplitOptions& options, Border border, const std::string& input, int threads,
                const Progress& progress) {
  Parts taken;
  std::vector<TakenPart> counts;
  const AtlasIndex index(atlas);
  const std::vector<slamdb::Part> parts = SplitAtlas(index, options);
  for (const slamdb::Part& part : parts) {
    progress("splitting", static_cast<double>(counts.size()) / static_cast<double>(parts.size()));
    SubsetReport removed;
    taken.atlases.emplace_back(part.name, TakePart(index, part, border, removed, threads));
    counts.push_back({.name = part.name, .output = {}, .counts = removed.after});
  }
  taken.report = ToJson(counts, {.input = input});
  return taken;
}

void DefineSplit(py::module_& module) {
  module.def("split", [](const py::dict& values) {
    Arguments given(values);
    SplitOptions options;
    given.TakeWord("by", cli::kSplitWays, options.by);
    given.Take("min_keyframes", options.min_keyframes, cli::kPositive);
    Border border = Border::kSmart;
    given.TakeWord("border", cli::kBorders, border);
    const AtlasOrPath source = given.SourceAt("source");
    const ReadOptions read = ReadingOf(given);
    given.RequireAllTaken();
    Notices notices;
    Parts parts = WithoutGil([&] {
      const auto atlas = Hold(source, read, notices);
      return TakeParts(*atlas, options, border, source.path, read.threads, read.progress);
    });
    py::dict atlases;
    for (auto& [part, taken] : parts.atlases) atlases[py::str(part)] = std::make_shared<HeldAtlas>(std::move(taken));
    return py::make_tuple(atlases, Report(parts.report), ListOf(notices));
  });
}

}  // namespace

void DefineParts(py::module_& module) {
  DefineExtract(module);
  DefineCull(module);
  DefineShrink(module);
  DefineFragments(module);
  DefineSplit(module);
}

}  // namespace slamdb::python
