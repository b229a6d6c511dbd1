// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/ndjson.h"

#include <algorithm>
#include <array>

#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/ndjson/detail/read.h"
#include "slamdb/formats/ndjson/json.h"

namespace slamdb::detail {
namespace {

constexpr double kKeyFrameWeight = 200;  // how much longer a keyframe's line is than a point's, about
constexpr std::size_t kKeyFramesPerBlock = 4, kPointsPerBlock = 1024, kLandmarksPerBlock = 256;

double SizeOf(const Column<KeyFrame>& keyframes) { return kKeyFrameWeight * static_cast<double>(keyframes.size()); }
double SizeOf(const Column<MapPoint>& points) { return static_cast<double>(points.size()); }
double SizeOf(const std::vector<Landmark>& landmarks) { return static_cast<double>(landmarks.size()); }

// Turns the progress of each list into the progress of the whole.
class PartProgress {
 public:
  PartProgress(const WriteOptions& options, const std::vector<const Map*>& maps) : options_(options) {
    for (const Map* map : maps) whole_ += SizeOf(map->keyframes) + SizeOf(map->points) + SizeOf(map->landmarks);
  }
  // The options to write a list of this size with, after those before it.
  WriteOptions Next(double size) {
    WriteOptions part = options_;
    if (options_.progress)
      part.progress = [this, size, begin = done_](std::string_view stage, double fraction) {
        options_.progress(stage, (begin + fraction * size) / whole_);
      };
    done_ += size;
    return part;
  }

 private:
  const WriteOptions& options_;
  double whole_ = 0, done_ = 0;
};

template <class List>
void WriteList(AtomicFile& file, const Map& map, const List& list, std::size_t grain, const WriteOptions& options) {
  WriteRows(file, list.size(), grain, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) {
      AppendJson(out, list[row], map.id);
      out += '\n';
    }
  });
}

void WriteNdjson(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices&) {
  AtomicFile file(target, FileOptions(options));
  const std::vector<const Map*> maps = ChooseMaps(atlas, options, target);
  PartProgress progress(options, maps);
  std::string head;
  AppendJson(head, atlas);
  head += '\n';
  for (const Camera& camera : atlas.cameras) {
    AppendJson(head, camera);
    head += '\n';
  }
  file.Write(head);
  for (const Map* map : maps) {
    std::string line;
    AppendJson(line, *map);
    file.Write(line + '\n');
    WriteList(file, *map, map->keyframes, kKeyFramesPerBlock, progress.Next(SizeOf(map->keyframes)));
    WriteList(file, *map, map->points, kPointsPerBlock, progress.Next(SizeOf(map->points)));
    WriteList(file, *map, map->landmarks, kLandmarksPerBlock, progress.Next(SizeOf(map->landmarks)));
  }
  file.Commit();
}

// The first line is an object whose type is `atlas`, wherever in it that stands.
bool SniffNdjson(const Probe& probe) {
  constexpr std::string_view kBlank = " \t\r\n", kType = "\"type\"";
  std::string_view text = probe.head;
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  if (!text.starts_with('{')) return false;
  text = text.substr(0, text.find('\n'));
  for (std::size_t at = text.find(kType); at != text.npos; at = text.find(kType, at + 1)) {
    std::string_view rest = text.substr(at + kType.size());
    if (TakeWord(rest, " \t:,}") == "\"atlas\"") return true;
  }
  return false;
}

constexpr std::array<std::string_view, 2> kSuffixes = {".ndjson", ".jsonl"};

}  // namespace

const Format kNdjsonFormat = {.id = "ndjson",
                              .title = "JSON lines dump",
                              .suffixes = kSuffixes,
                              .chooses_maps = true,
                              .keeps_encoding = true,
                              .reads = Content::kEverything,
                              .writes = Content::kEverything,
                              .sniff = SniffNdjson,
                              .read = ReadNdjson,
                              .write = WriteNdjson};

}  // namespace slamdb::detail
