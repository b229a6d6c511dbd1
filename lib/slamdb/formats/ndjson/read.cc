// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/read.h"

#include <atomic>
#include <mutex>
#include <optional>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/detail/select.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kBytesPerBlock = 128 << 10;
// A keyframe takes some 4 kB; a line that is too short for what it must hold is refused before.
constexpr std::size_t kShortestKeyFrame = 100;
constexpr std::string_view kOrder =
    "lines stand in the order atlas, camera, then for each map map, keyframe, map_point, landmark";

enum class LineKind { kAtlas, kCamera, kMap, kKeyFrame, kPoint, kLandmark };
constexpr std::array<std::string_view, 6> kKinds{"atlas", "camera", "map", "keyframe", "map_point", "landmark"};

struct Line {
  std::string_view text;
  std::uint64_t number = 0;
  LineKind kind = LineKind::kAtlas;
  std::uint32_t map = 0;
  std::uint64_t row = 0;  // of its list
};

std::optional<LineKind> FindKind(std::string_view name) {
  const auto found = std::ranges::find(kKinds, name);
  return found == kKinds.end() ? std::nullopt : std::optional(static_cast<LineKind>(found - kKinds.begin()));
}

// Without a look at what stands behind the type where slamdb puts it.
LineKind KindOf(std::string_view text) {
  constexpr std::string_view kUsual = "{\"type\":\"";
  std::optional<LineKind> kind;
  if (text.starts_with(kUsual))
    kind = FindKind(text.substr(kUsual.size(), text.find('"', kUsual.size()) - kUsual.size()));
  if (kind) return *kind;
  JsonScanner json(text);
  json.Object([&](std::string_view name) {
    if (name != "type") return json.Skip();
    kind = FindKind(json.RawString("a type of line"));
    if (!kind) json.Refuse("is none of atlas, camera, map, keyframe, map_point, landmark");
  });
  if (!kind) json.Refuse("the member `type` is missing");
  return *kind;
}

class Reader {
 public:
  Reader(const std::string& path, const ReadOptions& options) : path_(path), options_(options) {}

  ReadLines Read(std::string_view text, Notices& notices) {
    FindLines(text);
    CutBlocks();
    ReadBlocks();
    RequireSoundEntries(lines_.atlas);
    Tell(notices);
    return std::move(lines_);
  }

 private:
  // What the heads claim, which edited and cut files do not hold.
  struct Claim {
    std::uint64_t line = 0;  // where
    std::optional<std::uint64_t> keyframes, points;
  };

  [[noreturn]] void Rethrow(const Error& error, std::uint64_t line) const {
    const std::string place = "line " + std::to_string(line);
    throw Error(error.kind(), path_, error.place().empty() ? place : place + ": " + error.place(), error.problem());
  }
  [[noreturn]] void Refuse(std::uint64_t line, const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, path_, "line " + std::to_string(line), problem);
  }

  // Reads the short lines at once, and keeps the others for later.
  void FindLines(std::string_view text) {
    std::uint64_t number = 0;
    bool begun = false;
    LineKind before = LineKind::kAtlas;
    while (!text.empty()) {
      Line line{.text = Trimmed(TakeLine(text)), .number = ++number};
      if (line.text.empty()) continue;
      try {
        line.kind = KindOf(line.text);
        RequireOrder(line, before, begun);
        Place(line);
      } catch (const Error& error) {
        if (!error.path().empty()) throw;
        Rethrow(error, number);
      }
      before = line.kind;
      begun = true;
    }
    if (!begun) throw Error(ErrorKind::kDamaged, path_, "", "has no lines");
  }
  void RequireOrder(const Line& line, LineKind before, bool begun) const {
    const bool in_map = line.kind > LineKind::kMap;
    if (!begun && line.kind != LineKind::kAtlas) Refuse(line.number, Wrong(line, "the first line is to be the atlas"));
    if (begun && line.kind == LineKind::kAtlas) Refuse(line.number, Wrong(line, "one file holds one atlas"));
    if (in_map && lines_.atlas.maps.empty()) Refuse(line.number, Wrong(line, "no map is before it"));
    if (line.kind < before && line.kind != LineKind::kMap)
      Refuse(line.number, Wrong(line, Concat("it stands behind a ", kKinds[static_cast<std::size_t>(before)])));
  }
  static std::string Wrong(const Line& line, const std::string& why) {
    return Concat("a line of type ", kKinds[static_cast<std::size_t>(line.kind)], " in the wrong place: ", why, "; ",
                  kOrder);
  }

  void Place(Line& line) {
    Atlas& atlas = lines_.atlas;
    if (line.kind == LineKind::kAtlas) return ReadHead(line);
    if (line.kind == LineKind::kCamera) return ReadCamera(line);
    if (line.kind == LineKind::kMap) return ReadMap(line);
    if (line.kind == LineKind::kKeyFrame && line.text.size() < kShortestKeyFrame) {
      KeyFrame short_one;
      JsonScanner json(line.text);
      KeyFrameMembers().ReadObject(json, short_one, [&](std::string_view) { json.Skip(); });
    }
    line.map = static_cast<std::uint32_t>(atlas.maps.size() - 1);
    line.row = counts_.back()[static_cast<std::size_t>(line.kind)]++;
    rows_.push_back(line);
  }
  void ReadHead(const Line& line) {
    JsonScanner json(line.text);
    lines_.given = AtlasMembers().ReadObject(json, lines_.atlas, [&](std::string_view name) {
      if (name == "maps")
        ReadMember(json, claimed_maps_.emplace());
      else if (name == "cameras")
        ReadMember(json, claimed_cameras_.emplace());
      else
        json.Skip();
    });
    json.RequireEnd();
    RequireSound(json, lines_.atlas.encoding);
  }
  void ReadCamera(const Line& line) {
    JsonScanner json(line.text);
    Camera& camera = lines_.atlas.cameras.emplace_back();
    lines_.cameras.push_back(CameraMembers().ReadObject(json, camera, [&](std::string_view) { json.Skip(); }));
    json.RequireEnd();
  }
  void ReadMap(const Line& line) {
    JsonScanner json(line.text);
    Map& map = lines_.atlas.maps.emplace_back();
    Claim& claim = claims_.emplace_back();
    claim.line = line.number;
    lines_.maps.emplace_back().map = MapMembers().ReadObject(json, map, [&](std::string_view name) {
      if (name == "keyframe_count")
        claim.keyframes = json.Whole<std::uint64_t>();
      else if (name == "point_count")
        claim.points = json.Whole<std::uint64_t>();
      else
        json.Skip();
    });
    json.RequireEnd();
    counts_.emplace_back();
  }

  std::size_t CountOf(std::size_t map, LineKind kind) const { return counts_[map][static_cast<std::size_t>(kind)]; }

  void CutBlocks() {
    Atlas& atlas = lines_.atlas;
    for (std::size_t m = 0; m < atlas.maps.size(); ++m) {
      atlas.maps[m].keyframes.resize(CountOf(m, LineKind::kKeyFrame));
      atlas.maps[m].points.resize(CountOf(m, LineKind::kPoint));
      atlas.maps[m].landmarks.resize(CountOf(m, LineKind::kLandmark));
      lines_.maps[m].keyframes.resize(atlas.maps[m].keyframes.size());
      lines_.maps[m].points.resize(atlas.maps[m].points.size());
    }
    std::size_t bytes = kBytesPerBlock;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (bytes >= kBytesPerBlock) blocks_.push_back(i), bytes = 0;
      bytes += rows_[i].text.size();
    }
    blocks_.push_back(rows_.size());
  }

  // Of several errors that of the first line is told, whoever came upon it first.
  void ReadBlocks() {
    std::mutex mutex;
    std::atomic<std::size_t> bad = rows_.size();
    std::optional<Error> first;
    ParallelFor(blocks_.size() - 1, 1, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = blocks_[begin]; row < blocks_[end] && row < bad; ++row) {
        try {
          ReadRow(rows_[row]);
        } catch (const Error& error) {
          const std::lock_guard lock(mutex);
          if (row < bad) bad = row, first = error;
        }
      }
    });
    if (first) Rethrow(*first, rows_[bad].number);
  }
  void ReadRow(const Line& line) {
    Map& map = lines_.atlas.maps[line.map];
    ReadLines::GivenOfMap& given = lines_.maps[line.map];
    JsonScanner json(line.text);
    const auto read_map_id = [&](std::string_view name) {
      if (name == "type") return json.Skip();
      MapId id;
      ReadMember(json, id);
      if (id != map.id) json.Refuse(Concat("is not the id of the map above, ", map.id.value()));
    };
    if (line.kind == LineKind::kKeyFrame) {
      KeyFrame& keyframe = map.keyframes[line.row];
      given.keyframes[line.row] = KeyFrameMembers().ReadObject(json, keyframe, read_map_id);
      RequireSound(json, given.keyframes[line.row], keyframe);
    } else if (line.kind == LineKind::kPoint) {
      given.points[line.row] = PointMembers().ReadObject(json, map.points[line.row], read_map_id);
    } else {
      LandmarkMembers().ReadObject(json, map.landmarks[line.row], read_map_id);
    }
    json.RequireEnd();
  }

  void Tell(Notices& notices) const {
    const Atlas& atlas = lines_.atlas;
    const auto ids = [](const auto& list) {
      std::vector<decltype(list.front().id)> of_list;
      for (const auto& entity : list) of_list.push_back(entity.id);
      return of_list;
    };
    if (claimed_maps_) TellList(*claimed_maps_, ids(atlas.maps), "map", notices);
    if (claimed_cameras_) TellList(*claimed_cameras_, ids(atlas.cameras), "camera", notices);
    for (std::size_t m = 0; m < claims_.size(); ++m) {
      TellClaim(claims_[m].keyframes, atlas.maps[m].keyframes.size(), claims_[m].line, "keyframe", notices);
      TellClaim(claims_[m].points, atlas.maps[m].points.size(), claims_[m].line, "map point", notices);
    }
  }
  template <class Id>
  static void TellList(const std::vector<Id>& claim, const std::vector<Id>& found, std::string_view noun,
                       Notices& notices) {
    if (claim == found) return;
    TellMissing(claim.size() > found.size(),
                Concat("the first line lists ", Counted(claim.size(), noun), ", but lines of ", found.size(),
                       " follow, or others"),
                notices);
  }
  static void TellClaim(std::optional<std::uint64_t> claim, std::uint64_t count, std::uint64_t line,
                        std::string_view noun, Notices& notices) {
    if (!claim || *claim == count) return;
    TellMissing(*claim > count,
                Concat("line ", line, ", of a map, counts ", Counted(*claim, noun), ", but ", count, " follow"),
                notices);
  }
  // Whoever took lines out says so by the counts; a file that is cut off at the end of a line tells of it by them
  // alone.
  static void TellMissing(bool fewer, const std::string& problem, Notices& notices) {
    if (fewer)
      notices.Lose(problem + "; the file was cut off, or edited: then the counts are to be mended, or left out");
    else
      notices.Warn(problem + "; was the file edited?");
  }

  const std::string& path_;
  const ReadOptions& options_;
  ReadLines lines_;
  std::optional<std::vector<MapId>> claimed_maps_;
  std::optional<std::vector<CameraId>> claimed_cameras_;
  std::vector<Claim> claims_;
  std::vector<std::array<std::uint64_t, kKinds.size()>> counts_;  // of each map
  std::vector<Line> rows_;
  std::vector<std::size_t> blocks_;  // where blocks of rows_ begin, and its end
};

}  // namespace

Atlas ReadNdjson(const Source& source, const ReadOptions& options, Notices& notices) {
  const WholeFile file(source);
  if (options.progress) options.progress("reading " + file.path(), 0);
  ReadLines lines = Reader(file.path(), options).Read(WithoutMark(file.text()), notices);
  CompleteLines(lines, options.threads, notices);
  Select(options.selection, lines.atlas);
  return std::move(lines.atlas);
}

}  // namespace slamdb::detail
