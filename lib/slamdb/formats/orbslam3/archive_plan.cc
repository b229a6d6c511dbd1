// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/archive_plan.h"

#include <algorithm>
#include <limits>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/encoder.h"

namespace slamdb::orbslam3 {
namespace {

constexpr std::size_t kKeyFramesPerSegment = 8;  // about a megabyte
constexpr std::size_t kPointsPerSegment = 4096;

std::uint64_t Size(const std::vector<PointerRun>& runs) {
  std::uint64_t size = 0;
  for (const PointerRun& run : runs) size += run.count;
  return size;
}

// Encodes one segment. Over NoOutput it only moves the class table.
template <class Output>
class SegmentEncoder {
 public:
  SegmentEncoder(const Atlas& atlas, const ArchiveEncoding& encoding, const Segment& segment, const Output& output)
      : atlas_(atlas), encoding_(encoding), segment_(segment), encoder_(output, segment.classes) {}

  ClassTable Run() {
    switch (segment_.kind) {
      case Segment::Kind::kHead:
        Head();
        break;
      case Segment::Kind::kMapPointer:
        PutPointer(WireClass::kMap, segment_.pointers.front(), 0);
        break;
      case Segment::Kind::kMapHead:
        PutPointer(WireClass::kMap, segment_.pointers.front(), 0);
        LayoutMapHead(encoder_, map());
        break;
      case Segment::Kind::kKeyFrames:
        List(WireClass::kKeyFrameList, WireClass::kKeyFrame, map().keyframes,
             [this](const KeyFrame& keyframe) { LayoutKeyFrame(encoder_, keyframe); });
        break;
      case Segment::Kind::kPoints:
        List(WireClass::kMapPointList, WireClass::kMapPoint, map().points,
             [this](const MapPoint& point) { LayoutMapPoint(encoder_, point); });
        break;
      case Segment::Kind::kMapTail:
        LayoutMapTail(encoder_, map());
        break;
      case Segment::Kind::kTail:
        Tail();
        break;
    }
    return encoder_.classes;
  }
  const Output& output() const { return encoder_.output; }

 private:
  const Map& map() const { return atlas_.maps[segment_.map]; }

  void Head() {
    if constexpr (!std::is_same_v<Output, NoOutput>) {
      encoder_.output.PutString(atlas_.vocabulary.name);
      encoder_.output.PutString(atlas_.vocabulary.checksum);
    }
    PutPointer(WireClass::kAtlas, {}, 0);
    encoder_.classes.Register(WireClass::kPinhole);
    encoder_.classes.Register(WireClass::kKannalaBrandt8);
    encoder_.ClassCount(WireClass::kMapList, segment_.list_size);
  }
  void Tail() {
    encoder_.ClassCount(WireClass::kCameraList, segment_.list_size);
    for (const PointerRun& run : segment_.pointers) {
      for (std::uint64_t i = 0; i < run.count; ++i) {
        const bool pinhole =
            run.row + i >= atlas_.cameras.size() || atlas_.cameras[run.row + i].model == CameraModel::kPinhole;
        PutPointer(pinhole ? WireClass::kPinhole : WireClass::kKannalaBrandt8, run, i);
        if (run.kind == PointerRun::Kind::kNew) LayoutCamera(encoder_, atlas_.cameras[run.row + i]);
      }
    }
    LayoutCounters(encoder_, atlas_.next_ids);
    if constexpr (!std::is_same_v<Output, NoOutput>) encoder_.output.PutEnd();
  }
  template <class Rows, class PutContents>
  void List(WireClass list_class, WireClass wire_class, const Rows& rows, PutContents put_contents) {
    if (segment_.begins_list) encoder_.ClassCount(list_class, segment_.list_size);
    for (const PointerRun& run : segment_.pointers) {
      for (std::uint64_t i = 0; i < run.count; ++i) {
        PutPointer(wire_class, run, i);
        if (run.kind == PointerRun::Kind::kNew) put_contents(rows[run.row + i]);
      }
    }
  }
  // The pointer to object `i` of the run.
  void PutPointer(WireClass wire_class, const PointerRun& run, std::uint64_t i) {
    const std::int16_t class_id = encoder_.classes.Register(wire_class);
    if (run.kind == PointerRun::Kind::kNull) return encoder_.output.Put(std::int16_t{-1});
    encoder_.output.Put(class_id);
    encoder_.PutClassInfo(wire_class, /*tracking=*/1);
    if constexpr (!std::is_same_v<Output, NoOutput>)
      encoder_.output.PutObjectId(run.object + static_cast<std::uint32_t>(i), run.kind == PointerRun::Kind::kNew);
  }

  const Atlas& atlas_;
  const ArchiveEncoding& encoding_;
  const Segment& segment_;
  Encoder<Output> encoder_;
};

}  // namespace

// Walks the archive once, keeping only the class table and the object ids.
ArchivePlan::ArchivePlan(const Atlas& atlas, const ArchiveEncoding& encoding) : atlas_(atlas), encoding_(encoding) {
  ClassTable classes(encoding_);
  const std::uint64_t maps = atlas.maps.size() + atlas.repeated_maps.size();
  Add({.kind = Segment::Kind::kHead, .classes = classes, .list_size = maps}, classes);
  std::size_t row = 0;
  auto repeated = atlas.repeated_maps.begin();
  for (std::uint64_t position = 0; position < maps; ++position) {
    const bool is_repeated =
        repeated != atlas.repeated_maps.end() && (repeated->position <= position || row == atlas.maps.size());
    if (!is_repeated) {
      PlanMap(row++, classes);
      continue;
    }
    PointerRun run{.kind = PointerRun::Kind::kNull};
    if (repeated->owner_map != RepeatedEntry::kNull) {
      if (repeated->row >= objects_.size())
        throw Error(ErrorKind::kNotPossible, "a repeated map entry refers to no map before it");
      run = {.kind = PointerRun::Kind::kAgain, .object = objects_[repeated->row].map};
    }
    ++repeated;
    Add({.kind = Segment::Kind::kMapPointer, .classes = classes, .pointers = {run}}, classes);
  }
  const auto cameras = Runs(atlas.cameras.size(), next_object_, atlas.repeated_cameras, nullptr);
  Add({.kind = Segment::Kind::kTail, .classes = classes, .list_size = Size(cameras), .pointers = cameras}, classes);
}

int ArchivePlan::ThreadsThatPay(int requested) const {
  const auto goes_on = [](const Segment& segment) {
    return !segment.begins_list &&
           (segment.kind == Segment::Kind::kKeyFrames || segment.kind == Segment::Kind::kPoints);
  };
  return std::ranges::any_of(segments_, goes_on) ? requested : 1;
}

void ArchivePlan::PlanMap(std::size_t row, ClassTable& classes) {
  const Map& map = atlas_.maps[row];
  MapObjects objects;
  objects.map = next_object_;
  objects.first_keyframe = objects.map + 1;
  objects.first_point = objects.first_keyframe + static_cast<std::uint32_t>(map.keyframes.size());
  objects.end = next_object_ = objects.first_point + static_cast<std::uint32_t>(map.points.size());
  objects_.push_back(objects);
  Add({.kind = Segment::Kind::kMapHead, .classes = classes, .map = row, .pointers = {{.object = objects.map}}},
      classes);
  AddList(Segment::Kind::kKeyFrames, row,
          Runs(map.keyframes.size(), objects.first_keyframe, map.repeated_keyframes, &MapObjects::first_keyframe),
          kKeyFramesPerSegment, classes);
  AddList(Segment::Kind::kPoints, row,
          Runs(map.points.size(), objects.first_point, map.repeated_points, &MapObjects::first_point),
          kPointsPerSegment, classes);
  Add({.kind = Segment::Kind::kMapTail, .classes = classes, .map = row}, classes);
}

// `first_of` tells where the objects of the same kind begin in the map that a repeated entry refers to; without it the
// list is the atlas's own.
std::vector<PointerRun> ArchivePlan::Runs(std::uint64_t rows, std::uint32_t first_object,
                                          const std::vector<RepeatedEntry>& repeated,
                                          std::uint32_t MapObjects::*first_of) const {
  std::vector<PointerRun> runs;
  std::uint64_t row = 0, position = 0;
  const auto add_new = [&](std::uint64_t count) {
    if (count > 0)
      runs.push_back({.row = row, .count = count, .object = first_object + static_cast<std::uint32_t>(row)});
    row += count;
    position += count;
  };
  for (const RepeatedEntry& entry : repeated) {
    add_new(std::min(rows - row, entry.position - std::min(entry.position, position)));
    ++position;
    if (entry.owner_map == RepeatedEntry::kNull) {
      runs.push_back({.kind = PointerRun::Kind::kNull});
      continue;
    }
    if (first_of != nullptr && entry.owner_map >= objects_.size())
      throw Error(ErrorKind::kNotPossible, "a repeated list entry refers to no map before it");
    const std::uint32_t first = first_of == nullptr ? first_object : objects_[entry.owner_map].*first_of;
    runs.push_back({.kind = PointerRun::Kind::kAgain, .object = first + static_cast<std::uint32_t>(entry.row)});
    runs.back().row = entry.row;  // tells the class of a camera
  }
  add_new(rows - row);
  return runs;
}

// Cuts the runs into segments of `segment_size` pointers. The first one carries the list's header, so that an empty
// list has a segment too.
void ArchivePlan::AddList(Segment::Kind kind, std::size_t map, const std::vector<PointerRun>& runs,
                          std::size_t segment_size, ClassTable& classes) {
  const auto fresh = [&](bool begins) {
    return Segment{.kind = kind, .classes = classes, .map = map, .begins_list = begins, .list_size = Size(runs)};
  };
  Segment segment = fresh(true);
  std::uint64_t room = segment_size;
  for (PointerRun run : runs) {
    while (run.count > 0) {
      PointerRun piece = run;
      piece.count = std::min(run.count, room);
      run.row += piece.count;
      run.object += static_cast<std::uint32_t>(piece.count);
      run.count -= piece.count;
      room -= piece.count;
      segment.pointers.push_back(piece);
      if (room > 0) continue;
      Add(std::move(segment), classes);
      segment = fresh(false);
      room = segment_size;
    }
  }
  if (segment.begins_list || !segment.pointers.empty()) Add(std::move(segment), classes);
}

// Keeps the segment and moves the class table behind it.
void ArchivePlan::Add(Segment segment, ClassTable& classes) {
  classes = SegmentEncoder(atlas_, encoding_, segment, NoOutput()).Run();
  segments_.push_back(std::move(segment));
}

bool ArchivePlan::Encode(std::size_t i, detail::Pieces& buffer) const {
  const std::string header = i == 0 ? WriteArchiveHeader(encoding_) : std::string();
  if (!encoding_.text) {
    BinaryOutput output(buffer, encoding_, BinaryOutput::Columns::kReferredTo);
    output.PutRaw(header);
    SegmentEncoder(atlas_, encoding_, segments_[i], output).Run();
    return true;
  }
  TextOutput output(buffer, encoding_);
  output.PutRaw(header);
  SegmentEncoder encoder(atlas_, encoding_, segments_[i], output);
  encoder.Run();
  return encoder.output().all_finite();
}

}  // namespace slamdb::orbslam3
