// SPDX-License-Identifier: BSD-3-Clause
#include "tests/edit/repair/entity_ranges.h"

#include <span>

#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/pointers.h"
#include "slamdb/formats/orbslam3/detail/skipper.h"

namespace slamdb {
namespace {

using namespace orbslam3;

template <class Input>
class Walk {
 public:
  Walk(detail::FileStream& file, const ArchiveHeader& header)
      : at_(Input(&file, header.encoding), ClassTable(header.encoding)) {
    at_.input.Seek(header.bytes);
  }

  EntityRanges Run() {
    at_.input.TakeString();  // the vocabulary
    at_.input.TakeString();
    Take({WireClass::kAtlas}, 0, 0);
    at_.classes.Register(WireClass::kPinhole);
    at_.classes.Register(WireClass::kKannalaBrandt8);
    const std::uint64_t maps = at_.ClassCount(WireClass::kMapList, 2, 1);
    for (std::size_t i = 0, row = 0; i < maps; ++i)
      if (Take({WireClass::kMap}, 0, row).kind == Pointer::Kind::kNew) PassMap(row++);
    const std::uint64_t cameras = at_.ClassCount(WireClass::kCameraList, 2, 1);
    for (std::size_t row = 0; row < cameras; ++row) PassCamera(row);
    return std::move(ranges_);
  }

 private:
  Pointer Take(std::initializer_list<WireClass> classes, std::size_t map, std::size_t row) {
    const Pointer pointer = TakePointer(at_, objects_, classes);
    if (pointer.kind == Pointer::Kind::kNew) objects_.Add(pointer.wire_class, static_cast<std::uint32_t>(map), row);
    return pointer;
  }
  void PassMap(std::size_t map) {
    Map nothing;
    LayoutMapHead(at_, nothing);
    PassList(WireClass::kKeyFrameList, WireClass::kKeyFrame, map, ranges_.keyframes, [this] {
      KeyFrame keyframe;
      LayoutKeyFrame(at_, keyframe);
    });
    PassList(WireClass::kMapPointList, WireClass::kMapPoint, map, ranges_.points, [this] {
      MapPoint point;
      LayoutMapPoint(at_, point);
    });
    LayoutMapTail(at_, nothing);
  }
  template <class Pass>
  void PassList(WireClass list, WireClass wire_class, std::size_t map, std::vector<EntityRange>& ranges,
                const Pass& pass) {
    const std::uint64_t count = at_.ClassCount(list, 2, 1);
    for (std::size_t i = 0, row = 0; i < count; ++i) {
      const std::size_t begin = at_.input.offset();
      if (Take({wire_class}, map, row).kind != Pointer::Kind::kNew) continue;
      pass();
      ranges.push_back({begin, at_.input.offset(), map, row++});
    }
  }
  void PassCamera(std::size_t row) {
    const std::size_t begin = at_.input.offset();
    const Pointer pointer = Take({WireClass::kPinhole, WireClass::kKannalaBrandt8}, 0, row);
    Camera camera{.model =
                      pointer.wire_class == WireClass::kPinhole ? CameraModel::kPinhole : CameraModel::kKannalaBrandt8};
    LayoutCamera(at_, camera);
    ranges_.cameras.push_back({begin, at_.input.offset(), 0, row});
  }

  Skipper<Input> at_;
  ObjectTable objects_;
  EntityRanges ranges_;
};

}  // namespace

EntityRanges RangesOf(std::string_view file) {
  detail::FileStream stream(Source(std::as_bytes(std::span(file)), "memory"));
  Notices notices;
  const ArchiveHeader header = ReadArchiveHeader(stream, notices);
  stream.FillTo(stream.size());
  return header.encoding.text ? Walk<TextInput>(stream, header).Run() : Walk<BinaryInput>(stream, header).Run();
}

}  // namespace slamdb
