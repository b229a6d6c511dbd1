// SPDX-License-Identifier: BSD-3-Clause
#include "cli/choices.h"
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/align/merge_aligned.h"
#include "slamdb/align/merge_branches.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/merge/anchors.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/merge/warnings.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/many/branches.h"
#include "slamdb/many/inputs.h"
#include "slamdb/many/locate_pictures.h"
#include "slamdb/many/maps_to_align.h"
#include "slamdb/many/whole_store.h"
#include "slamdb/plot/alignment.h"

// Verbs that bring maps, or pictures and maps, together. slamdb/aligning.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using Sources = std::vector<AtlasOrPath>;

double WaitOf(ReadOptions read) { return read.of<StoreReadOptions>().lock_timeout; }

MapsToAlign MapsOf(const Sources& sources, const ReadOptions& read, Notices& notices) {
  MapsToAlign maps;
  std::optional<Store> store;
  std::vector<std::string> inputs;
  for (const AtlasOrPath& source : sources) {
    inputs.push_back(source.path);
    std::optional<Store> whole = source.atlas ? std::nullopt : OpenWholeStore(source.path, WaitOf(read));
    if (whole && store)
      throw Error(ErrorKind::kUsage,
                  "one store is searched; of " + source.path + " name the atlases, as " + source.path + "#NAME");
    if (whole) {
      store = std::move(whole);
      continue;
    }
    maps.Add(Hold(source, read, notices), source.path);
  }
  if (store) maps.AddLikely(*store, inputs, read, notices);
  return maps;
}

// What is written beside the report.
struct AlignmentFiles {
  OutputFile save, plot;

  void Write(const MapsToAlign& maps, const AlignedMaps& aligned, Notices& notices) const {
    if (!save.any() && !plot.any()) return;
    if (maps.maps.size() != 2)
      throw Error(ErrorKind::kUsage,
                  "save= and plot= are for two maps, and there are " + std::to_string(maps.maps.size()));
    const Alignment& alignment = aligned.links.front().alignment;
    WriteOr(
        save, maps.AreSure(aligned), [&] { return ToText(*alignment.first_from_second) + "\n"; }, notices);
    WriteOr(
        plot, alignment.first_from_second.has_value(), [&] { return Draw(maps, aligned.links.front()); }, notices);
  }

 private:
  template <class Make>
  static void WriteOr(const OutputFile& file, bool sure, const Make& make, Notices& notices) {
    if (!file.any()) return;
    if (sure)
      file.Write(make());
    else
      notices.Warn("the maps are not aligned for sure: " + file.path + " is not written");
  }

  std::string Draw(const MapsToAlign& maps, const MapLink& link) const {
    const PlotOptions options{.format = PlotFormatOf(plot.path),
                              .title = NameText(maps.names[link.second]) + " in " + NameText(maps.names[link.first])};
    return DrawAlignment(maps.maps[link.first], maps.maps[link.second], link.alignment, options).bytes;
  }
};

void DefineAlign(py::module_& module) {
  DefineReport(module, "align", [](Arguments& given) {
    AlignOptions options;
    given.Take("own_vocabulary", options.own_vocabulary);
    given.TakeRun(options);
    const AlignmentFiles files{.save = given.Output("save"), .plot = given.Output("plot")};
    if (files.plot.any()) (void)PlotFormatOf(files.plot.path);
    return [=, read = ReadingOf(given), sources = given.Sources("sources")](Notices& notices) {
      const MapsToAlign maps = MapsOf(sources, read, notices);
      const AlignedMaps aligned = maps.Align(options);
      files.Write(maps, aligned, notices);
      return maps.ToJson(aligned);
    };
  });
}

// How two maps become one.
struct Joining {
  bool join = false, align = false;
  std::optional<bool> fuse;        // nothing: as is usual
  std::string transform, anchors;  // texts, or files of them
  JoinOptions options;
  FuseOptions fusion;
  Tightening tightening = Tightening::kUsual;

  std::optional<JoinOptions> Of(const std::vector<Atlas>& atlases, Notices& notices) const {
    if (!join) return std::nullopt;
    JoinOptions made = options;
    if (!transform.empty()) made.first_from_second = ReadSimilarity(transform);
    if (!anchors.empty()) {
      Anchors read = ReadAnchors(anchors, &notices);
      made.anchors = std::move(read.keyframes);
      made.places = std::move(read.places);
    }
    if (fuse.value_or(HoldLandmarksAlone(atlases))) made.fuse = fusion;
    return made;
  }
};

Joining JoiningOf(Arguments& given) {
  Joining joining{.join = given.Get<bool>("join"),
                  .align = given.Get<bool>("align"),
                  .transform = given.Path("transform"),
                  .anchors = given.Path("anchors")};
  if (joining.join && joining.align) throw Error(ErrorKind::kUsage, "join= and align= exclude each other");
  if (!joining.join)
    given.RefuseIdle({"transform", "anchors", "maps", "scale", "outliers"}, "goes with join=True only");
  if (!joining.align) given.RefuseIdle({"optimize"}, "goes with align=True only");
  if (!joining.join && !joining.align && !given.Has("base"))
    given.RefuseIdle({"fuse", "fuse_radius", "fuse_hamming"}, "goes with join=True, align=True or base= only");
  if (given.Has("maps")) {
    const auto [first, second] = given.Get<std::pair<std::uint64_t, std::uint64_t>>("maps");
    joining.options.first = MapId(first);
    joining.options.second = MapId(second);
  }
  given.Take("fuse", joining.fuse);
  given.Take("scale", joining.options.with_scale);
  given.Take("outliers", joining.options.outlier_distance, cli::kPositive);
  given.Take("fuse_radius", joining.fusion.radius, cli::kPositive);
  given.Take("fuse_hamming", joining.fusion.hamming, cli::kBitsOfDescriptor);
  given.TakeWord("optimize", cli::kTightenings, joining.tightening);
  return joining;
}

std::vector<std::string> NamesOf(const Sources& sources) {
  std::vector<std::string> names;
  for (const AtlasOrPath& source : sources) names.push_back(source.atlas ? "atlas" : source.path);
  return names;
}

std::vector<Atlas> CopiesOf(const Sources& sources, const std::string& vocabulary, const MergeOptions& options,
                            Notices& notices) {
  const ReadOptions read{.threads = options.threads, .progress = options.progress};
  std::vector<Atlas> atlases;
  for (const AtlasOrPath& source : sources) {
    atlases.push_back(source.atlas ? *source.atlas : ReadAtlas(Location(source.path), read, &notices));
    HoldWords(vocabulary, options.threads, atlases.back(), notices);
  }
  return atlases;
}

// Throws Error (kNotPossible), with what was found, where no map lies in another for sure.
MergeAlignedResult MergeOverlapping(std::vector<Atlas> atlases, const MergeOptions& merge, const Joining& joining,
                                    Notices& notices) {
  MergeAlignedOptions options{.merge = merge, .fuse = joining.fusion, .tightening = joining.tightening};
  if (!joining.fuse.value_or(true)) options.fuse.reset();
  MergeAlignedResult result = MergeAligned(std::move(atlases), options, notices);
  if (!result.any())
    throw Error(ErrorKind::kNotPossible,
                "no map could be aligned with another: " + result.joined.aligned.links.front().alignment.reason);
  return result;
}

// How two continuations of one atlas become one.
ThreeWayOptions BranchingOf(Arguments& given, const Joining& joining) {
  ThreeWayOptions options{.fuse = joining.fusion};
  if (!given.Has("base")) {
    given.RefuseIdle({"geometry", "prefer"}, "goes with base= only");
    return options;
  }
  given.RefuseIdle({"join", "align", "on_conflict"}, "does not go with base=");
  if (!joining.fuse.value_or(true)) options.fuse.reset();
  given.TakeWord("geometry", cli::kBranchGeometries, options.geometry);
  given.TakeWord("prefer", cli::kBranchSides, options.prefer);
  return options;
}

// The base comes first among the sources.
std::string MergeContinuations(std::vector<Atlas> atlases, const MergeOptions& merge, ThreeWayOptions options,
                               const OutputFile& ids, Atlas& atlas, Notices& notices) {
  if (atlases.size() != 3) throw Error(ErrorKind::kUsage, "base= is of two sources, ours and theirs, made of it");
  std::ranges::copy(merge.names, options.names.begin());
  options.ignore_vocabulary = merge.ignore_vocabulary || merge.force;
  options.id_maps = merge.id_maps;
  options.threads = merge.threads;
  options.progress = merge.progress;
  MergeBranchesResult result =
      MergeBranches(std::move(atlases[0]), std::move(atlases[1]), std::move(atlases[2]), options);
  TellWarnings(result.merged.report, notices);
  if (ids.any()) WriteIdMaps(result.merged.report.id_maps, ids.path, ids.options);
  atlas = std::move(result.merged.atlas);
  return ToJson(result);
}

void WriteIdsOf(const MergeReport& report, const OutputFile& file) {
  if (file.any()) WriteIdMaps(report.id_maps, file.path, file.options);
}

// Two branches of a store that knows what they come from are more than two atlases.
void TellCommonBase(const Sources& sources, Notices& notices) {
  if (sources.size() != 2) return;
  const std::optional<StoredBranches> branches = FindBranches(Location(sources[0].path), Location(sources[1].path));
  if (branches && branches->base)
    notices.Warn(branches->ours.atlas + " and " + branches->theirs.atlas + " both come from " +
                 branches->base->ToString() + ", and are side by side now: base='" +
                 detail::WithoutPassword(branches->LocationOf(*branches->base)) + "' merges them three ways");
}

void DefineMerge(py::module_& module) {
  DefineMaker(module, "merge", [](Arguments& given) {
    const Joining joining = JoiningOf(given);
    const OutputFile ids = given.Output("id_map");
    const ThreeWayOptions branching = BranchingOf(given, joining);
    const bool has_base = given.Has("base");
    Sources sources = given.Sources("sources");
    if (has_base) sources.insert(sources.begin(), given.SourceAt("base"));
    MergeOptions options{.names = DistinctNames(NamesOf(sources)),
                         .same_map = joining.align ? SameMap::kKeepFirst : SameMap::kKeepBoth,
                         .id_maps = ids.any()};
    given.TakeWord("on_conflict", cli::kConflicts, options.same_map);
    given.Take("ignore_vocabulary", options.ignore_vocabulary);
    given.Take("force", options.force);
    given.TakeRun(options);
    return [=, vocabulary = given.Path("vocabulary")](Atlas& atlas, Notices& notices) {
      MergeOptions merge = options;
      std::vector<Atlas> atlases = CopiesOf(sources, vocabulary, options, notices);
      if (has_base) return MergeContinuations(std::move(atlases), merge, branching, ids, atlas, notices);
      merge.join = joining.Of(atlases, notices);
      if (joining.align) {
        MergeAlignedResult result = MergeOverlapping(std::move(atlases), merge, joining, notices);
        WriteIdsOf(result.merged.report, ids);
        atlas = std::move(result.merged.atlas);
        return ToJson(result);
      }
      if (!joining.join) TellCommonBase(sources, notices);
      MergeResult result = MergeAtlases(std::move(atlases), merge);
      TellWarnings(result.report, notices);
      WriteIdsOf(result.report, ids);
      atlas = std::move(result.atlas);
      return ToJson(result.report);
    };
  });
}

// Pictures, or keyframes that are left out.
struct Locating {
  AtlasOrPath source;
  ReadOptions read;
  LocatePicturesOptions pictures;
  LocateBenchmarkOptions left_out;
  std::string camera, vocabulary;
  OutputFile output;
  bool benchmark = false;

  LocateReport InAtlas(Atlas atlas, Notices& notices) const {
    const auto loaded = VocabularyAt(vocabulary, pictures.threads);
    if (loaded) HoldWords(vocabulary, pictures.threads, atlas, notices);
    const Locator locator(
        atlas,
        {.vocabulary = loaded ? &loaded->tree : nullptr, .threads = pictures.threads, .progress = pictures.progress});
    if (benchmark) return BenchmarkLocating(locator, atlas, left_out);
    const LocateReport report = LocatePictures(atlas, locator, Pictures(), notices);
    if (output.any()) output.Write(PosesFound(report, atlas));
    return report;
  }

  LocateReport Do(Notices& notices) const {
    if (benchmark == !pictures.pictures.empty())
      throw Error(ErrorKind::kUsage, "name pictures, or ask for benchmark=True");
    if (source.atlas) return InAtlas(*source.atlas, notices);
    std::optional<Store> store = OpenWholeStore(source.path, pictures.lock_timeout);
    if (!store) return InAtlas(ReadAtlas(Location(source.path), read, &notices), notices);
    if (benchmark || !(pictures.against.empty() && !output.any() && vocabulary.empty()))
      throw Error(ErrorKind::kUsage, "benchmark=, against=, output= and vocabulary= are for one atlas: name it, as " +
                                         store->path() + "#NAME");
    return LocatePictures(*store, Pictures(), notices);
  }

 private:
  LocatePicturesOptions Pictures() const {
    LocatePicturesOptions options = pictures;
    if (!camera.empty()) options.camera = ReadCameraSettings(camera);
    return options;
  }
};

void DefineLocate(py::module_& module) {
  DefineReport(module, "locate", [](Arguments& given) {
    Locating locating{.source = given.SourceAt("source"), .read = ReadingOf(given)};
    LocatePicturesOptions& pictures = locating.pictures;
    pictures.pictures = given.Paths("pictures");
    given.Take("features", pictures.features, cli::kLocateFeatures);
    pictures.against = given.Path("against");
    given.Take("wait", pictures.lock_timeout, cli::kNonNegative);
    given.TakeRun(pictures);
    given.Take("benchmark", locating.benchmark);
    given.Take("most", locating.left_out.most_keyframes, cli::kPositive);
    given.TakeRun(locating.left_out);
    if (locating.benchmark)
      given.RefuseIdle({"camera", "against", "output"}, "is for pictures, of which benchmark=True takes none");
    locating.camera = given.Path("camera");
    locating.vocabulary = given.Path("vocabulary");
    locating.output = given.Output("output");
    return [locating](Notices& notices) { return ToJson(locating.Do(notices), locating.source.path); };
  });
}

}  // namespace

void DefineAligning(py::module_& module) {
  DefineAlign(module);
  DefineMerge(module);
  DefineLocate(module);
}

}  // namespace slamdb::python
