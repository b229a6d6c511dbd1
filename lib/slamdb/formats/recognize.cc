// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/detail/recognize.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/mrpt/detail/gzip.h"
#include "slamdb/formats/trajectory/detail/pose_table.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kWanted = "an atlas";

ForeignFile DescribeDirectory(const std::string& path) {
  std::vector<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(path, failed), end; !failed && entry != end; entry.increment(failed))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  const auto has = [&names](std::string_view name) { return std::binary_search(names.begin(), names.end(), name); };
  if ((has("images.bin") && has("points3D.bin")) || (has("images.txt") && has("points3D.txt")))
    return {ErrorKind::kDamaged, "not an atlas: this folder is a COLMAP model without its file of cameras"};
  if (has("transforms.json")) {
    const Recognized scene = RecognizedAs("nerf");
    return {scene.kind, SentenceOf(scene, kWanted)};
  }
  if (has("metadata.yaml"))
    return {ErrorKind::kUnsupported,
            "not an atlas: this folder is a ROS 2 bag; run a SLAM system on it and give the atlas that it saves"};
  const auto is_atlas = [](const std::string& name) { return name.ends_with(".osa"); };
  std::string problem = "is a directory, expected an atlas file; ListAtlases and CheckAtlas take all that is in it";
  const auto atlas = std::find_if(names.begin(), names.end(), is_atlas);
  const bool alone = atlas != names.end() && std::none_of(atlas + 1, names.end(), is_atlas);
  if (alone) problem += "; did you mean " + (std::filesystem::path(path) / *atlas).string() + "?";
  return {ErrorKind::kUsage, std::move(problem)};
}

// Packed files say what is in them, as far as they can be unpacked.
ForeignFile DescribeGzip(const Probe& probe) {
  constexpr std::size_t kEnough = std::size_t{64} << 10;
  const std::string inside = mrpt::DecompressHead(probe.head, kEnough);
  const Bytes bytes = std::as_bytes(std::span(inside));
  const auto recognized = inside.empty() ? std::nullopt : Recognize(Probe::Of({bytes, probe.path}));
  std::string what =
      "what is in it, or left of it, does not begin like a landmarks map of MRPT, the only kind that "
      "slamdb reads so; if it is an atlas, unpack it first (gunzip)";
  if (recognized && recognized->id == "archive")
    what = "an atlas of ORB-SLAM3 may be in it; unpack it first (gunzip)";
  else if (recognized && recognized->kind == ErrorKind::kUnsupported)
    what = Concat("in it is ", recognized->what, recognized->next.empty() ? "" : "; ", recognized->next);
  return {ErrorKind::kUnsupported, Concat("not ", kWanted, ": this is gzip-compressed, and ", what)};
}

}  // namespace

std::optional<ForeignFile> RecognizeOther(const Probe& probe) {
  if (probe.is_directory) return DescribeDirectory(probe.path);
  auto recognized = Recognize(probe);
  if (!recognized || recognized->id == "archive") return std::nullopt;  // its reader knows best what is wrong with it
  if (recognized->id == "gzip") return DescribeGzip(probe);
  if (recognized->id == "zeros") recognized->next = " SalvageAtlas looks for what stands behind them";
  return ForeignFile{recognized->kind, SentenceOf(*recognized, kWanted)};
}

std::string DescribeUnknown(const Probe& probe) {
  const bool text = std::all_of(probe.head.begin(), probe.head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 ? byte != 0x7f : byte == '\n' || byte == '\r' || byte == '\t' || byte == '\f';
  });
  if (!text) return "not an atlas: neither its first bytes nor its suffix are of a kind that slamdb reads";
  const TableLayout layout = FindLayout(WithoutMark(probe.head), PoseTable(PoseLayout::kTum));
  constexpr std::size_t kEnough = 4;  // of time, position and orientation
  if (!layout.missing.empty() && layout.named >= kEnough)
    return "neither an atlas nor a trajectory: no column is named " + layout.missing;
  return "not an atlas: this looks like a text file, of no kind that slamdb reads";
}

}  // namespace slamdb::detail
