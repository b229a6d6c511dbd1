// SPDX-License-Identifier: BSD-3-Clause
//
// The file is a graph: where a pointer leads to an object for the first time, the members of that object stand, in the
// middle of those of the object that points to it. So a map begins with its first point, which begins with its first
// keyframe, and so on, as deep as the map is large. What is begun and not yet read to its end is kept on a stack of
// small records, each of which knows how far it is; no function calls itself.
//
// Rows of objects stand where links are, until all ids are known.
#include "slamdb/formats/orbslam2/detail/read.h"

#include <algorithm>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/orbslam2/detail/archive.h"
#include "slamdb/formats/orbslam2/detail/link.h"
#include "slamdb/formats/orbslam2/detail/members.h"

namespace slamdb::orbslam2 {
namespace {

constexpr std::size_t kPointerBytes = 2;       // of null; others have 6
constexpr std::size_t kReleaseEach = 1 << 20;  // bytes
constexpr std::uint32_t kNull = Pointer::kNull;

// An object that is being read.
struct Frame {
  WireClass wire_class;
  std::uint32_t row;
  std::uint8_t step = 0;         // what of it comes next
  bool value_is_next = false;    // of a map, whose last key was a new object
  std::uint64_t left = 0;        // elements of the collection that comes next
  std::uint64_t lists_left = 0;  // of the inverted file
};

template <class Entity>
Id<Entity> RowId(const Pointer& pointer) {
  return pointer.row == kNull ? Id<Entity>() : Id<Entity>(pointer.row);
}

// Which objects a set of the map holds, by row.
class ObjectSet {
 public:
  void Add(const Pointer& pointer) {
    if (pointer.row == kNull) return;
    if (pointer.row >= has_.size()) has_.resize(pointer.row + std::size_t{1});
    has_[pointer.row] = true;
  }
  // How many that are not bad it has not.
  template <class Entity>
  std::uint64_t CountLoose(const Column<Entity>& entities) const {
    std::uint64_t loose = 0;
    for (std::size_t row = 0; row < entities.size(); ++row)
      loose += !entities[row].bad && (row >= has_.size() || !has_[row]) ? 1 : 0;
    return loose;
  }

 private:
  std::vector<bool> has_;
};

class MapReader {
 public:
  MapReader(detail::FileStream& file, const ReadOptions& options)
      : file_(file), progress_(options.progress), threads_(options.threads), archive_(file) {}

  RecordedMap Read() {
    Root(WireClass::kMap);
    Root(WireClass::kDatabase);
    if (!archive_.AtEnd())
      archive_.Fail("bytes are left behind the map: the file is damaged, or of a fork with other members");
    recorded_.loose_keyframes = keyframes_.CountLoose(recorded_.map.keyframes);
    recorded_.loose_points = points_.CountLoose(recorded_.map.points);
    LinkObjects(recorded_.map, threads_);
    return std::move(recorded_);
  }

 private:
  KeyFrame& keyframe(const Frame& frame) { return recorded_.map.keyframes[frame.row]; }
  MapPoint& point(const Frame& frame) { return recorded_.map.points[frame.row]; }

  void Root(WireClass pointee) {
    archive_.place().entity = nullptr;
    archive_.place().field = pointee == WireClass::kMap ? "Map" : "KeyFrameDatabase";
    const Pointer pointer = archive_.TakePointer(pointee);
    if (pointer.is_new) Push(pointee, pointer.row);
    while (!stack_.empty())
      if (Advance(stack_.back())) stack_.pop_back();
  }

  void Push(WireClass wire_class, std::uint32_t row) {
    Map& map = recorded_.map;
    if (wire_class == WireClass::kKeyFrame) {
      map.keyframes.emplace_back();
    } else if (wire_class == WireClass::kMapPoint) {
      map.points.emplace_back();
    } else if (row > 0) {
      archive_.Fail("a second map or database of keyframes, of which ORB-SLAM2 has one each", ErrorKind::kUnsupported);
    }
    stack_.push_back({.wire_class = wire_class, .row = row});
  }

  // Reads on in an object until it ends, and returns true; or until a new one begins, which is on the stack then, and
  // `frame` nowhere.
  bool Advance(Frame& frame) {
    Enter(frame);
    switch (frame.wire_class) {
      case WireClass::kMapPoint:
        return AdvancePoint(frame);
      case WireClass::kKeyFrame:
        return AdvanceKeyFrame(frame);
      case WireClass::kDatabase:
        return AdvanceDatabase(frame);
      default:
        return AdvanceMap(frame);
    }
  }

  // Says for errors where reading is.
  void Enter(const Frame& frame) {
    orbslam3::Place& place = archive_.place();
    place.entity = nullptr;
    if (frame.wire_class != WireClass::kMapPoint && frame.wire_class != WireClass::kKeyFrame) return;
    const bool is_point = frame.wire_class == WireClass::kMapPoint;
    place.entity = is_point ? "mp" : "kf";
    place.ordinal = frame.row;
    place.id = frame.step == 0 ? Id<KeyFrame>::kNone : is_point ? point(frame).id.value() : keyframe(frame).id.value();
  }

  // ---- pointers and collections of them; false when a new object begins

  bool One(Frame& frame, const char* field, WireClass pointee, Pointer& pointer) {
    archive_.place().field = field;
    pointer = archive_.TakePointer(pointee);
    ++frame.step;
    if (pointer.is_new) Push(pointee, pointer.row);
    return !pointer.is_new;
  }

  void Begin(Frame& frame, const char* field, WireClass collection) {
    frame.left = archive_.TakeCollection(field, collection, kPointerBytes);
    ++frame.step;
  }

  template <class Take>
  bool List(Frame& frame, const char* field, WireClass pointee, Take take) {
    archive_.place().field = field;
    while (frame.left > 0) {
      --frame.left;
      const Pointer pointer = archive_.TakePointer(pointee);
      take(pointer);
      if (!pointer.is_new) continue;
      Push(pointee, pointer.row);
      return false;
    }
    ++frame.step;
    return true;
  }

  template <class Key, class Value>
  bool MapOfKeyFrames(Frame& frame, const char* field, WireClass pair, Key take_key, Value take_value) {
    archive_.place().field = field;
    for (;;) {
      if (frame.value_is_next) take_value();
      frame.value_is_next = false;
      if (frame.left == 0) break;
      --frame.left;
      archive_.TakeClassInfo(pair);
      const Pointer pointer = archive_.TakePointer(WireClass::kKeyFrame);
      take_key(pointer);
      frame.value_is_next = true;
      if (!pointer.is_new) continue;
      Push(WireClass::kKeyFrame, pointer.row);
      return false;
    }
    ++frame.step;
    return true;
  }

  // ---- the classes, member after member

  bool AdvanceMap(Frame& frame) {
    Map& map = recorded_.map;
    switch (frame.step) {
      case 0:
        Begin(frame, "mspMapPoints", WireClass::kPointSet);
        [[fallthrough]];
      case 1:
        if (!List(frame, "mspMapPoints", WireClass::kMapPoint, [&](const Pointer& p) { points_.Add(p); })) return false;
        Begin(frame, "mvpKeyFrameOrigins", WireClass::kKeyFrameList);
        [[fallthrough]];
      case 3:
        if (!List(frame, "mvpKeyFrameOrigins", WireClass::kKeyFrame,
                  [&](const Pointer& p) { map.origins.push_back(RowId<KeyFrame>(p)); }))
          return false;
        Begin(frame, "mspKeyFrames", WireClass::kKeyFrameSet);
        [[fallthrough]];
      case 5:
        if (!List(frame, "mspKeyFrames", WireClass::kKeyFrame, [&](const Pointer& p) { keyframes_.Add(p); }))
          return false;
        Begin(frame, "mvpReferenceMapPoints", WireClass::kPointList);
        [[fallthrough]];
      case 7:
        if (!List(frame, "mvpReferenceMapPoints", WireClass::kMapPoint, [](const Pointer&) {})) return false;
        map.max_keyframe_id = archive_.Take<std::uint64_t>("mnMaxKFid");
        map.big_change_index = archive_.Take<std::int32_t>("mnBigChangeIdx");
    }
    return true;
  }

  bool AdvanceDatabase(Frame& frame) {
    if (frame.step == 0) {
      constexpr std::size_t kLeastListBytes = sizeof(std::uint64_t) + sizeof(std::uint32_t);
      frame.lists_left = archive_.TakeCollection("mvInvertedFile", WireClass::kInvertedFile, kLeastListBytes);
      frame.step = 1;
    }
    for (;;) {
      while (frame.left > 0)
        if (!List(frame, "mvInvertedFile", WireClass::kKeyFrame, [](const Pointer&) {})) return false;
      frame.step = 1;
      if (frame.lists_left == 0) return true;
      --frame.lists_left;
      frame.left = archive_.TakeCollection("mvInvertedFile", WireClass::kWordList, kPointerBytes);
      if (frame.lists_left % (1U << 14U) == 0) Report();
    }
  }

  bool AdvancePoint(Frame& frame) {
    Pointer pointer;
    switch (frame.step) {
      case 0:
        TakePointHead(archive_, point(frame), recorded_.next_point);
        Begin(frame, "mObservations", WireClass::kObservationMap);
        [[fallthrough]];
      case 1:
        if (!MapOfKeyFrames(
                frame, "mObservations", WireClass::kObservationPair,
                [&](const Pointer& p) { point(frame).observations.push_back({.keyframe = RowId<KeyFrame>(p)}); },
                [&] { point(frame).observations.back().left = TakeRow(); }))
          return false;
        TakePointMatrices(archive_, point(frame));
        [[fallthrough]];
      case 2: {
        MapPoint& it = point(frame);
        const bool known = One(frame, "mpRefKF", WireClass::kKeyFrame, pointer);
        it.reference = RowId<KeyFrame>(pointer);
        if (!known) return false;
        [[fallthrough]];
      }
      case 3: {
        MapPoint& it = point(frame);
        it.visible_count = archive_.Take<std::int32_t>("mnVisible");
        it.found_count = archive_.Take<std::int32_t>("mnFound");
        it.bad = archive_.TakeFlag("mbBad");
        const std::uint32_t row = frame.row;
        const bool known = One(frame, "mpReplaced", WireClass::kMapPoint, pointer);
        recorded_.map.points[row].replaced_by = RowId<MapPoint>(pointer);  // a new point may have moved the others
        if (!known) return false;
        [[fallthrough]];
      }
      case 4: {
        MapPoint& it = point(frame);
        it.min_distance = archive_.Take<float>("mfMinDistance");
        it.max_distance = archive_.Take<float>("mfMaxDistance");
        return One(frame, "mpMap", WireClass::kMap, pointer);
      }
    }
    return true;
  }

  // The row of a keypoint, of 64 bits.
  std::int32_t TakeRow() {
    const auto row = archive_.Take<std::uint64_t>("mObservations");
    if (row > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()))
      archive_.Fail(detail::Concat("keypoint ", row, ": the file is damaged"));
    return static_cast<std::int32_t>(row);
  }

  bool AdvanceKeyFrame(Frame& frame) {
    Pointer pointer;
    const std::uint32_t row = frame.row;
    switch (frame.step) {
      case 0:
        TakeKeyFrameHead(archive_, keyframe(frame), recorded_.next_keyframe);
        TakeFeatures(archive_, keyframe(frame));
        if (!TakePoses(archive_, keyframe(frame))) ++recorded_.without_pose;
        Begin(frame, "mvpMapPoints", WireClass::kPointList);
        keyframe(frame).features.map_points.reserve(frame.left);
        [[fallthrough]];
      case 1:
        if (!List(frame, "mvpMapPoints", WireClass::kMapPoint, [&](const Pointer& p) {
              recorded_.map.keyframes[row].features.map_points.push_back(RowId<MapPoint>(p));
            }))
          return false;
        [[fallthrough]];
      case 2:
        if (!One(frame, "mpKeyFrameDB", WireClass::kDatabase, pointer)) return false;
        [[fallthrough]];
      case 3:
        archive_.TakeGrid(keyframe(frame).features.grid);
        Begin(frame, "mConnectedKeyFrameWeights", WireClass::kWeightMap);
        [[fallthrough]];
      default:
        return AdvanceKeyFrameGraph(frame);
    }
  }

  bool AdvanceKeyFrameGraph(Frame& frame) {
    Pointer pointer;
    const std::uint32_t row = frame.row;
    const auto at_row = [&]() -> KeyFrame& { return recorded_.map.keyframes[row]; };
    switch (frame.step) {
      case 4:
        if (!MapOfKeyFrames(
                frame, "mConnectedKeyFrameWeights", WireClass::kWeightPair,
                [&](const Pointer& p) { at_row().connections.push_back({.keyframe = RowId<KeyFrame>(p)}); },
                [&] { at_row().connections.back().weight = archive_.Take<std::int32_t>("weight"); }))
          return false;
        Begin(frame, "mvpOrderedConnectedKeyFrames", WireClass::kKeyFrameList);
        [[fallthrough]];
      case 6:
        if (!List(frame, "mvpOrderedConnectedKeyFrames", WireClass::kKeyFrame, [](const Pointer&) {})) return false;
        archive_.TakeNumbers("mvOrderedWeights", WireClass::kInts, ignored_);
        keyframe(frame).first_connection = archive_.TakeFlag("mbFirstConnection");
        [[fallthrough]];
      case 7: {
        const bool known = One(frame, "mpParent", WireClass::kKeyFrame, pointer);
        at_row().parent = RowId<KeyFrame>(pointer);
        if (!known) return false;
        [[fallthrough]];
      }
      case 8:
        Begin(frame, "mspChildrens", WireClass::kKeyFrameSet);
        [[fallthrough]];
      case 9:
        if (!List(frame, "mspChildrens", WireClass::kKeyFrame,
                  [&](const Pointer& p) { at_row().children.push_back(RowId<KeyFrame>(p)); }))
          return false;
        Begin(frame, "mspLoopEdges", WireClass::kKeyFrameSet);
        [[fallthrough]];
      case 11:
        if (!List(frame, "mspLoopEdges", WireClass::kKeyFrame,
                  [&](const Pointer& p) { at_row().loop_edges.push_back(RowId<KeyFrame>(p)); }))
          return false;
        TakeKeyFrameTail(archive_, keyframe(frame));
        Report();
        return One(frame, "mpMap", WireClass::kMap, pointer);
    }
    return true;
  }

  void Report() {
    if (archive_.offset() - released_ < kReleaseEach) return;
    released_ = archive_.offset();
    file_.Release(released_);
    if (progress_)
      progress_("reading " + file_.path(), static_cast<double>(released_) / static_cast<double>(file_.size()));
  }

  detail::FileStream& file_;
  const Progress& progress_;
  int threads_;
  Archive archive_;
  RecordedMap recorded_;
  std::vector<Frame> stack_;
  ObjectSet keyframes_, points_;
  std::vector<std::int32_t> ignored_;
  std::size_t released_ = 0;
};

}  // namespace

RecordedMap ReadMap(const Source& source, const ReadOptions& options) {
  detail::FileStream file(source);
  return MapReader(file, options).Read();
}

}  // namespace slamdb::orbslam2
