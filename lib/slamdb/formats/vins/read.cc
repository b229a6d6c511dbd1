// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/formats/import/detail/loops.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/formats/vins/detail/vins.h"
#include "slamdb/model/detail/camera_in_world.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Counted;

constexpr std::string_view kGraphFile = "pose_graph.txt";

// Columns of a line of the graph.
constexpr std::size_t kIndex = 0, kTime = 1, kPosition = 5, kRotation = 12, kLoop = 16, kKeypoints = 25, kColumns = 26;

// A line of numbers. Throws Error with its place where it has others.
template <std::size_t count>
std::array<double, count> NumbersOf(std::string_view line, const std::string& path, std::size_t number) {
  std::array<double, count> numbers{};
  for (std::size_t column = 0; column < count; ++column) {
    const std::string_view word = detail::TakeWord(line, detail::kBlanks);
    const auto value = detail::ParseNumber<double>(word);
    if (!value)
      throw Error(ErrorKind::kDamaged, path, Concat("line ", number),
                  Concat("expected ", count, " numbers, found in place of number ", column + 1, " ",
                         word.empty() ? "the end of the line" : detail::Excerpt(word)));
    numbers[column] = *value;
  }
  return numbers;
}

template <class Visit>
void ForEachLine(const WholeFile& file, const Visit& visit) {
  std::string_view rest = detail::WithoutMark(file.text());
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::string_view line = detail::TakeLine(rest);
    if (!detail::Trimmed(line).empty()) visit(line, number);
  }
}

bool IsGraphFile(const std::filesystem::path& path) {
  std::error_code missing;
  return path.filename() == kGraphFile && std::filesystem::is_regular_file(path, missing);
}

// Of the graph's file it is the folder around it.
std::filesystem::path FolderOf(const std::filesystem::path& path) {
  if (IsGraphFile(path)) return path.parent_path();
  if (std::error_code missing; std::filesystem::is_regular_file(path, missing))
    throw Error(ErrorKind::kUsage, path.string(), "",
                Concat("a pose graph of VINS is a folder: give its path, or that of its ", kGraphFile));
  return path;
}

class GraphReader {
 public:
  GraphReader(const Source& source, const ReadOptions& options, Notices& notices)
      : folder_(FolderOf(source.path)), options_(options), notices_(notices) {}

  Atlas Read() {
    Map& map = atlas_.maps.emplace_back();
    map.id = MapId(0);
    const WholeFile file((folder_ / kGraphFile).string());
    detail::WarnOfOpenEnd(file.text(), file.path(), notices_);
    ForEachLine(file, [&](std::string_view line, std::size_t number) {
      AddKeyFrame(NumbersOf<kColumns>(line, file.path(), number), file.path(), number);
    });
    CloseLoops(map);
    Tell(map);
    detail::CompleteAtlas(atlas_, "VINS", options_.threads, notices_);
    return std::move(atlas_);
  }

 private:
  void AddKeyFrame(const std::array<double, kColumns>& numbers, const std::string& path, std::size_t line) {
    const auto whole = [&](std::size_t column) {
      const double value = numbers[column];
      if (!(value >= -1 && value < 1e15) || value != std::floor(value))
        throw Error(ErrorKind::kDamaged, path, Concat("line ", line),
                    Concat("number ", column + 1, " must be a whole one, found ", value));
      return static_cast<std::int64_t>(value);
    };
    Map& map = atlas_.maps[0];
    const KeyFrameId before = map.keyframes.empty() ? KeyFrameId() : map.keyframes.back().id;
    KeyFrame& keyframe = map.keyframes.emplace_back();
    const std::int64_t index = whole(kIndex);
    if (index < 0 || !indices_.insert(index).second)
      throw Error(ErrorKind::kDamaged, path, Concat("line ", line),
                  Concat("keyframe ", index, index < 0 ? " has no index" : " is there already"));
    keyframe.id = KeyFrameId(static_cast<std::uint64_t>(index));
    keyframe.timestamp = numbers[kTime];
    const Eigen::Vector3d position(numbers[kPosition], numbers[kPosition + 1], numbers[kPosition + 2]);
    const Eigen::Quaterniond world_from_body(numbers[kRotation], numbers[kRotation + 1], numbers[kRotation + 2],
                                             numbers[kRotation + 3]);
    if (const std::string why = detail::WhyNoPose(world_from_body, position); !why.empty())
      throw Error(ErrorKind::kDamaged, path, Concat("line ", line), why);
    keyframe.camera_from_world = detail::CameraFromWorld(world_from_body, position);
    keyframe.parent = before;
    if (before) map.keyframes[map.keyframes.size() - 2].children.push_back(keyframe.id);
    if (const std::int64_t loop = whole(kLoop); loop >= 0)
      keyframe.loop_edges.push_back(KeyFrameId(static_cast<std::uint64_t>(loop)));
    ReadKeypoints(keyframe, whole(kKeypoints));
  }

  // `u v x y` a line: pixels, and where the ray meets z = 1. Descriptors are 256 digits, the last one bit 0.
  void ReadKeypoints(KeyFrame& keyframe, std::int64_t count) {
    if (options_.features == FeatureColumns::kNone) return;
    const std::string stem = std::to_string(keyframe.id.value());
    const std::filesystem::path keypoints = folder_ / (stem + "_keypoints.txt");
    const std::filesystem::path descriptors = folder_ / (stem + "_briefdes.dat");
    if (std::error_code missing; !std::filesystem::exists(keypoints, missing)) {
      without_keypoints_ += count > 0 ? 1 : 0;
      return;
    }
    Features& features = keyframe.features;
    const WholeFile file(keypoints.string());
    open_ends_ += detail::HasOpenEnd(file.text()) ? 1 : 0;
    ForEachLine(file, [&](std::string_view line, std::size_t number) {
      const auto numbers = NumbersOf<2>(line, file.path(), number);
      features.keypoints.push_back(detail::KeypointAt(static_cast<float>(numbers[0]), static_cast<float>(numbers[1])));
    });
    odd_counts_ += features.keypoints.size() != static_cast<std::uint64_t>(std::max<std::int64_t>(count, 0)) ? 1 : 0;
    if (std::error_code missing; !std::filesystem::exists(descriptors, missing)) return;
    const WholeFile bits(descriptors.string());
    ForEachLine(bits, [&](std::string_view line, std::size_t number) {
      features.descriptors.push_back(DescriptorOf(detail::Trimmed(line), bits.path(), number));
    });
    if (features.descriptors.size() == features.keypoints.size()) return;
    features.descriptors.clear();
    ++odd_counts_;
  }

  static Descriptor DescriptorOf(std::string_view digits, const std::string& path, std::size_t line) {
    Descriptor descriptor{};
    const bool binary = digits.find_first_not_of("01") == std::string_view::npos;
    if (digits.size() != 8 * descriptor.size() || !binary)
      throw Error(ErrorKind::kDamaged, path, Concat("line ", line),
                  Concat("expected a descriptor of 256 digits 0 and 1, found ", digits.size(), " characters"));
    for (std::size_t bit = 0; bit < digits.size(); ++bit)
      if (digits[digits.size() - 1 - bit] == '1')
        descriptor[bit / 8] = static_cast<std::uint8_t>(descriptor[bit / 8] | 1U << (bit % 8));
    return descriptor;
  }

  // The later keyframe of a loop records it.
  void CloseLoops(Map& map) {
    const IdTable rows = KeyFrameTable(map);
    for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
      if (map.keyframes[row].loop_edges.empty()) continue;
      const std::uint32_t end = rows.Find(map.keyframes[row].loop_edges[0].value());
      map.keyframes[row].loop_edges.clear();
      if (end == kNoRow || end == row)
        ++dangling_;
      else
        ends_.emplace_back(row, end);
    }
    for (const auto& [row, end] : ends_) detail::AddLoop(map.keyframes[row], map.keyframes[end]);
    detail::SortLoops(map.keyframes);
  }

  void Tell(const Map& map) {
    if (map.keyframes.empty()) return;
    notices_.Note(Concat("VINS keeps the poses of the body (IMU), optimised over ", Counted(ends_.size(), "loop"),
                         "; they stand where cameras' would. It keeps no map points and no cameras, and what it "
                         "measured of loops and before them has no place in an atlas"));
    const auto warn = [&](std::uint64_t count, std::string_view noun, std::string_view what) {
      if (count > 0) notices_.Warn(Counted(count, noun) + std::string(what));
    };
    warn(dangling_, "loop", " left out, to a keyframe that is not there");
    warn(without_keypoints_, "keyframe", " without the file of its keypoints");
    warn(open_ends_, "keyframe", " whose file of keypoints ends without an end of line, and may be cut there");
    warn(odd_counts_, "keyframe", " with another number of keypoints or descriptors than the graph says");
  }

  std::filesystem::path folder_;
  const ReadOptions& options_;
  Notices& notices_;
  Atlas atlas_;
  std::unordered_set<std::int64_t> indices_;                   // of keyframes
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_;  // of loops, rows
  std::uint64_t dangling_ = 0, without_keypoints_ = 0, odd_counts_ = 0, open_ends_ = 0;
};

// Any program may call a file so; in this one a line is 26 numbers.
bool BeginsWithLineOfGraph(const Probe& probe) {
  std::string_view text = detail::WithoutMark(probe.head);
  std::string_view line = detail::TakeLine(text);
  for (std::size_t column = 0; column < kColumns; ++column)
    if (!detail::ParseNumber<double>(detail::TakeWord(line, detail::kBlanks))) return false;
  return detail::Trimmed(line).empty();
}

bool Sniff(const Probe& probe) {
  const std::filesystem::path path(probe.path);
  return probe.is_directory ? IsGraphFile(path / kGraphFile) : IsGraphFile(path) && BeginsWithLineOfGraph(probe);
}

Atlas Read(const Source& source, const ReadOptions& options, Notices& notices) {
  if (!source.is_file())
    throw Error(ErrorKind::kUsage, source.path, "", "a pose graph of VINS is a folder: give its path");
  Atlas atlas = GraphReader(source, options, notices).Read();
  detail::Select(options.selection, atlas);
  return atlas;
}

}  // namespace

const Format detail::kVinsFormat{
    .id = "vins",
    .title = "VINS pose graph",
    .is_folder = true,
    .reads = Content::kPoses | Content::kGraph | Content::kKeypoints | Content::kDescriptors,
    .sniff = Sniff,
    .read = Read};

}  // namespace slamdb
