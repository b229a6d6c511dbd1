// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/salvage.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>

#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/decoder.h"
#include "slamdb/formats/orbslam3/detail/fork_files.h"
#include "slamdb/formats/orbslam3/detail/fork_salvage.h"
#include "slamdb/formats/orbslam3/detail/lookahead.h"
#include "slamdb/formats/orbslam3/detail/object_search.h"
#include "slamdb/formats/orbslam3/detail/pointers.h"
#include "slamdb/formats/orbslam3/detail/transfer.h"
#include "slamdb/formats/orbslam3/options.h"

namespace slamdb::orbslam3 {
namespace {

constexpr std::size_t kLeastObjectBytes = 64;  // takes less than any object
constexpr std::size_t kTruncationBytes = 64;   // failing so close to the end is because of the end
constexpr std::size_t kMostBehindNoMaps = 4096;

// Reads on where an object stands; behind damage, at the next object that is whole.
template <class Input>
class Salvager {
 public:
  Salvager(const Salvager&) = delete;  // what it looks with refers to it
  Salvager& operator=(const Salvager&) = delete;
  Salvager(detail::FileStream& file, const ArchiveHeader& header)
      : file_(file.data(), file.size()),
        most_objects_(static_cast<std::uint32_t>(file.size() / kLeastObjectBytes)),
        at_(Input(&file, header.encoding), ClassTable(header.encoding), FeatureColumns::kAll),
        search_(file_, at_, objects_, most_objects_),
        ahead_(at_, objects_) {
    salvage_.atlas.encoding = header.encoding;
    at_.input.Tolerate(&salvage_.damage);
    at_.input.Seek(header.bytes);
  }

  // `header_error`: why the header was not read; null: it was.
  Salvage Run(const Error* header_error) {
    if (header_error != nullptr) Note(*header_error);
    salvage_.lost_beginning = !ReadBeginning();
    if (salvage_.lost_beginning) GoToFirstMap();
    bool behind_maps = false;
    try {
      behind_maps = ReadMaps();
    } catch (const Error& error) {
      Note(error);
    }
    ReadCounters(ReadCameras(behind_maps));
    for (std::size_t row = 0; row < salvage_.maps.size(); ++row) {
      salvage_.maps[row].keyframes.read = salvage_.atlas.maps[row].keyframes.size();
      salvage_.maps[row].points.read = salvage_.atlas.maps[row].points.size();
    }
    return std::move(salvage_);
  }

 private:
  enum class Behind { kNothing, kMap, kKeyFrames };

  void Note(const Error& error) {
    salvage_.damage.push_back((error.place().empty() ? "" : error.place() + ": ") + error.problem());
  }
  bool AtEndOfFile() const { return at_.input.remaining() < kTruncationBytes; }

  // ---- The beginning

  void ReadPreamble() {
    Atlas& atlas = salvage_.atlas;
    at_.input.place.field = "vocabulary";
    atlas.vocabulary.name = at_.input.TakeString();
    atlas.vocabulary.checksum = at_.input.TakeString();
    at_.input.place.field = "Atlas";
    TakePointer(at_, objects_, {WireClass::kAtlas});
    objects_.Add(WireClass::kAtlas, 0, 0);
    at_.classes.Register(WireClass::kPinhole);
    at_.classes.Register(WireClass::kKannalaBrandt8);
  }

  // Returns whether the first map stands behind it.
  bool ReadBeginning() {
    try {
      ReadPreamble();
      salvage_.maps_listed = at_.ClassCount(WireClass::kMapList, 2, 1);
    } catch (const Error& error) {
      Note(error);
      return false;
    }
    // Zeros look like an atlas without maps, behind which only cameras and counters stand.
    return salvage_.maps_listed == 0 ? at_.input.remaining() <= kMostBehindNoMaps : MapStandsHere();
  }

  // Where the beginning is lost, whatever its bytes say: there is a map, and its keyframes stand somewhere.
  void GoToFirstMap() {
    constexpr std::size_t kChecksumLength = 32;
    if (salvage_.atlas.vocabulary.checksum.size() != kChecksumLength) salvage_.atlas.vocabulary = {};
    objects_ = {};
    objects_.Add(WireClass::kAtlas, 0, 0);
    at_.classes = TableOfFirstMap(at_.input.encoding());
    at_.input.Seek(0);
    salvage_.maps_listed = 1;
  }

  // ---- Maps

  // Returns whether the cursor stands behind the maps.
  bool ReadMaps() {
    bool lost_head = salvage_.lost_beginning;
    for (std::uint64_t position = 0; position < salvage_.maps_listed; ++position) {
      at_.input.place = {.map = static_cast<std::int64_t>(position)};
      const Pointer pointer = lost_head ? Pointer{Pointer::Kind::kNew} : TakePointer(at_, objects_, {WireClass::kMap});
      if (pointer.kind != Pointer::Kind::kNew) {
        salvage_.atlas.repeated_maps.push_back(Repeated(at_, objects_, pointer, position));
        continue;
      }
      const auto row = static_cast<std::uint32_t>(salvage_.atlas.maps.size());
      objects_.Add(WireClass::kMap, 0, row);
      const bool whole = ReadMap(salvage_.atlas.maps.emplace_back(), salvage_.maps.emplace_back(), row, lost_head);
      const Behind behind = whole ? Behind::kMap : SeekBehindMap();
      if (behind == Behind::kNothing) return false;
      lost_head = behind == Behind::kKeyFrames;
    }
    at_.input.place = {};
    return true;
  }

  // Returns whether the cursor stands behind the map.
  bool ReadMap(Map& map, SalvagedMap& read, std::uint32_t row, bool lost_head) {
    if (!lost_head) LayoutMapHead(at_, map);
    search_.LearnUsualTables();
    bool stands = ReadList(row, map.keyframes, map.repeated_keyframes, read.keyframes, lost_head);
    if (lost_head) map.id = IdOfMapWithoutHead(map);
    read.id = map.id;
    read.lost_head = lost_head;
    bool lost_count = false;
    if (!stands || !ListBeginsHere(WireClass::kMapPointList, {WireClass::kMapPoint})) {
      if (stands && !AtEndOfFile()) DropIfBroken(map.keyframes);
      lost_count = !SeekList(WireClass::kMapPointList, WireClass::kMapPoint);
    }
    stands = ReadList(row, map.points, map.repeated_points, read.points, lost_count);
    return stands && ReadMapTail(map);
  }

  // The map in which its first keyframe was made, when no other map has that id.
  MapId IdOfMapWithoutHead(const Map& map) const {
    std::uint64_t id = map.keyframes.empty() ? 0 : map.keyframes.front().origin_map;
    const auto taken = [&](const Map& other) { return &other != &map && other.id == MapId(id); };
    while (std::ranges::any_of(salvage_.atlas.maps, taken)) ++id;
    return MapId(id);
  }

  template <class Entity>
  static void DropIfBroken(Column<Entity>& list) {
    if (!list.empty() && !LooksWhole(list.back())) list.pop_back();
  }

  bool IsLastMap() const {
    return salvage_.atlas.maps.size() + salvage_.atlas.repeated_maps.size() == salvage_.maps_listed;
  }

  // The members behind the lists. Returns whether what must follow them does.
  bool ReadMapTail(Map& map) {
    Map tail;
    try {
      LayoutMapTail(at_, tail);
    } catch (const Error& error) {
      Note(error);
      DropIfBroken(map.points);
      return false;
    }
    if (salvage_.lost_beginning && !ahead_.WhyNoPointer({WireClass::kMap})) ++salvage_.maps_listed;
    const bool stands =
        IsLastMap() ? AtEndOfFile() || ListBeginsHere(WireClass::kCameraList, kCameraClasses) : MapStandsHere();
    if (!stands && !LooksWhole(tail, LargestKeyFrame(map))) {
      DropIfBroken(map.points);
      return false;
    }
    map.origins = std::move(tail.origins);
    map.first_keyframe = tail.first_keyframe;
    map.lowest_keyframe = tail.lowest_keyframe;
    map.imu_initialized = tail.imu_initialized;
    map.inertial = tail.inertial;
    map.imu_ba1 = tail.imu_ba1;
    map.imu_ba2 = tail.imu_ba2;
    return stands;
  }

  static std::uint64_t LargestKeyFrame(const Map& map) {
    std::uint64_t largest = map.max_keyframe_id;
    for (const KeyFrame& keyframe : map.keyframes) largest = std::max(largest, keyframe.id.value());
    return std::min<std::uint64_t>(largest, std::numeric_limits<std::int32_t>::max());
  }

  // Moves to the next map, or to the keyframes of one whose beginning is lost, or to the list of cameras.
  Behind SeekBehindMap() {
    const std::size_t from = at_.input.offset();
    if (IsLastMap() && !salvage_.lost_beginning)
      return SeekList(WireClass::kCameraList, WireClass::kPinhole) ||
                     SeekList(WireClass::kCameraList, WireClass::kKannalaBrandt8)
                 ? Behind::kMap
                 : Behind::kNothing;
    const std::optional<FoundObject> map = search_.FindMap(from);
    const std::optional<FoundObject> keyframe =
        search_.template FindWhole<KeyFrame>(most_objects_, from, map ? map->at.offset : file_.size());
    if (IsLastMap() && (map || keyframe)) ++salvage_.maps_listed;
    if (keyframe) {
      at_.input.Seek(from);
      return Behind::kKeyFrames;
    }
    if (!map) return Behind::kNothing;
    GoTo(*map);
    return Behind::kMap;
  }

  // ---- Lists

  // Reads a list from its head on, over damaged stretches. Returns whether it came to the list's end. Where the head is
  // lost, with the number of the objects, it ends where what must follow it stands.
  template <class Entity>
  bool ReadList(std::uint32_t row, Column<Entity>& list, std::vector<RepeatedEntry>& repeated, SalvagedList& read,
                bool lost_head) {
    using Kind = ListKind<Entity>;
    std::size_t begin = at_.input.offset(), begin_before = begin;
    bool doubtful = false;  // the entity in front: what follows it has not been seen
    std::uint64_t position = 0;
    if (!BeginList<Entity>(lost_head, read, position)) return false;
    while (position < read.listed) {
      const ClassTable classes = at_.classes;
      const std::size_t noted = salvage_.damage.size();
      at_.input.place = {.map = at_.input.place.map, .entity = Kind::kName, .ordinal = position, .of = read.listed};
      begin = at_.input.offset();
      try {
        const Pointer pointer = TakePointer(at_, objects_, {Kind::kEntity});
        if (pointer.kind != Pointer::Kind::kNew) {
          const RepeatedEntry entry = Repeated(at_, objects_, pointer, position);
          if (ahead_.WhyNoPointer({Kind::kEntity}))
            at_.input.Fail("a pointer that brings nothing new, and behind it none: the file is damaged");
          doubtful = false;
          repeated.push_back(entry);
          ++position;
          continue;
        }
        doubtful = false;
        Entity entity;
        Kind::Layout(at_, entity);
        objects_.Add(Kind::kEntity, row, list.size());
        list.push_back(std::move(entity));
        begin_before = begin;
        doubtful = true;
        ++position;
      } catch (const Error& error) {
        salvage_.damage.resize(noted);  // what was tolerated of an object that is none, or lost
        if (lost_head && EndsAt<Entity>(begin, classes)) {
          read.listed = position;
          break;
        }
        Note(error);
        if (doubtful && !AtEndOfFile() && !LooksWhole(list.back())) {
          list.pop_back();
          begin = begin_before;
        }
        doubtful = false;
        at_.classes = classes;
        if (!Resume<Entity>(begin + 1, lost_head, position)) {
          at_.classes = TablesBehind(classes, Kind::kEntity).front();
          at_.input.Seek(begin + 1);
          if (lost_head) read.listed = position;
          return false;
        }
      }
    }
    at_.input.place.entity = nullptr;
    return true;
  }

  // Reads the head of a list; where it is lost, moves to the list's first whole object.
  template <class Entity>
  bool BeginList(bool lost_head, SalvagedList& read, std::uint64_t& position) {
    using Kind = ListKind<Entity>;
    const std::uint32_t first = objects_.next();
    if (!lost_head) {
      try {
        read.listed = at_.ClassCount(Kind::kList, 2, 1);
      } catch (const Error& error) {
        Note(error);
        return false;
      }
      object_behind_ = first + static_cast<std::uint32_t>(read.listed);
      return true;
    }
    object_behind_ = first + most_objects_;
    if (!Resume<Entity>(at_.input.offset(), true, position)) return false;
    read.listed = most_objects_;
    return true;
  }

  // Moves the cursor to the next whole object of the list.
  template <class Entity>
  bool Resume(std::size_t offset, bool lost_head, std::uint64_t& position) {
    std::size_t end = file_.size();
    if (lost_head) {
      if (!sought_map_ || (next_map_ && next_map_->at.offset < offset)) next_map_ = search_.FindMap(offset);
      sought_map_ = true;
      if (next_map_) end = next_map_->at.offset;
    }
    const std::optional<FoundObject> found = search_.template FindWhole<Entity>(object_behind_, offset, end);
    if (!found) return false;
    position += found->at.object - objects_.next();
    GoTo(*found);
    return true;
  }

  void GoTo(const FoundObject& found) {
    SkipObjects(found.at.object);
    at_.classes = found.classes;
    at_.input.Seek(found.at.offset);
  }

  // Whether a list ends there; moves there.
  template <class Entity>
  bool EndsAt(std::size_t offset, const ClassTable& classes) {
    at_.classes = classes;
    at_.input.Seek(offset);
    if constexpr (std::is_same_v<Entity, KeyFrame>)
      return !ahead_.WhyNoList(WireClass::kMapPointList, {WireClass::kMapPoint});
    else
      return !ahead_.WhyNoMapTail();
  }

  // Counts objects that are lost.
  void SkipObjects(std::uint32_t next) {
    while (objects_.next() < next) objects_.Add(WireClass::kCount, 0, objects_.next());
  }

  // Moves to the head of the list of a class behind the list that was read last.
  bool SeekList(WireClass list_class, WireClass wire_class) {
    const std::optional<FoundList> found = search_.FindList(list_class, wire_class, object_behind_);
    if (!found) return false;
    SkipObjects(found->first_object);
    at_.classes = found->classes;
    at_.input.Seek(found->begin);
    return true;
  }

  // Whether what must follow does, without moving there; tells when not.
  bool MapStandsHere() { return Stands(ahead_.WhyNoPointer({WireClass::kMap})); }
  bool ListBeginsHere(WireClass list_class, std::initializer_list<WireClass> classes) {
    return Stands(ahead_.WhyNoList(list_class, classes));
  }
  bool Stands(const std::optional<Error>& why_not) {
    if (why_not) Note(*why_not);
    return !why_not;
  }

  // ---- The end

  // `stands`: the list begins at the cursor. Returns whether the cursor is behind all of it.
  bool ReadCameras(bool stands) {
    constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();
    at_.input.place = {.field = "mvpCameras"};
    std::uint64_t listed = kUnknown;
    if (stands) stands = Try([&] { listed = at_.ClassCount(WireClass::kCameraList, 2, 1); });
    for (std::uint64_t position = 0; position < listed; ++position) {
      if (stands && listed == kUnknown && !ahead_.WhyNoCounters()) return true;
      if (stands) stands = Try([&] { ReadCamera(position); });
      if (stands) continue;
      const std::optional<FoundObject> found = search_.FindCamera(at_.input.offset());
      if (!found) return false;
      listed = kUnknown;
      GoTo(*found);
      stands = true;
    }
    return stands;
  }

  template <class Read>
  bool Try(const Read& read) {
    try {
      read();
      return true;
    } catch (const Error& error) {
      Note(error);
      return false;
    }
  }

  void ReadCamera(std::uint64_t position) {
    const Pointer pointer = TakePointer(at_, objects_, kCameraClasses);
    if (pointer.kind != Pointer::Kind::kNew) {
      salvage_.atlas.repeated_cameras.push_back(Repeated(at_, objects_, pointer, position));
      return;
    }
    Camera camera = CameraOf(pointer.wire_class);
    LayoutCamera(at_, camera);
    objects_.Add(pointer.wire_class, 0, salvage_.atlas.cameras.size());
    salvage_.atlas.cameras.push_back(std::move(camera));
  }

  // `stand`: at the cursor. Otherwise they are the last numbers of the file, when they are above what was read.
  void ReadCounters(bool stand) {
    at_.input.place = {};
    Counters counters;
    if (stand) stand = Try([&] { LayoutCounters(at_, counters); });
    if (!stand) {
      at_.input.Seek(search_.LastNumbers(6));
      try {
        LayoutCounters(at_, counters);
      } catch (const Error&) {  // they are lost
        return;
      }
      if (!AreAboveWhatWasRead(counters)) return;
    }
    salvage_.atlas.next_ids = counters;
  }

  bool AreAboveWhatWasRead(const Counters& counters) const {
    constexpr std::uint64_t kLargest = std::numeric_limits<std::int32_t>::max();
    const auto above = [](std::uint64_t counter, std::uint64_t id) { return counter > id && counter <= kLargest; };
    for (const Map& map : salvage_.atlas.maps) {
      if (!above(counters.map, map.id.value())) return false;
      for (const KeyFrame& keyframe : map.keyframes)
        if (!above(counters.keyframe, keyframe.id.value()) || !above(counters.frame, keyframe.frame_id)) return false;
      for (const MapPoint& point : map.points)
        if (!above(counters.map_point, point.id.value())) return false;
    }
    for (const Camera& camera : salvage_.atlas.cameras)
      if (!above(counters.camera, camera.id.value())) return false;
    return !salvage_.atlas.maps.empty() && counters.initial_keyframe <= kLargest && counters.camera <= kLargest;
  }

  std::string_view file_;
  Salvage salvage_;
  ObjectTable objects_;
  const std::uint32_t most_objects_;
  std::uint32_t object_behind_ = 0;  // behind the last object of the list that was read last
  bool sought_map_ = false;
  std::optional<FoundObject> next_map_;  // behind the list whose head is lost
  Decoder<Input> at_;
  ObjectSearch<Input> search_;
  const Lookahead<Input> ahead_;
};

}  // namespace
}  // namespace slamdb::orbslam3

namespace slamdb::detail {

namespace {

// `layout`: as Orbslam3ReadOptions names it.
Salvage SalvageBytesOf(Bytes bytes, const std::string& path, const std::string& layout) {
  detail::FileStream file({bytes, path});
  Notices notices;
  orbslam3::ArchiveHeader header;
  std::optional<Error> header_error;
  try {
    header = orbslam3::ReadArchiveHeader(file, notices);
  } catch (const Error& error) {
    if (file.size() == 0) throw;
    header_error = error;
  }
  if (header_error) header = orbslam3::UsualArchiveHeader({file.data(), file.size()});
  if (auto given = orbslam3::SalvageInLayout(bytes, path, header, layout)) return *std::move(given);
  const Error* why = header_error ? &*header_error : nullptr;
  if (header.encoding.text) return orbslam3::Salvager<orbslam3::TextInput>(file, header).Run(why);
  if (layout.empty())
    if (auto fork = orbslam3::SalvageFork(bytes, path, header)) return *std::move(fork);
  Salvage salvage = orbslam3::Salvager<orbslam3::BinaryInput>(file, header).Run(why);
  if (layout.empty() && !orbslam3::HasKeyFrames(salvage.atlas))
    if (auto records = orbslam3::SalvageOwnRecords(bytes, path, header)) return *std::move(records);
  return salvage;
}

}  // namespace

Salvage SalvageOrbslam3(const Source& source, const ReadOptions& options) {
  std::optional<WholeFile> file(source);
  orbslam3::Transfers transfers;
  if (orbslam3::SniffArchive(file->text()) == false) transfers = orbslam3::FindTransfers(file->text());
  if (!transfers.undone.empty()) file.reset();
  Salvage result = SalvageBytesOf(file ? file->bytes() : std::as_bytes(std::span(transfers.bytes)), source.path,
                                  options.of<Orbslam3ReadOptions>().layout);
  result.undone = transfers.undone;
  if (!transfers.left.empty() && !result.damage.empty()) result.damage.insert(result.damage.begin(), transfers.left);
  return result;
}

}  // namespace slamdb::detail
