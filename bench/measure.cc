// SPDX-License-Identifier: BSD-3-Clause
#include "bench/measure.h"

#include <algorithm>
#include <filesystem>

#include "bench/process.h"
#include "bench/references.h"
#include "bench/timing.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/part/cull.h"
#include "slamdb/edit/part/select.h"
#include "slamdb/edit/part/shrink.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/statistics.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/boost_reference/boost_reference.h"

namespace slamdb::bench {
namespace {

Atlas Read(const std::string& path) {
  Notices notices;
  return ReadOrbslam3(path, {}, notices);
}

void Write(Atlas& atlas, const std::string& path, bool text, bool sanitize = false) {
  Notices notices;
  WriteOptions options;
  options.overwrite = true;
  options.sync = false;
  options.of<Orbslam3WriteOptions>() = {.boost_version = std::min(reference::ArchiveVersion(), 12U),
                                        .sanitize = sanitize};
  atlas.encoding.text = text;
  WriteOrbslam3(atlas, path, options, notices);
}

// ---- reading

Sample ReadBinary(const Workplace& at) {
  return Time([&] { Keep(Read(at.binary())); });
}
// v1.0 as its layout file describes it: the way of the files of forks.
Sample ReadByLayout(const Workplace& at) {
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = ToJson(*FindKnownLayout("v1.0"));
  return Time([&] {
    Notices notices;
    Keep(ReadOrbslam3(at.binary(), options, notices));
  });
}
Sample ReadText(const Workplace& at) {
  return Time([&] { Keep(Read(at.text())); });
}
Sample ReadMemory(const Workplace& at) {
  return WatchMemory([&] { Keep(Read(at.binary())); });
}
// ---- writing

Sample WriteAs(const Workplace& at, bool text) {
  Atlas atlas = Read(at.binary());
  std::filesystem::remove(at.output());
  return Time([&] { Write(atlas, at.output(), text); });
}
Sample WriteBinary(const Workplace& at) { return WriteAs(at, false); }
Sample WriteText(const Workplace& at) { return WriteAs(at, true); }
// ---- info and check

// What the command does, but for printing: statistics of everything, and the size on disk by part.
Sample Info(const Workplace& at) {
  return Time([&] {
    Notices notices;
    std::vector<PartSize> parts;
    ReadOptions options;
    options.part_sizes = &parts;
    options.features = FeatureColumns::kGeometry;
    Atlas atlas = ReadOrbslam3(at.binary(), options, notices);
    Keep(ComputeStatistics(atlas));
    Keep(std::move(atlas));
  });
}

Sample Check(const Workplace& at) {
  const Atlas atlas = Read(at.binary());
  return Time([&] { Keep(CheckAtlas(atlas, {})); });
}

// ---- keeping a part

Sample Extract(const Workplace& at) {
  Atlas atlas = Read(at.binary());
  return Time([&] {
    const AtlasIndex index(atlas);
    Subset subset = Select(index, {.every = 2});
    SettleBorder(index, Border::kSmart, subset);
    KeepSubset(atlas, subset);
  });
}

Sample CullAll(const Workplace& at) {
  Atlas atlas = Read(at.binary());
  return Time([&] { Cull(atlas, CullOptions::Orbslam3()); });
}

Sample ShrinkToHalf(const Workplace& at) {
  Atlas atlas = Read(at.binary());
  return Time([&] { Shrink(atlas, {.target_bytes = std::filesystem::file_size(at.binary()) / 2}); });
}

// ---- changes to maps, and what changed

Sample Transform(const Workplace& at) {
  Atlas atlas = Read(at.binary());
  const Similarity3d move{1.1, Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {1, 2, 3}};
  return Time([&] {
    for (Map& map : atlas.maps) TransformMap(map, move);
  });
}

// Everything is in both atlases, and so everything is compared.
Sample Diff(const Workplace& at) {
  const Atlas before = Read(at.binary()), after = before;
  return Time([&] { Keep(DiffAtlases(before, after, {})); });
}

// ---- the store. Not synced, as the reference's writes are not.

constexpr const char* kName = "atlas";

Sample StoreSave(const Workplace& at) {
  const Atlas atlas = Read(at.binary());
  std::filesystem::remove(at.output());
  return Time([&] { Store::OpenForWriting(at.output(), {.sync = false}).Save(kName, atlas); });
}

Sample StoreLoad(const Workplace& at) {
  return Time([&] { Keep(Store::Open(at.store()).Load(kName)); });
}

// The atlas after one keyframe in a hundred has moved and lost its first keypoint's match.
Atlas Changed(const Workplace& at) {
  Atlas atlas = Read(at.binary());
  for (Map& map : atlas.maps) {
    for (std::size_t i = 0; i < map.keyframes.size(); i += 100) {
      KeyFrame& keyframe = map.keyframes[i];
      keyframe.camera_from_world.translation.x() += 0.01F;
      if (!keyframe.features.map_points.empty()) keyframe.features.map_points.front() = MapPointId();
    }
  }
  return atlas;
}

Sample SaveOnto(const Workplace& at, const Atlas& atlas) {
  std::filesystem::copy_file(at.store(), at.output(), std::filesystem::copy_options::overwrite_existing);
  return Time([&] { Store::OpenForWriting(at.output(), {.sync = false}).Save(kName, atlas); });
}
Sample StoreSaveAgain(const Workplace& at) { return SaveOnto(at, Changed(at)); }
Sample StoreSaveUnchanged(const Workplace& at) { return SaveOnto(at, Read(at.binary())); }

// The revision before the newest, which changed that much.
Sample StoreLoadEarlier(const Workplace& at) {
  StoreSaveAgain(at);
  return Time([&] { Keep(Store::Open(at.output()).Load(std::string(kName) + "@1")); });
}

// ---- edit

Atlas Merged(const Workplace& at) {
  std::vector<Atlas> inputs;
  inputs.push_back(Read(at.binary()));
  inputs.push_back(Read(at.other()));
  return MergeAtlases(std::move(inputs), {}).atlas;
}

Sample Merge(const Workplace& at) {
  std::filesystem::remove(at.output());
  return Time([&] {
    Atlas merged = Merged(at);
    Write(merged, at.output(), false);
    Keep(std::move(merged));
  });
}

// What a merge cannot do without: reading its inputs and writing its result.
Sample MergeInputAndOutput(const Workplace& at) {
  Atlas merged = Merged(at);
  std::filesystem::remove(at.output());
  return Time([&] {
    Keep(Read(at.binary()));
    Keep(Read(at.other()));
    Write(merged, at.output(), false);
  });
}

// ---- exports, on one core

void Export(const Atlas& atlas, const Workplace& at, const std::string& format) {
  std::filesystem::remove_all(at.output());
  WriteAtlas(atlas, at.output(), {.format = format, .sync = false, .threads = 1});
}
Sample ExportAs(const Workplace& at, const std::string& format) {
  const Atlas atlas = Read(at.binary());
  const Sample sample = Time([&] { Export(atlas, at, format); });
  std::filesystem::remove_all(at.output());
  return sample;
}
Sample ExportStella(const Workplace& at) { return ExportAs(at, "stella"); }
Sample ExportStellaDatabase(const Workplace& at) { return ExportAs(at, "stella-sqlite"); }
Sample ExportColmap(const Workplace& at) { return ExportAs(at, "colmap"); }

// ---- whole processes

Sample Run(const Workplace& at, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), at.slamdb);
  return Time([&] { RunProgram(arguments, Cores::kAll, Output::kDiscard); });  // on the cores that this one has
}
Sample RunVersion(const Workplace& at) { return Run(at, {"version"}); }
Sample RunHelp(const Workplace& at) { return Run(at, {"check", "-h"}); }
Sample RunInfo(const Workplace& at) { return Run(at, {"info", at.binary()}); }
Sample RunCheck(const Workplace& at) { return Run(at, {"check", "--quiet", at.binary()}); }
Sample RunConvert(const Workplace& at) {
  std::filesystem::remove(at.output());
  return Run(at, {"convert", "--quiet", "--no-sync", "--to", "orbslam3", at.binary(), at.output()});
}

constexpr Measurement kMeasurements[] = {
    {"read-binary", ReadBinary, FromFile::kYes},
    {"read-layout", ReadByLayout, FromFile::kYes},
    {"read-text", ReadText, FromFile::kYes},
    {"read-memory", ReadMemory},
    {"write-binary", WriteBinary},
    {"write-text", WriteText},
    {"info", Info, FromFile::kYes},
    {"check", Check},
    {"extract", Extract},
    {"cull", CullAll},
    {"shrink", ShrinkToHalf},
    {"transform", Transform},
    {"diff", Diff},
    {"store-save", StoreSave},
    {"store-load", StoreLoad, FromFile::kYes},
    {"store-save-again", StoreSaveAgain},
    {"store-save-unchanged", StoreSaveUnchanged},
    {"store-load-earlier", StoreLoadEarlier, FromFile::kYes},
    {"merge", Merge, FromFile::kYes},
    {"merge-input-output", MergeInputAndOutput, FromFile::kYes},
    {"export-stella", ExportStella},
    {"export-stella-sqlite", ExportStellaDatabase},
    {"export-colmap", ExportColmap},
    {"run-version", RunVersion},
    {"run-help", RunHelp},
    {"run-info", RunInfo, FromFile::kYes},
    {"run-check", RunCheck, FromFile::kYes},
    {"run-convert", RunConvert, FromFile::kYes},
};

SyntheticOptions RoomOf(std::size_t keyframes, std::size_t points) {
  SyntheticOptions options;
  options.sensor = Sensor::kRgbd;
  options.keyframes = keyframes;
  options.points = points;
  options.features = 1000;
  return options;
}

}  // namespace

std::span<const Measurement> Measurements() { return kMeasurements; }

const Measurement& MeasurementById(std::string_view id) {
  for (const Measurement& measurement : kMeasurements)
    if (measurement.id == id) return measurement;
  for (const Measurement& reference : References())
    if (reference.id == id) return reference;
  throw Error(ErrorKind::kUsage, "unknown measurement '" + std::string(id) + "'");
}

void Prepare(const std::string& atlas_path, const Workplace& at) {
  Atlas atlas = Read(atlas_path);
  Write(atlas, at.binary(), false, true);
  Write(atlas, at.text(), true, true);
  std::filesystem::remove(at.store());
  Store::OpenForWriting(at.store(), {.sync = false}).Save(kName, Read(at.binary()));
  for (Map& map : atlas.maps)
    if (!map.keyframes.empty()) map.keyframes.front().timestamp += 1e-6;
  Write(atlas, at.other(), false, true);
}

void Synthesize(double megabytes, std::size_t points, const std::string& path) {
  constexpr std::size_t kTrial = 20, kPointsPerKeyframe = 140;  // as ORB-SLAM3's own RGB-D sessions
  Atlas trial = SynthesizeAtlas(RoomOf(kTrial, kTrial * kPointsPerKeyframe));
  const double each = static_cast<double>(EncodeOrbslam3(trial).size()) * 1e-6 / kTrial;
  const auto keyframes = std::max<std::size_t>(kTrial, static_cast<std::size_t>(megabytes / each));
  Atlas atlas = SynthesizeAtlas(RoomOf(keyframes, points != 0 ? points : keyframes * kPointsPerKeyframe));
  Write(atlas, path, false);
}

}  // namespace slamdb::bench
