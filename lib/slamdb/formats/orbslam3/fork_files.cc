// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/fork_files.h"

#include <algorithm>
#include <array>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/formats/orbslam3/detail/meaning.h"
#include "slamdb/formats/orbslam3/detail/part_sizes.h"
#include "slamdb/model/detail/carried_members.h"

namespace slamdb::orbslam3 {
namespace {

using detail::Concat;

constexpr std::string_view kOwn = "v1.0";

std::string Joined(const std::vector<std::string>& names) {
  constexpr std::size_t kMostNamed = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNamed); ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kMostNamed) text += Concat(" and ", names.size() - kMostNamed, " more");
  return text;
}

// How an atlas names the layout that it was read in: a known one by its id.
std::string NameFor(const Layout& layout) {
  for (const Layout& known : KnownLayouts())
    if (SameBytes(known, layout)) return known.id == kOwn ? std::string() : known.id;
  return ToJson(layout);
}
std::string TitleOf(const Layout& layout) { return layout.id.empty() ? "of a file" : layout.id; }

bool IsOfTheBytes(const Error& error) {
  return error.kind() == ErrorKind::kDamaged || error.kind() == ErrorKind::kUnsupported;
}

// Text does not say how wide the writer's long and size_t were.
struct Widths {
  std::uint8_t long_bytes, size_bytes;
};
constexpr std::array<Widths, 3> kWidths{{{8, 8}, {4, 8}, {4, 4}}};

ForkReading ReadWithWidths(const Source& source, const ForkProgram& program, const ReadOptions& options,
                           std::span<const Widths> tried = kWidths) {
  std::optional<Error> first;
  for (const Widths& widths : tried) {
    detail::FileStream file(source);
    Notices known;
    ArchiveHeader header = ReadArchiveHeader(file, known);
    if (header.encoding.text) {
      header.encoding.long_bytes = widths.long_bytes;
      header.encoding.size_bytes = widths.size_bytes;
    }
    try {
      return ReadFork(file, header, program, options);
    } catch (const Error& error) {
      if (!header.encoding.text || !IsOfTheBytes(error)) throw;
      if (!first) first = error;
    }
  }
  throw *first;  // NOLINT(cert-err60-cpp)
}

void Finish(ForkReading& reading, const ForkProgram& program, const Source& source, const ReadOptions& options,
            Notices& notices) {
  Layout layout = program.layout;
  for (const auto& [of_class, key] : reading.exported) layout.Find(of_class)->exported = key;
  reading.atlas.layout = NameFor(layout);
  if (reading.left > 0)
    notices.Lose(Concat(source.path, ": ", reading.left,
                        " bytes behind the end of the atlas are not part of it and were left out"));
  if (!reading.derived.empty())
    notices.Warn(Concat(source.path, ": derived what the layout ", TitleOf(program.layout),
                        " lacks: ", Joined(reading.derived)));
  for (const std::string& doubt : DoubtsOfMissing(program))
    notices.Warn(Concat(source.path, ": in the layout ", TitleOf(program.layout), " ", doubt));
  if (options.part_sizes != nullptr)
    ListPartSizes(reading.part_bytes, static_cast<std::size_t>(detail::FileStream(source).size()), *options.part_sizes);
  detail::Select(options.selection, reading.atlas);
}

// Made ready once, as many files may be none of them.
const std::vector<ForkProgram>& KnownForks() {
  static const std::vector<ForkProgram> kForks(KnownLayouts().begin() + 1, KnownLayouts().end());
  return kForks;
}

// ---- what carries members of a fork

struct Carriers {
  std::uint64_t keyframes = 0, points = 0, others = 0;
};

Carriers CountCarriers(const Atlas& atlas) {
  Carriers count{.others = detail::HasMembers(atlas.carried) ? 1U : 0U};
  for (const Map& map : atlas.maps) {
    count.others += detail::HasMembers(map.carried);
    for (const KeyFrame& keyframe : map.keyframes) count.keyframes += detail::HasMembers(keyframe.carried);
    for (const MapPoint& point : map.points) count.points += detail::HasMembers(point.carried);
  }
  for (const Camera& camera : atlas.cameras) count.others += detail::HasMembers(camera.carried);
  return count;
}

// `mnExtra of 14 keyframes; mpCamera3 of 200 map points`.
std::string Members(const ForkProgram& program, std::uint64_t keyframes, std::uint64_t points, std::uint64_t others) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& names, std::uint64_t count, std::string_view of) {
    if (names.empty() || count == 0) return;
    text += Concat(text.empty() ? "" : "; ", Joined(names), " of ", detail::Thousands(count), " ", of);
  };
  add(program.foreign_keyframe, keyframes, keyframes == 1 ? "keyframe" : "keyframes");
  add(program.foreign_point, points, points == 1 ? "map point" : "map points");
  std::vector<std::string> names = program.foreign_atlas;
  names.insert(names.end(), program.foreign_map.begin(), program.foreign_map.end());
  names.insert(names.end(), program.foreign_camera.begin(), program.foreign_camera.end());
  std::ranges::sort(names);  // cameras of two classes have members of one name
  names.erase(std::unique(names.begin(), names.end()), names.end());
  add(names, others, others == 1 ? "other entity" : "others: the atlas, maps and cameras");
  return text;
}

// What is lost of an atlas whose carried members cannot be written.
void NameDropped(const Atlas& atlas, std::string_view target, Notices& notices) {
  const Carriers count = CountCarriers(atlas);
  if (count.keyframes + count.points + count.others == 0) return;
  if (IsOwnLayout(atlas.layout)) {
    notices.Lose(Concat("the layout ", target, " cannot hold the members of a fork that ",
                        detail::Thousands(count.keyframes), " keyframes and ", detail::Thousands(count.points),
                        " map points carry"));
    return;
  }
  const std::string members = Members(ForkProgram(LayoutOf(atlas.layout)), count.keyframes, count.points, count.others);
  if (!members.empty()) notices.Lose(Concat("the layout ", target, " cannot hold ", members));
}

// Whether what the entities carry is of that layout.
bool IsOfSameLayout(const Atlas& atlas, const std::string& layout) {
  if (IsOwnLayout(atlas.layout) || IsOwnLayout(layout)) return false;
  return atlas.layout == layout || SameBytes(LayoutOf(layout), LayoutOf(atlas.layout));
}

std::uint64_t Reachable(const std::vector<std::string>& names, std::uint64_t count) {
  return names.empty() ? 0 : count;
}

}  // namespace

bool IsOwnLayout(std::string_view layout) { return layout.empty() || layout == kOwn; }

LayoutReading ReadInLayout(const Source& source, const ForkProgram& program, const ReadOptions& options,
                           Notices& notices) {
  ForkReading reading = ReadWithWidths(source, program, options);
  Finish(reading, program, source, options, notices);
  const bool doubtful = LooksLikeAnotherLayout(reading.atlas, CountImplausible(reading.atlas) + reading.implausible);
  if (doubtful)
    notices.Warn(Concat(source.path, ": most keyframes have no sensible time or orientation in the layout ",
                        TitleOf(program.layout), ": it may be of another one"));
  return {std::move(reading.atlas), reading.left == 0 && !doubtful};
}

std::optional<Atlas> ReadInKnownLayout(const Source& source, const ReadOptions& options, Notices& notices) {
  std::optional<ForkReading> best;
  const ForkProgram* program = nullptr;
  std::vector<std::string> fitting;
  for (const ForkProgram& candidate : KnownForks()) {
    try {
      // Whoever has text of a fork on Windows names the layout: to try all would take long of a file that is damaged.
      ForkReading reading = ReadWithWidths(source, candidate, options, std::span(kWidths).first(1));
      reading.implausible += CountImplausible(reading.atlas);
      if (reading.left > 0 || LooksLikeAnotherLayout(reading.atlas, reading.implausible)) continue;
      fitting.push_back(candidate.layout.id);
      if (best && best->implausible <= reading.implausible) continue;
      best = std::move(reading);
      program = &candidate;
    } catch (const Error& error) {
      if (!IsOfTheBytes(error)) throw;
    }
  }
  if (!best) return std::nullopt;
  if (options.part_sizes != nullptr) options.part_sizes->clear();
  Finish(*best, *program, source, options, notices);
  notices.Note(Concat(source.path, ": read in the layout ", program->layout.id, " (", program->layout.title, ", as ",
                      program->layout.who, " write it), as it is not of ORB-SLAM3 v1.0"));
  if (fitting.size() > 1)
    notices.Warn(
        Concat(source.path, ": the layouts ", Joined(fitting), " all fit; Orbslam3ReadOptions::layout chooses"));
  return std::move(best->atlas);
}

void WriteInLayout(const Atlas& atlas, const ArchiveEncoding& encoding, const std::string& layout,
                   const Target::Sink& write, const std::string& path, Notices& notices) {
  const ForkProgram program(LayoutOf(layout));
  const bool fits = IsOfSameLayout(atlas, layout);
  if (!fits) NameDropped(atlas, TitleOf(program.layout), notices);
  const ForkWriting done = WriteFork(atlas, encoding, program, fits, write);
  const std::string filled = Members(program, Reachable(program.foreign_keyframe, done.filled_keyframes),
                                     Reachable(program.foreign_point, done.filled_points), done.filled_others);
  if (!filled.empty()) notices.Warn(Concat(path, ": zeros stand for what the atlas does not have: ", filled));
  if (done.dropped_pointers > 0)
    notices.Lose(Concat(path, ": ", done.dropped_pointers, " pointers to what is no longer there are null"));
}

void NameLossesToOwnLayout(const Atlas& atlas, Notices& notices) {
  for (const Camera& camera : atlas.cameras)
    if (camera.model == CameraModel::kEquirectangular)
      throw Error(ErrorKind::kNotPossible, "", ToString(camera.id),
                  "is equirectangular, for which ORB-SLAM3 v1.0 has no class");
  NameDropped(atlas, kOwn, notices);
}

namespace {

// Keyframes and points keep theirs apart: a layout may have one member and lack the other. Zeros are what stands where
// a file had none.
bool LosesDescriptors(const Atlas& atlas, const ForkProgram& program) {
  const bool of_keyframes = program.Lacks("KeyFrame.mDescriptors"), of_points = program.Lacks("MapPoint.mDescriptor");
  return std::ranges::any_of(atlas.maps, [&](const Map& map) {
    return (of_keyframes &&
            std::ranges::any_of(map.keyframes,
                                [](const KeyFrame& keyframe) { return keyframe.descriptor_count() > 0; })) ||
           (of_points && std::ranges::any_of(map.points, [](const MapPoint& point) {
              return (point.has_descriptor() && point.descriptor != Descriptor{}) || point.has_other_descriptor();
            }));
  });
}

}  // namespace

Content HeldBy(const Atlas& atlas, const std::string& layout, bool strict) {
  Content held = Content::kAtlas;
  // Otherwise what is carried is named member by member where it is written.
  if (!strict || IsOfSameLayout(atlas, layout)) held |= Content::kCarried;
  if (IsOwnLayout(layout)) return held;
  const ForkProgram program(LayoutOf(layout));
  if (std::ranges::find(program.point, "mnVisible", &Op<MapPoint>::name) != program.point.end()) {
    const auto has_origin = [](const Map& map) {
      return std::ranges::any_of(map.points,
                                 [](const MapPoint& point) { return point.origin_map != MapPoint::kNoOrigin; });
    };
    if (std::ranges::none_of(atlas.maps, has_origin)) held |= Content::kTracking;
  }
  if (LosesDescriptors(atlas, program)) held &= ~Content::kDescriptors;
  if (program.Lacks("KeyFrame.mBowVec")) held &= ~Content::kBagOfWords;
  if (program.Lacks("KeyFrame.mBackupImuPreintegrated")) held &= ~Content::kInertial;
  return held;
}

}  // namespace slamdb::orbslam3
