// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/records.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include "slamdb/formats/layouts/detail/wire_walk.h"

namespace slamdb::layouts {
namespace {

constexpr std::uint64_t kFarthestGrid = 4096;   // behind the beginning of its keyframe
constexpr std::uint64_t kLeastPointBytes = 32;  // less than any map point and its pointer
constexpr std::int16_t kMostClasses = 1024;
constexpr std::string_view kFirstOfClass("\1\0\0\0\0", 5);  // tracked, version 0
constexpr std::uint32_t kMostBetween = 16;                  // objects that a keyframe may bring
constexpr std::uint64_t kFarthestPoint = 1U << 20U;         // behind the one in front
constexpr std::uint64_t kMostLooks = 8;                     // behind gaps, in all so many times the file's length

template <class Number>
std::string BytesOf(Number number) {
  std::string bytes(sizeof(number), '\0');
  std::memcpy(bytes.data(), &number, sizeof(number));
  return bytes;
}

class Finder {
 public:
  Finder(std::string_view file, const ArchiveEncoding& encoding)
      : file_(file), size_bytes_(encoding.size_bytes), grid_(BytesOf(std::int32_t{64}) + BytesOf(std::int32_t{48})) {}

  std::vector<MapRecords> Run() {
    for (std::uint64_t at = NextGrid(0); at != kNowhere; at = NextGrid(at + 1)) Keyframe(at);
    for (MapRecords& map : maps_) Announce(map.keyframes);
    for (std::size_t i = 0; i < maps_.size(); ++i)
      Points(maps_[i], i + 1 < maps_.size() ? maps_[i + 1].keyframes.head : file_.size());
    return std::move(maps_);
  }

 private:
  std::uint64_t NextGrid(std::uint64_t from) const {
    const std::size_t at = file_.find(grid_, from);
    return at == std::string_view::npos ? kNowhere : at;
  }

  // ---- Keyframes

  // Takes the keyframe whose grid stands at `grid`, if there is one.
  void Keyframe(std::uint64_t grid) {
    const std::optional<Record> found = maps_.empty() ? First(grid) : Next(grid);
    if (!found) return;
    // The first keyframe may bring cameras, and some may be damaged; another map stands behind map points.
    const bool goes_on =
        found->object == last_object_ + 1 || (found->object - last_object_ <= kMostBetween && !IsListHead(*found));
    if (maps_.empty() || !goes_on) maps_.emplace_back().keyframes.class_id = class_id_;
    maps_.back().keyframes.records.push_back(*found);
    last_object_ = found->object;
    distance_ = grid - found->begin;
  }

  // The nearest pointer in front of the first grid that is the first of its class.
  std::optional<Record> First(std::uint64_t grid) {
    const std::uint64_t least = grid > kFarthestGrid ? grid - kFarthestGrid : 0;
    for (std::uint64_t at = grid; at-- > least;) {
      if (at < 2 || file_.substr(at, kFirstOfClass.size()) != kFirstOfClass) continue;
      const auto id = NumberAt<std::int16_t>(file_, at - 2);
      const auto object = NumberAt<std::uint32_t>(file_, at + kFirstOfClass.size());
      if (!id || !object || *id <= 0 || *id >= kMostClasses || *object == 0 || *object >= kMostObjects) continue;
      class_id_ = *id;
      return Record{at - 2, at + kFirstOfClass.size() + 4, *object};
    }
    return std::nullopt;
  }

  // The pointer in front of a later one: as far in front as it was before, or else the nearest that goes on counting.
  std::optional<Record> Next(std::uint64_t grid) const {
    const std::uint64_t behind = maps_.back().keyframes.records.back().body;
    if (grid - std::min(grid, behind) < 8) return std::nullopt;
    // The first of its class has five bytes more.
    const bool after_first = maps_.size() == 1 && maps_.front().keyframes.records.size() == 1;
    const std::uint64_t usual = distance_ - (after_first ? kFirstOfClass.size() : 0);
    if (grid >= usual && grid - usual > behind)
      if (const auto record = At(grid - usual)) return record;
    const std::uint64_t least = std::max(behind, grid > kFarthestGrid ? grid - kFarthestGrid : 0);
    for (std::uint64_t at = grid; at-- > least;)
      if (const auto record = At(at); record && record->object == last_object_ + 1) return record;
    return std::nullopt;
  }
  std::optional<Record> At(std::uint64_t at) const {
    const auto id = NumberAt<std::int16_t>(file_, at);
    const auto object = NumberAt<std::uint32_t>(file_, at + 2);
    if (!id || !object || *id != class_id_ || *object <= last_object_ ||
        *object - last_object_ > file_.size() / kLeastPointBytes)
      return std::nullopt;
    return Record{at, at + 6, *object};
  }

  // ---- Lists

  std::uint64_t HeadBytes() const { return size_bytes_ + 4U; }
  std::optional<std::uint64_t> CountAt(std::uint64_t at) const {
    if (size_bytes_ == 8) return NumberAt<std::uint64_t>(file_, at);
    const auto count = NumberAt<std::uint32_t>(file_, at);
    return count ? std::optional<std::uint64_t>(*count) : std::nullopt;
  }
  // Whether a count that the rest of the file can hold and item version 0 stand in front.
  bool IsListHead(const Record& record) const {
    if (record.begin < HeadBytes()) return false;
    const auto count = CountAt(record.begin - HeadBytes());
    const auto version = NumberAt<std::uint32_t>(file_, record.begin - 4);
    return count && version == 0U && *count > 0 && *count <= (file_.size() - record.begin) / kLeastPointBytes;
  }
  void Announce(RecordList& list) const {
    if (list.records.empty()) return;
    const Record& first = list.records.front();
    list.head = first.begin - std::min(first.begin, HeadBytes());
    list.announced = IsListHead(first) ? *CountAt(list.head) : 0;
  }

  // ---- Map points

  // Those behind the keyframes of a map, before `end`.
  void Points(MapRecords& map, std::uint64_t end) {
    const std::string_view file = file_.substr(0, end);
    std::uint64_t at = map.keyframes.records.back().body + kLeastPointBytes;
    const std::uint32_t first = map.keyframes.records.back().object + 1;
    const std::optional<Record> record = point_class_ > 0 ? NextPoint(file, at, first) : FirstPoint(file, at, first);
    if (!record) return;
    map.points.class_id = point_class_;
    map.points.records.push_back(*record);
    Announce(map.points);
    const std::uint64_t behind = std::uint64_t{record->object} + map.points.announced;
    while (map.points.records.back().object + 1 < behind) {
      const Record& last = map.points.records.back();
      auto next = NextPoint(Near(file, last), last.body + kLeastPointBytes, last.object + 1);
      if (!next) next = BehindGap(file, last, behind);
      if (!next) break;
      map.points.records.push_back(*next);
    }
  }
  // Behind damage numbers count on: the first later point of the list that is the last one, or has others behind it.
  // None, too, where a file that means to take long has been looked through often enough.
  std::optional<Record> BehindGap(std::string_view file, const Record& last, std::uint64_t behind) {
    const std::string id = BytesOf(point_class_);
    for (std::size_t at = file.find(id, last.body); at != std::string_view::npos; at = file.find(id, at + 1)) {
      const std::uint32_t object = NumberAt<std::uint32_t>(file, at + 2).value_or(0);
      if (object <= last.object || object >= behind) continue;
      if ((object - last.object) * kLeastPointBytes > at - last.begin) continue;
      if (looked_at_ > kMostLooks * file_.size()) break;
      const Record found{at, at + 6, object};
      if (object + 1 == behind || GoesOn(file, found)) return found;
    }
    return std::nullopt;
  }
  // Whether one of the next points stands behind: a single one may be damaged, too.
  bool GoesOn(std::string_view file, const Record& record) {
    for (std::uint32_t next = 1; next <= 3; ++next) {
      const auto found = NextPoint(Near(file, record), record.body + kLeastPointBytes, record.object + next);
      looked_at_ += (found ? found->begin : Near(file, record).size()) - record.begin;
      if (found) return true;
    }
    return false;
  }
  static std::string_view Near(std::string_view file, const Record& record) {
    return file.substr(0, std::min<std::uint64_t>(file.size(), record.body + kFarthestPoint));
  }
  std::optional<Record> FirstPoint(std::string_view file, std::uint64_t at, std::uint32_t object) {
    // Cameras in the last keyframe may come first.
    for (std::uint32_t skipped = 0; skipped < kMostBetween; ++skipped) {
      const std::string pattern = std::string(kFirstOfClass) + BytesOf(object + skipped);
      for (std::size_t found = file.find(pattern, at); found != std::string_view::npos;
           found = file.find(pattern, found + 1)) {
        const auto id = NumberAt<std::int16_t>(file, found - 2);
        const Record record{found - 2, found + pattern.size(), object + skipped};
        if (*id <= class_id_ || *id >= kMostClasses || !IsListHead(record)) continue;
        point_class_ = *id;
        return record;
      }
    }
    return std::nullopt;
  }
  std::optional<Record> NextPoint(std::string_view file, std::uint64_t at, std::uint32_t object) const {
    const std::size_t found = file.find(BytesOf(point_class_) + BytesOf(object), at);
    if (found == std::string_view::npos) return std::nullopt;
    return Record{found, found + 6, object};
  }

  static constexpr std::uint32_t kMostObjects = 1U << 30U;

  const std::string_view file_;
  const std::uint8_t size_bytes_;
  const std::string grid_;
  std::vector<MapRecords> maps_;
  std::int16_t class_id_ = 0, point_class_ = 0;
  std::uint32_t last_object_ = 0;
  std::uint64_t looked_at_ = 0;  // bytes behind gaps
  std::uint64_t distance_ = 0;   // from the last keyframe's pointer to its grid
};

}  // namespace

std::vector<MapRecords> FindRecords(std::string_view file, const ArchiveEncoding& encoding) {
  return Finder(file, encoding).Run();
}

}  // namespace slamdb::layouts
