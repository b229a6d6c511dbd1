// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/salvage.h"

#include <algorithm>
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

template <class Input>
class Salvager {
  using Search = std::conditional_t<Input::kText, TextSearch, BinarySearch>;

 public:
  Salvager(detail::FileStream& file, const ArchiveHeader& header)
      : file_(file.data(), file.size()),
        at_(Input(&file, header.encoding), ClassTable(header.encoding), FeatureColumns::kAll) {
    salvage_.atlas.encoding = header.encoding;
    at_.input.Seek(header.bytes);
  }

  // `header_error`: why the header was not read; null: it was.
  Salvage Run(const Error* header_error) {
    if (header_error != nullptr) Note(*header_error);
    salvage_.lost_beginning = !ReadBeginning();
    if (salvage_.lost_beginning) GoToFirstMap();
    try {
      if (ReadMaps()) ReadCameras();
    } catch (const Error& error) {
      Note(error);
    }
    for (std::size_t row = 0; row < salvage_.maps.size(); ++row) {
      salvage_.maps[row].keyframes.read = salvage_.atlas.maps[row].keyframes.size();
      salvage_.maps[row].points.read = salvage_.atlas.maps[row].points.size();
    }
    return std::move(salvage_);
  }

 private:
  void Note(const Error& error) {
    salvage_.damage.push_back((error.place().empty() ? "" : error.place() + ": ") + error.problem());
  }
  bool AtEndOfFile() const { return at_.input.remaining() < kTruncationBytes; }

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

  // Returns whether the cursor stands behind the maps.
  bool ReadMaps() {
    for (std::uint64_t position = 0; position < salvage_.maps_listed; ++position) {
      at_.input.place = {.map = static_cast<std::int64_t>(position)};
      const bool lost_head = salvage_.lost_beginning && position == 0;
      const Pointer pointer = lost_head ? Pointer{Pointer::Kind::kNew} : TakePointer(at_, objects_, {WireClass::kMap});
      if (pointer.kind != Pointer::Kind::kNew) {
        salvage_.atlas.repeated_maps.push_back(Repeated(at_, objects_, pointer, position));
        continue;
      }
      const auto row = static_cast<std::uint32_t>(salvage_.atlas.maps.size());
      objects_.Add(WireClass::kMap, 0, row);
      if (!ReadMap(salvage_.atlas.maps.emplace_back(), salvage_.maps.emplace_back(), row, lost_head) &&
          !SeekBehindMap())
        return false;
    }
    at_.input.place = {};
    return true;
  }

  // Returns whether the cursor stands behind the map.
  bool ReadMap(Map& map, SalvagedMap& read, std::uint32_t row, bool lost_head) {
    if (!lost_head) LayoutMapHead(at_, map);
    const bool reached_end = ReadList(WireClass::kKeyFrameList, WireClass::kKeyFrame, "kf", row, map.keyframes,
                                      map.repeated_keyframes, read.keyframes, lost_head,
                                      [](auto& archive, KeyFrame& keyframe) { LayoutKeyFrame(archive, keyframe); });
    if (lost_head) map.id = MapId(map.keyframes.empty() ? 0 : map.keyframes.front().origin_map);
    read.id = map.id;
    if (!reached_end || !ListBeginsHere(WireClass::kMapPointList, {WireClass::kMapPoint})) {
      if (reached_end && !AtEndOfFile() && !map.keyframes.empty()) map.keyframes.pop_back();
      if (!SeekList(WireClass::kMapPointList, WireClass::kMapPoint)) return false;
    }
    if (!ReadList(WireClass::kMapPointList, WireClass::kMapPoint, "mp", row, map.points, map.repeated_points,
                  read.points, false, [](auto& archive, MapPoint& point) { LayoutMapPoint(archive, point); }))
      return false;
    return ReadMapTail(map);
  }

  bool IsLastMap() const {
    return salvage_.atlas.maps.size() + salvage_.atlas.repeated_maps.size() == salvage_.maps_listed;
  }

  // The members behind the lists; they count when what follows them is where it must be.
  bool ReadMapTail(Map& map) {
    Map whole;
    try {
      LayoutMapTail(at_, whole);
    } catch (const Error& error) {
      Note(error);
      return false;
    }
    if (salvage_.lost_beginning && Fits([this](auto& skipper) { PassMapPointer(skipper); })) ++salvage_.maps_listed;
    if (IsLastMap() ? !AtEndOfFile() && !ListBeginsHere(WireClass::kCameraList, kCameraClasses) : !MapStandsHere())
      return false;
    map.origins = std::move(whole.origins);
    map.first_keyframe = whole.first_keyframe;
    map.lowest_keyframe = whole.lowest_keyframe;
    map.imu_initialized = whole.imu_initialized;
    map.inertial = whole.inertial;
    map.imu_ba1 = whole.imu_ba1;
    map.imu_ba2 = whole.imu_ba2;
    return true;
  }

  // Reads a list from its head on, over damaged stretches. Returns whether it came to the list's end. Where the head is
  // lost, with the number of the objects, it ends where points begin.
  template <class Entity, class Layout>
  bool ReadList(WireClass list_class, WireClass wire_class, const char* name, std::uint32_t row, Column<Entity>& list,
                std::vector<RepeatedEntry>& repeated, SalvagedList& read, bool lost_head, const Layout& layout) {
    std::size_t begin = at_.input.offset(), begin_before = begin;
    object_behind_ = objects_.next();
    bool doubtful = false;  // the entity in front: what follows it has not been seen
    std::uint64_t position = 0;
    if (!BeginList<Entity>(list_class, wire_class, lost_head, layout, read, position)) return false;
    while (position < read.listed) {
      const ClassTable classes = at_.classes;
      at_.input.place = {.map = at_.input.place.map, .entity = name, .ordinal = position, .of = read.listed};
      begin = at_.input.offset();
      try {
        const Pointer pointer = TakePointer(at_, objects_, {wire_class});
        doubtful = false;
        if (pointer.kind != Pointer::Kind::kNew) {
          repeated.push_back(Repeated(at_, objects_, pointer, position++));
          continue;
        }
        Entity entity;
        layout(at_, entity);
        objects_.Add(wire_class, row, list.size());
        list.push_back(std::move(entity));
        begin_before = begin;
        doubtful = true;
        ++position;
      } catch (const Error& error) {
        if (lost_head && EndsAt(begin, classes)) {
          read.listed = position;
          break;
        }
        Note(error);
        if (doubtful && !AtEndOfFile()) {
          list.pop_back();
          begin = begin_before;
        }
        doubtful = false;
        if (!Resume<Entity>(TablesBehind(classes, wire_class), wire_class, begin + 1, layout, position)) {
          at_.classes = TablesBehind(classes, wire_class).front();
          if (lost_head) read.listed = position;
          return false;
        }
      }
    }
    at_.input.place.entity = nullptr;
    return true;
  }

  // Reads the head of a list; where it is lost, moves to the list's first whole object.
  template <class Entity, class Layout>
  bool BeginList(WireClass list_class, WireClass wire_class, bool lost_head, const Layout& layout, SalvagedList& read,
                 std::uint64_t& position) {
    if (!lost_head) {
      try {
        read.listed = at_.ClassCount(list_class, 2, 1);
      } catch (const Error& error) {
        Note(error);
        return false;
      }
      object_behind_ += static_cast<std::uint32_t>(read.listed);
      return true;
    }
    at_.classes.FirstUse(list_class);
    read.listed = file_.size() / kLeastObjectBytes;
    object_behind_ += static_cast<std::uint32_t>(read.listed);
    const std::size_t begin = at_.input.offset();
    if (Resume<Entity>({at_.classes}, wire_class, begin, layout, position) ||
        Resume<Entity>(TablesBehind(at_.classes, wire_class), wire_class, begin, layout, position))
      return true;
    read.listed = 0;
    return false;
  }

  // Moves the cursor to the next whole object of the list, with the first class table in which there is one.
  template <class Entity, class Layout>
  bool Resume(const std::vector<ClassTable>& tables, WireClass wire_class, std::size_t offset, const Layout& layout,
              std::uint64_t& position) {
    const ClassTable before = at_.classes;
    for (const ClassTable& table : tables) {
      at_.classes = table;
      if (const auto found = FindWhole<Entity>(wire_class, offset, layout)) {
        position += found->object - objects_.next();
        SkipObjects(found->object);
        at_.input.Seek(found->offset);
        return true;
      }
    }
    at_.classes = before;
    return false;
  }

  // Whether a list of keyframes ends there; moves there.
  bool EndsAt(std::size_t offset, const ClassTable& classes) {
    at_.classes = classes;
    at_.input.Seek(offset);
    return Fits([this](auto& skipper) { PassListBegin(skipper, WireClass::kMapPointList, {WireClass::kMapPoint}); });
  }

  // Counts objects that are lost.
  void SkipObjects(std::uint32_t next) {
    while (objects_.next() < next) objects_.Add(WireClass::kCount, 0, objects_.next());
  }

  // The next object of the list that was read last whose record is whole and has the next pointer behind it.
  template <class Entity, class Layout>
  std::optional<Sighting> FindWhole(WireClass wire_class, std::size_t offset, const Layout& layout) {
    if (objects_.next() >= object_behind_) return std::nullopt;
    const Search search(file_, PointerPattern(at_.classes, wire_class, objects_.next(), object_behind_ - 1));
    for (auto found = search.Next(offset); found && tries_ < kMostTries;
         found = search.Next(found->offset + 1), ++tries_) {
      Skipper<Input> skipper(at_.input, at_.classes);
      skipper.input.Seek(found->offset);
      try {
        Entity nothing;
        SkipPointer(skipper, wire_class);
        layout(skipper, nothing);
        const bool last = found->object + 1 == object_behind_;
        if (last || SkipPointer(skipper, wire_class) == found->object + 1) return found;
      } catch (const Error&) {  // it only looked like one
      }
    }
    return std::nullopt;
  }

  // Passes the pointer to a new object; returns its number. Throws Error when it is of another class.
  static std::uint32_t SkipPointer(Skipper<Input>& skipper, WireClass wire_class) {
    if (skipper.input.template Take<std::int16_t>() != skipper.classes.Register(wire_class))
      skipper.input.Fail("another class");
    skipper.ClassInfo(wire_class);
    return skipper.input.template Take<std::uint32_t>();
  }

  void PassMapPointer(Skipper<Input>& skipper) { TakePointer(skipper, objects_, {WireClass::kMap}); }
  void PassListBegin(Skipper<Input>& skipper, WireClass list_class, std::initializer_list<WireClass> classes) {
    if (skipper.ClassCount(list_class, 2, 1) > 0) TakePointer(skipper, objects_, classes);
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
      Skipper<Input> skipper(at_.input, at_.classes);
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
    ClassTable with_measurements = at_.classes;
    with_measurements.FirstUse(WireClass::kMeasurement);
    for (ClassTable classes : {at_.classes, with_measurements}) {
      const ClassTable before = classes;
      const bool list_with_info = classes.FirstUse(list_class);
      PointerPattern pattern(classes, wire_class, objects_.next(), object_behind_);
      if (pattern.with_info) pattern.last = static_cast<std::uint32_t>(file_.size() / kLeastObjectBytes);
      const auto found = Search(file_, pattern).Next(at_.input.offset());
      if (!found) continue;
      SkipObjects(found->object);
      at_.classes = before;
      at_.input.Seek(Search::ListBegin(file_, found->offset, list_with_info, at_.input.encoding().size_bytes));
      return true;
    }
    return false;
  }

  bool SeekBehindMap() {
    if (IsLastMap())
      return SeekList(WireClass::kCameraList, WireClass::kPinhole) ||
             SeekList(WireClass::kCameraList, WireClass::kKannalaBrandt8);
    const PointerPattern pattern(at_.classes, WireClass::kMap, objects_.next(), object_behind_);
    const auto found = Search(file_, pattern).Next(at_.input.offset());
    if (!found) return false;
    SkipObjects(found->object);
    at_.input.Seek(found->offset);
    return true;
  }

  // And the counters behind them.
  void ReadCameras() {
    at_.input.place.field = "mvpCameras";
    const std::uint64_t count = at_.ClassCount(WireClass::kCameraList, 2, 1);
    for (std::uint64_t position = 0; position < count; ++position) {
      const Pointer pointer = TakePointer(at_, objects_, kCameraClasses);
      if (pointer.kind != Pointer::Kind::kNew) {
        salvage_.atlas.repeated_cameras.push_back(Repeated(at_, objects_, pointer, position));
        continue;
      }
      objects_.Add(pointer.wire_class, 0, salvage_.atlas.cameras.size());
      Camera camera{.model = pointer.wire_class == WireClass::kPinhole ? CameraModel::kPinhole
                                                                       : CameraModel::kKannalaBrandt8};
      LayoutCamera(at_, camera);
      salvage_.atlas.cameras.push_back(std::move(camera));
    }
    at_.input.place = {};
    LayoutCounters(at_, salvage_.atlas.next_ids);
  }

  static constexpr std::initializer_list<WireClass> kCameraClasses{WireClass::kPinhole, WireClass::kKannalaBrandt8};

  std::string_view file_;
  Salvage salvage_;
  ObjectTable objects_;
  std::size_t tries_ = 0;            // in vain
  std::uint32_t object_behind_ = 0;  // behind the last object of the list that was read last
  Decoder<Input> at_;
};

}  // namespace
}  // namespace slamdb::orbslam3

namespace slamdb::detail {

namespace {

Salvage SalvageBytesOf(const Source& source) {
  detail::FileStream file(source);
  Notices notices;
  orbslam3::ArchiveHeader header;
  std::optional<Error> header_error;
  try {
    header = orbslam3::ReadArchiveHeader(file, notices);
  } catch (const Error& error) {
    if (file.size() == 0) throw;
    header_error = error;
  }
  file.FillTo(file.size());
  if (header_error) header = orbslam3::UsualHeader({file.data(), file.size()});
  const Error* why = header_error ? &*header_error : nullptr;
  if (header.encoding.text) return orbslam3::Salvager<orbslam3::TextInput>(file, header).Run(why);
  return orbslam3::Salvager<orbslam3::BinaryInput>(file, header).Run(why);
}

}  // namespace

Salvage SalvageOrbslam3(const Source& source, const ReadOptions&) {
  std::optional<orbslam3::Transfer> transfer;
  std::string before;
  {
    const WholeFile file(source);
    if (orbslam3::SniffArchive(file.text()) == false) transfer = orbslam3::FindTransfer(file.text());
    if (transfer && orbslam3::CanUndo(*transfer)) before = orbslam3::Undo(*transfer, file.text());
  }
  if (before.empty()) return SalvageBytesOf(source);
  Salvage salvage = SalvageBytesOf({std::as_bytes(std::span(before)), source.path});
  salvage.undone = orbslam3::SentenceOf(*transfer);
  return salvage;
}

}  // namespace slamdb::detail
