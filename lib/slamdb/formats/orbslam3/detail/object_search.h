// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/lookahead.h"
#include "slamdb/formats/orbslam3/detail/looks_whole.h"
#include "slamdb/formats/orbslam3/detail/pointer_search.h"
#include "slamdb/formats/orbslam3/detail/usual_classes.h"

// Finds what stands behind damage: objects that are whole, and lists.
namespace slamdb::orbslam3 {

inline constexpr std::size_t kLeastListedBytes = 32;  // takes less than an object and its pointer, cameras too
inline constexpr std::size_t kMostTries = 1'000'000;  // places that only look like an object: seconds, in files made
                                                      // for it

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

inline Camera CameraOf(WireClass wire_class) {
  return {.model = wire_class == WireClass::kPinhole ? CameraModel::kPinhole : CameraModel::kKannalaBrandt8};
}

// Where an object stands that is whole, and what the class table is there.
struct FoundObject {
  Sighting at;
  ClassTable classes;
};

// Where the head of a list stands, what the class table is there, and the number of its first object.
struct FoundList {
  std::size_t begin = 0;
  std::uint32_t first_object = 0;
  ClassTable classes;
};

// Sightings are by class table: each that may be there is tried, and the nearest object counts.
template <class Input>
class ObjectSearch {
  using Search = std::conditional_t<Input::kText, TextSearch, BinarySearch>;

 public:
  // In a file that is read by `at`, which has brought `objects`.
  ObjectSearch(std::string_view file, const Decoder<Input>& at, const ObjectTable& objects, std::uint32_t most_objects)
      : file_(file), at_(at), objects_(objects), most_objects_(most_objects) {}

  // Keeps what the class table is behind the first keyframe of the first map, whose list begins at the cursor.
  void LearnUsualTables() {
    if (!usual_tables_.empty()) return;
    ClassTable classes = at_.classes;
    classes.FirstUse(WireClass::kKeyFrameList);
    usual_tables_ = TablesBehind(classes, WireClass::kKeyFrame);
  }

  // The next object, before `behind` and before the byte `end`, whose record is whole and has the next pointer behind
  // it, or looks whole where that is lost.
  template <class Entity>
  std::optional<FoundObject> FindWhole(std::uint32_t behind, std::size_t offset, std::size_t end) {
    std::optional<FoundObject> best;
    if (objects_.next() >= behind) return best;
    for (const ClassTable& classes : TablesAt(ListKind<Entity>::kEntity)) {
      const PointerPattern pattern(classes, ListKind<Entity>::kEntity, objects_.next(), behind - 1);
      const auto is_whole = [&](const Sighting& found) { return IsWhole<Entity>(found, classes, behind); };
      Better(best, end, classes, First(pattern, offset, end, is_whole));
    }
    return best;
  }

  // The next map whose head is whole and has its first keyframe behind it.
  std::optional<FoundObject> FindMap(std::size_t offset) {
    std::optional<FoundObject> best;
    std::size_t end = file_.size();
    for (ClassTable classes : TablesAt(WireClass::kMap)) {
      classes.FirstUse(WireClass::kMap);
      classes.FirstUse(WireClass::kKeyFrameList);
      const PointerPattern pattern(classes, WireClass::kMap, objects_.next(), most_objects_);
      const auto is_head = [&](const Sighting& found) { return IsHeadOfMap(found, classes); };
      Better(best, end, classes, First(pattern, offset, end, is_head));
    }
    return best;
  }

  std::optional<FoundObject> FindCamera(std::size_t offset) {
    std::optional<FoundObject> best;
    std::size_t end = file_.size();
    for (const WireClass wire_class : kCameraClasses)
      for (const bool first_of_class : {false, true})
        for (const bool first_of_all : {false, true}) {
          ClassTable classes = at_.classes;
          if (!first_of_class) classes.FirstUse(wire_class);
          if (!first_of_all) classes.FirstUse(WireClass::kGeometricCamera);
          const PointerPattern pattern(classes, wire_class, objects_.next(), most_objects_);
          const auto is_camera = [&](const Sighting& found) { return IsCamera(found, wire_class, classes); };
          Better(best, end, classes, First(pattern, offset, end, is_camera));
        }
    return best;
  }

  // The head of the list of a class behind the cursor, whose first object is `behind` at most. Where the class stands
  // in the archive for the first time, its looks are enough, and the number of objects in between may have been read
  // wrongly. A class that the first keyframes may not have shown (IMU measurements) counts as met or not, whichever
  // fits.
  std::optional<FoundList> FindList(WireClass list_class, WireClass wire_class, std::uint32_t behind) const {
    for (ClassTable classes : TablesAt(WireClass::kKeyFrame)) {
      const ClassTable before = classes;
      const bool list_with_info = classes.FirstUse(list_class);
      PointerPattern pattern(classes, wire_class, objects_.next(), std::max(objects_.next(), behind));
      if (pattern.with_info) pattern.last = most_objects_;
      const auto found = Search(file_, pattern).Next(at_.input.offset());
      if (!found) continue;
      const std::size_t begin =
          Search::ListBegin(file_, found->offset, list_with_info, at_.input.encoding().size_bytes);
      if (IsHeadOfList(list_class, begin, found->offset, before)) return FoundList{begin, found->object, before};
    }
    return std::nullopt;
  }

  // Where the last `count` numbers of the file begin.
  std::size_t LastNumbers(std::size_t count) const {
    return Search::LastNumbers(file_, count, at_.input.encoding().long_bytes);
  }

 private:
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

  // The first pointer in front of `end` that is what it looks like.
  template <class Is>
  std::optional<Sighting> First(const PointerPattern& pattern, std::size_t offset, std::size_t end, const Is& is) {
    const Search search(file_.substr(0, end), pattern);
    for (auto found = search.Next(offset); found && tries_ < kMostTries;
         found = search.Next(found->offset + 1), ++tries_)
      if (is(*found)) return found;
    return std::nullopt;
  }
  // What is found with another class table in front of the best so far is better.
  static void Better(std::optional<FoundObject>& best, std::size_t& end, const ClassTable& classes,
                     const std::optional<Sighting>& found) {
    if (!found) return;
    best = FoundObject{*found, classes};
    end = found->offset;
  }

  template <class Entity>
  bool IsWhole(const Sighting& found, const ClassTable& classes, std::uint32_t behind) const {
    using Kind = ListKind<Entity>;
    try {
      Skipper<Input> skipper(Silent(at_), classes);
      skipper.input.Seek(found.offset);
      Entity entity;
      PassPointer(skipper, Kind::kEntity);
      Kind::Layout(skipper, entity);
      if (found.object + 1 == behind || NextStands(skipper, Kind::kEntity, found.object + 1)) return true;
      Decoder<Input> decoder(Silent(at_), classes, FeatureColumns::kAll);
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

  bool IsHeadOfMap(const Sighting& found, const ClassTable& classes) const {
    constexpr std::uint64_t kLargestId = std::numeric_limits<std::int32_t>::max();
    try {
      Decoder<Input> decoder(Silent(at_), classes, FeatureColumns::kNone);
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

  // Whether a count stands there that the rest of the file can hold, up to the first object.
  bool IsHeadOfList(WireClass list_class, std::size_t begin, std::size_t first, const ClassTable& classes) const {
    try {
      Skipper<Input> skipper(Silent(at_), classes);
      skipper.input.Seek(begin);
      const std::uint64_t count = skipper.ClassCount(list_class, Input::kText ? 2 : kLeastListedBytes, 4);
      return count > 0 && skipper.input.offset() + (Input::kText ? 1 : 0) >= first;
    } catch (const Error&) {
      return false;
    }
  }

  bool IsCamera(const Sighting& found, WireClass wire_class, const ClassTable& classes) const {
    try {
      Decoder<Input> decoder(Silent(at_), classes, FeatureColumns::kNone);
      decoder.input.Seek(found.offset);
      PassPointer(decoder, wire_class);
      Camera camera = CameraOf(wire_class);
      LayoutCamera(decoder, camera);
      return LooksWhole(camera);
    } catch (const Error&) {
      return false;
    }
  }

  std::string_view file_;
  const Decoder<Input>& at_;
  const ObjectTable& objects_;
  const std::uint32_t most_objects_;
  std::vector<ClassTable> usual_tables_;  // behind the keyframes of the first map
  std::size_t tries_ = 0;                 // in vain
};

}  // namespace slamdb::orbslam3
