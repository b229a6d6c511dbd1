// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/salvage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/decoder.h"
#include "slamdb/formats/orbslam3/detail/encoder.h"
#include "slamdb/formats/orbslam3/detail/pointer_search.h"
#include "slamdb/formats/orbslam3/detail/pointers.h"
#include "slamdb/formats/orbslam3/detail/skipper.h"
#include "slamdb/formats/orbslam3/detail/transfer.h"

namespace slamdb::orbslam3 {
namespace {

constexpr std::size_t kLeastObjectBytes = 64;  // takes less than any object
constexpr std::size_t kLeastListedBytes = 32;  // and less than an object and its pointer, cameras too
constexpr std::size_t kTruncationBytes = 64;   // failing so close to the end is because of the end
constexpr std::size_t kMostBehindNoMaps = 4096;
constexpr std::size_t kMostTries = 1'000'000;  // places that only look like an object: seconds, in files made for it

// The class table behind a keyframe that has everything that ORB-SLAM3 gives it.
ClassTable TableBehindKeyFrame(const ClassTable& in_front, bool measurements) {
  KeyFrame usual;
  usual.features.bag_of_words = {{0}, {1}};
  usual.features.feature_vector = {{0}, {1}, {0}};
  usual.features.grid = {{1}, {1}, {0}};
  usual.connections.push_back({KeyFrameId(0), 1});
  if (measurements) usual.preintegration.measurements.resize(1);
  Encoder<NoOutput> encoder(NoOutput(), in_front);
  LayoutKeyFrame(encoder, static_cast<const KeyFrame&>(usual));
  return encoder.classes;
}

// What the class table may be behind an object that could not be read: all classes of a first keyframe, and those of
// IMU measurements when it had any.
std::vector<ClassTable> TablesBehind(ClassTable classes, WireClass wire_class) {
  const bool first = classes.FirstUse(wire_class);
  std::vector<ClassTable> tables{classes};
  if (wire_class != WireClass::kKeyFrame) return tables;
  if (first) tables = {TableBehindKeyFrame(classes, false), TableBehindKeyFrame(classes, true)};
  ClassTable met_later = tables.front();
  if (met_later.FirstUse(WireClass::kMeasurement)) tables.push_back(met_later);
  return tables;
}

// The class table in front of the keyframes of the first map.
ClassTable TableOfFirstMap(const ArchiveEncoding& encoding) {
  ClassTable classes(encoding);
  classes.FirstUse(WireClass::kAtlas);
  classes.Register(WireClass::kPinhole);
  classes.Register(WireClass::kKannalaBrandt8);
  classes.FirstUse(WireClass::kMapList);
  classes.FirstUse(WireClass::kMap);
  return classes;
}

// What an archive is like whose header is damaged: as ORB-SLAM3 writes it on 64-bit Linux, text when its middle is.
ArchiveHeader UsualHeader(std::string_view file) {
  ArchiveHeader header;
  const std::string_view middle = file.substr(file.size() / 2, 4096);
  header.encoding.text =
      std::all_of(middle.begin(), middle.end(), [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); });
  header.bytes = WriteArchiveHeader(header.encoding).size();
  return header;
}

// Whether what was read can be an object that is whole. It stands alone for those behind which nothing is.
bool Holds(const Flag& flag) { return flag.recorded <= 1; }

bool LooksWhole(const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  const auto count = static_cast<std::size_t>(std::max(features.count, 0));
  const std::size_t left = features.is_fisheye_stereo() ? static_cast<std::size_t>(features.left_count) : count;
  const auto levels = static_cast<std::size_t>(std::max(keyframe.pyramid.levels, 0));
  const auto columns = static_cast<std::size_t>(std::max(keyframe.bounds.grid_columns, 0));
  return features.keypoints.size() == left && features.undistorted.size() == left &&
         features.descriptors.size() == count && features.map_points.size() == count &&
         keyframe.pyramid.factors.size() == levels && features.grid.column_sizes.size() == columns &&
         std::abs(keyframe.camera_from_world.rotation.norm() - 1) < 0.01F && Holds(keyframe.first_connection) &&
         Holds(keyframe.not_erase) && Holds(keyframe.to_be_erased) && Holds(keyframe.bad) &&
         Holds(keyframe.imu_initialized) && Holds(keyframe.has_velocity) && Holds(keyframe.imu_calibration.is_set);
}

bool LooksWhole(const MapPoint& point) {
  const auto paired = [](const Observation& observation) {
    return observation.left != Observation::kAbsent && observation.right != Observation::kAbsent;
  };
  return point.has_descriptor() && Holds(point.bad) && point.position.allFinite() && point.normal.allFinite() &&
         point.min_distance <= point.max_distance && std::isfinite(point.max_distance) &&
         std::ranges::all_of(point.observations, paired) &&
         std::ranges::is_sorted(point.observations, {}, &Observation::keyframe);
}

bool LooksWhole(const Camera& camera) {
  const std::size_t parameters = camera.model == CameraModel::kPinhole ? 4 : 8;
  const std::uint32_t type = camera.model == CameraModel::kPinhole ? 0 : 1;
  const auto fits = [](float value) { return std::abs(value) < 1e6F; };  // no NaN either
  return camera.recorded_type == type && camera.parameters.size() == parameters &&
         std::ranges::all_of(camera.parameters, fits) && camera.parameters[0] > 1e-3F && camera.parameters[1] > 1e-3F;
}

// Of the members behind the lists of a map.
bool LooksWhole(const Map& tail, std::uint64_t largest_keyframe) {
  const auto fits = [&](KeyFrameId id) { return id.value() <= largest_keyframe; };
  return std::ranges::all_of(tail.origins, fits) && fits(tail.first_keyframe) && fits(tail.lowest_keyframe) &&
         Holds(tail.imu_initialized) && Holds(tail.inertial) && Holds(tail.imu_ba1) && Holds(tail.imu_ba2);
}

// A list of objects of one class, as the archive holds it.
template <class Entity>
struct ListKind;
template <>
struct ListKind<KeyFrame> {
  static constexpr WireClass kList = WireClass::kKeyFrameList, kEntity = WireClass::kKeyFrame;
  static constexpr const char* kName = "kf";
  template <class Archive>
  static void Layout(Archive& archive, KeyFrame& keyframe) {
    LayoutKeyFrame(archive, keyframe);
  }
};
template <>
struct ListKind<MapPoint> {
  static constexpr WireClass kList = WireClass::kMapPointList, kEntity = WireClass::kMapPoint;
  static constexpr const char* kName = "mp";
  template <class Archive>
  static void Layout(Archive& archive, MapPoint& point) {
    LayoutMapPoint(archive, point);
  }
};

// Reads on where an object stands; behind damage, at the next object that is whole.
template <class Input>
class Salvager {
  using Search = std::conditional_t<Input::kText, TextSearch, BinarySearch>;

 public:
  Salvager(detail::FileStream& file, const ArchiveHeader& header)
      : file_(file.data(), file.size()),
        most_objects_(static_cast<std::uint32_t>(file.size() / kLeastObjectBytes)),
        at_(Input(&file, header.encoding), ClassTable(header.encoding), FeatureColumns::kAll) {
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
  // Where an object stands that is whole, and what the class table is there.
  struct Found {
    Sighting at;
    ClassTable classes;
  };
  enum class Behind { kNothing, kMap, kKeyFrames };

  void Note(const Error& error) {
    salvage_.damage.push_back((error.place().empty() ? "" : error.place() + ": ") + error.problem());
  }
  // The cursor, for a look that notes nothing.
  Input Silent() const {
    Input input = at_.input;
    input.Tolerate(nullptr);
    return input;
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
    if (usual_tables_.empty()) usual_tables_ = TablesBehindKeyFrames();
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
    if (salvage_.lost_beginning && Fits([this](auto& skipper) { PassMapPointer(skipper); })) ++salvage_.maps_listed;
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
    const std::optional<Found> map = FindMap(from);
    const std::optional<Found> keyframe = FindWhole<KeyFrame>(most_objects_, from, map ? map->at.offset : file_.size());
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
          if (!Fits([this](auto& skipper) { TakePointer(skipper, objects_, {Kind::kEntity}); }))
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
      if (!sought_map_ || (next_map_ && next_map_->at.offset < offset)) next_map_ = FindMap(offset);
      sought_map_ = true;
      if (next_map_) end = next_map_->at.offset;
    }
    const std::optional<Found> found = FindWhole<Entity>(object_behind_, offset, end);
    if (!found) return false;
    position += found->at.object - objects_.next();
    GoTo(*found);
    return true;
  }

  void GoTo(const Found& found) {
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
      return Fits([this](auto& skipper) { PassListBegin(skipper, WireClass::kMapPointList, {WireClass::kMapPoint}); });
    else
      return Fits([this](auto& skipper) { PassMapTail(skipper); });
  }

  // Counts objects that are lost.
  void SkipObjects(std::uint32_t next) {
    while (objects_.next() < next) objects_.Add(WireClass::kCount, 0, objects_.next());
  }

  // ---- Looking for objects

  // What the class table is behind the first keyframe, whose list begins at the cursor.
  std::vector<ClassTable> TablesBehindKeyFrames() const {
    ClassTable classes = at_.classes;
    classes.FirstUse(WireClass::kKeyFrameList);
    return TablesBehind(classes, WireClass::kKeyFrame);
  }

  // What the class table may be at an object behind damage: as it was in front, or with what keyframes usually bring,
  // and what the archive has had by then.
  std::vector<ClassTable> TablesAt(WireClass wire_class) const {
    std::vector<ClassTable> tables{at_.classes};
    const auto add = [&](const ClassTable& table) {
      if (std::ranges::find(tables, table) == tables.end()) tables.push_back(table);
    };
    for (const ClassTable& table : TablesBehind(at_.classes, wire_class)) add(table);
    for (ClassTable table : usual_tables_) {
      add(table);
      table.FirstUse(WireClass::kMapPointList);
      add(table);
      table.FirstUse(WireClass::kMapPoint);
      add(table);
    }
    if (wire_class != WireClass::kMapPoint) return tables;
    for (ClassTable table : std::vector(tables)) {  // the first point may be the one that is lost
      table.FirstUse(WireClass::kMapPointList);
      table.FirstUse(WireClass::kMapPoint);
      add(table);
    }
    return tables;
  }

  // The next object, before `behind` and before the byte `end`, whose record is whole and has the next pointer behind
  // it, or looks whole where that is lost.
  template <class Entity>
  std::optional<Found> FindWhole(std::uint32_t behind, std::size_t offset, std::size_t end) {
    std::optional<Found> best;
    if (objects_.next() >= behind) return best;
    for (const ClassTable& classes : TablesAt(ListKind<Entity>::kEntity)) {
      const Search search = SearchUpTo(end, {classes, ListKind<Entity>::kEntity, objects_.next(), behind - 1});
      for (auto found = search.Next(offset); found && tries_ < kMostTries;
           found = search.Next(found->offset + 1), ++tries_) {
        if (!IsWhole<Entity>(*found, classes, behind)) continue;
        best = Found{*found, classes};
        end = found->offset;
        break;
      }
    }
    return best;
  }

  Search SearchUpTo(std::size_t end, const PointerPattern& pattern) const {
    return Search(file_.substr(0, end), pattern);
  }

  template <class Entity>
  bool IsWhole(const Sighting& found, const ClassTable& classes, std::uint32_t behind) const {
    using Kind = ListKind<Entity>;
    try {
      Skipper<Input> skipper(Silent(), classes);
      skipper.input.Seek(found.offset);
      Entity entity;
      PassPointer(skipper, Kind::kEntity);
      Kind::Layout(skipper, entity);
      if (found.object + 1 == behind || NextStands(skipper, Kind::kEntity, found.object + 1)) return true;
      Decoder<Input> decoder(Silent(), classes, FeatureColumns::kAll);
      decoder.input.Seek(found.offset);
      PassPointer(decoder, Kind::kEntity);
      Kind::Layout(decoder, entity);
      return LooksWhole(entity);
    } catch (const Error&) {  // it only looked like one
      return false;
    }
  }

  // Passes the pointer to a new object; returns its number. Throws Error when it is of another class.
  template <class Archive>
  static std::uint32_t PassPointer(Archive& archive, WireClass wire_class) {
    if (archive.input.template Take<std::int16_t>() != archive.classes.Register(wire_class))
      archive.input.Fail("another class");
    archive.TakeClassInfo(wire_class, /*tracking=*/1);
    return archive.input.template Take<std::uint32_t>();
  }
  static bool NextStands(Skipper<Input>& skipper, WireClass wire_class, std::uint32_t object) {
    try {
      return PassPointer(skipper, wire_class) == object;
    } catch (const Error&) {
      return false;
    }
  }

  // The next map whose head is whole and has its first keyframe behind it.
  std::optional<Found> FindMap(std::size_t offset) {
    std::optional<Found> best;
    std::size_t end = file_.size();
    for (ClassTable classes : TablesAt(WireClass::kMap)) {
      classes.FirstUse(WireClass::kMap);
      classes.FirstUse(WireClass::kKeyFrameList);
      const Search search = SearchUpTo(end, {classes, WireClass::kMap, objects_.next(), most_objects_});
      for (auto found = search.Next(offset); found && tries_ < kMostTries;
           found = search.Next(found->offset + 1), ++tries_) {
        if (!IsHeadOfMap(*found, classes)) continue;
        best = Found{*found, classes};
        end = found->offset;
        break;
      }
    }
    return best;
  }

  bool IsHeadOfMap(const Sighting& found, const ClassTable& classes) const {
    constexpr std::uint64_t kLargestId = std::numeric_limits<std::int32_t>::max();
    try {
      Decoder<Input> decoder(Silent(), classes, FeatureColumns::kNone);
      decoder.input.Seek(found.offset);
      PassPointer(decoder, WireClass::kMap);
      Map map;
      LayoutMapHead(decoder, map);
      return map.id.value() <= kLargestId && map.initial_keyframe.value() <= kLargestId &&
             map.max_keyframe_id <= kLargestId && decoder.ClassCount(WireClass::kKeyFrameList, 2, 1) > 0 &&
             PassPointer(decoder, WireClass::kKeyFrame) == found.object + 1;
    } catch (const Error&) {
      return false;
    }
  }

  void PassMapPointer(Skipper<Input>& skipper) { TakePointer(skipper, objects_, {WireClass::kMap}); }
  // Zeros look like an empty list, so what follows one must stand too.
  void PassListBegin(Skipper<Input>& skipper, WireClass list_class, std::initializer_list<WireClass> classes) const {
    if (skipper.ClassCount(list_class, 2, 1) > 0)
      TakePointer(skipper, objects_, classes);
    else if (list_class == WireClass::kMapPointList)
      PassMapTail(skipper);
    else if (list_class == WireClass::kCameraList)
      PassCounters(skipper);
  }
  // The members of a map behind its lists, and what must follow.
  void PassMapTail(Skipper<Input>& skipper) const {
    Map nothing;
    LayoutMapTail(skipper, nothing);
    Skipper<Input> cameras = skipper;
    try {
      PassListBegin(cameras, WireClass::kCameraList, kCameraClasses);
    } catch (const Error&) {
      TakePointer(skipper, objects_, {WireClass::kMap});
    }
  }
  static void PassCounters(Skipper<Input>& skipper) {
    Counters nothing;
    LayoutCounters(skipper, nothing);
    if (!skipper.input.AtEnd()) skipper.input.Fail("an empty list, and behind it not what must follow");
  }

  // Whether what must follow does, without moving there; tells when not.
  bool MapStandsHere() {
    return Stands([this](auto& skipper) { PassMapPointer(skipper); });
  }
  bool ListBeginsHere(WireClass list_class, std::initializer_list<WireClass> classes) {
    return Stands([&](auto& skipper) { PassListBegin(skipper, list_class, classes); });
  }
  template <class Pass>
  bool Stands(const Pass& pass) {
    const std::optional<Error> error = WhyNot(pass);
    if (error) Note(*error);
    return !error;
  }
  template <class Pass>
  bool Fits(const Pass& pass) const {
    return !WhyNot(pass);
  }
  template <class Pass>
  std::optional<Error> WhyNot(const Pass& pass) const {
    try {
      Skipper<Input> skipper(Silent(), at_.classes);
      pass(skipper);
      return std::nullopt;
    } catch (const Error& error) {
      return error;
    }
  }

  // Moves to the head of the list of a class behind the list that was read last. Where the class stands in the archive
  // for the first time, its looks are enough, and the number of objects in between may have been read wrongly.
  // A class that the first keyframes may not have shown (IMU measurements) counts as met or not, whichever fits.
  bool SeekList(WireClass list_class, WireClass wire_class) {
    for (ClassTable classes : TablesAt(WireClass::kKeyFrame)) {
      const ClassTable before = classes;
      const bool list_with_info = classes.FirstUse(list_class);
      PointerPattern pattern(classes, wire_class, objects_.next(), std::max(objects_.next(), object_behind_));
      if (pattern.with_info) pattern.last = most_objects_;
      const auto found = Search(file_, pattern).Next(at_.input.offset());
      if (!found) continue;
      const std::size_t begin =
          Search::ListBegin(file_, found->offset, list_with_info, at_.input.encoding().size_bytes);
      if (!IsHeadOfList(list_class, begin, found->offset, before)) continue;
      SkipObjects(found->object);
      at_.classes = before;
      at_.input.Seek(begin);
      return true;
    }
    return false;
  }

  // Whether a count stands there that the rest of the file can hold, up to the first object.
  bool IsHeadOfList(WireClass list_class, std::size_t begin, std::size_t first, const ClassTable& classes) const {
    try {
      Skipper<Input> skipper(Silent(), classes);
      skipper.input.Seek(begin);
      const std::uint64_t count = skipper.ClassCount(list_class, Input::kText ? 2 : kLeastListedBytes, 4);
      return count > 0 && skipper.input.offset() + (Input::kText ? 1 : 0) >= first;
    } catch (const Error&) {
      return false;
    }
  }

  // ---- The end

  // `stands`: the list begins at the cursor. Returns whether the cursor is behind all of it.
  bool ReadCameras(bool stands) {
    constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();
    at_.input.place = {.field = "mvpCameras"};
    std::uint64_t listed = kUnknown;
    if (stands) stands = Try([&] { listed = at_.ClassCount(WireClass::kCameraList, 2, 1); });
    for (std::uint64_t position = 0; position < listed; ++position) {
      if (stands && listed == kUnknown && Fits([](auto& skipper) { PassCounters(skipper); })) return true;
      if (stands) stands = Try([&] { ReadCamera(position); });
      if (stands) continue;
      const std::optional<Found> found = FindCamera(at_.input.offset());
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

  static Camera CameraOf(WireClass wire_class) {
    return {.model = wire_class == WireClass::kPinhole ? CameraModel::kPinhole : CameraModel::kKannalaBrandt8};
  }

  std::optional<Found> FindCamera(std::size_t offset) {
    std::optional<Found> best;
    std::size_t end = file_.size();
    for (const WireClass wire_class : kCameraClasses)
      for (const bool first_of_class : {false, true})
        for (const bool first_of_all : {false, true}) {
          ClassTable classes = at_.classes;
          if (!first_of_class) classes.FirstUse(wire_class);
          if (!first_of_all) classes.FirstUse(WireClass::kGeometricCamera);
          const Search search = SearchUpTo(end, {classes, wire_class, objects_.next(), most_objects_});
          for (auto found = search.Next(offset); found && tries_ < kMostTries;
               found = search.Next(found->offset + 1), ++tries_) {
            if (!IsCamera(*found, wire_class, classes)) continue;
            best = Found{*found, classes};
            end = found->offset;
            break;
          }
        }
    return best;
  }

  bool IsCamera(const Sighting& found, WireClass wire_class, const ClassTable& classes) const {
    try {
      Decoder<Input> decoder(Silent(), classes, FeatureColumns::kNone);
      decoder.input.Seek(found.offset);
      PassPointer(decoder, wire_class);
      Camera camera = CameraOf(wire_class);
      LayoutCamera(decoder, camera);
      return LooksWhole(camera);
    } catch (const Error&) {
      return false;
    }
  }

  // `stand`: at the cursor. Otherwise they are the last numbers of the file, when they are above what was read.
  void ReadCounters(bool stand) {
    at_.input.place = {};
    Counters counters;
    if (stand) stand = Try([&] { LayoutCounters(at_, counters); });
    if (!stand) {
      at_.input.Seek(Search::LastNumbers(file_, 6, at_.input.encoding().long_bytes));
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

  static constexpr std::initializer_list<WireClass> kCameraClasses{WireClass::kPinhole, WireClass::kKannalaBrandt8};

  std::string_view file_;
  Salvage salvage_;
  ObjectTable objects_;
  std::size_t tries_ = 0;  // in vain
  const std::uint32_t most_objects_;
  std::uint32_t object_behind_ = 0;  // behind the last object of the list that was read last
  bool sought_map_ = false;
  std::optional<Found> next_map_;         // behind the list whose head is lost
  std::vector<ClassTable> usual_tables_;  // behind the keyframes of the first map
  Decoder<Input> at_;
};

}  // namespace
}  // namespace slamdb::orbslam3

namespace slamdb::detail {

namespace {

Salvage SalvageBytesOf(Bytes bytes, const std::string& path) {
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
  if (header_error) header = orbslam3::UsualHeader({file.data(), file.size()});
  const Error* why = header_error ? &*header_error : nullptr;
  if (header.encoding.text) return orbslam3::Salvager<orbslam3::TextInput>(file, header).Run(why);
  return orbslam3::Salvager<orbslam3::BinaryInput>(file, header).Run(why);
}

}  // namespace

Salvage SalvageOrbslam3(const Source& source, const ReadOptions&) {
  std::optional<WholeFile> file(source);
  orbslam3::Transfers transfers;
  if (orbslam3::SniffArchive(file->text()) == false) transfers = orbslam3::FindTransfers(file->text());
  if (!transfers.undone.empty()) file.reset();
  Salvage result = SalvageBytesOf(file ? file->bytes() : std::as_bytes(std::span(transfers.bytes)), source.path);
  result.undone = transfers.undone;
  if (!transfers.left.empty() && !result.damage.empty()) result.damage.insert(result.damage.begin(), transfers.left);
  return result;
}

}  // namespace slamdb::detail
