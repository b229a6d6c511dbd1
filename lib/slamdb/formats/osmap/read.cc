// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/files_read.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/detail/unfinished.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/export/detail/protobuf.h"
#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/formats/import/detail/loops.h"
#include "slamdb/formats/import/detail/pinhole_cameras.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/formats/osmap/detail/header.h"
#include "slamdb/formats/osmap/detail/osmap.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"

namespace slamdb::osmap {
namespace {

using detail::Concat;
using detail::Counted;
using detail::ProtoField;
using detail::ProtoFile;
using detail::ProtoReader;

constexpr std::int32_t kMostOctaves = 64;

class SideFile {
 public:
  SideFile(const std::string& header, const Side& side)
      : file_(Source(PathOf(header, side))), proto_{file_.text(), file_.path()} {}
  const ProtoFile& proto() const { return proto_; }

 private:
  WholeFile file_;
  ProtoFile proto_;
};

// What a field that must be a message or text holds.
std::string_view BytesOf(const ProtoFile& file, const ProtoField& field) {
  if (!field.is_bytes()) file.Fail(nullptr, Concat("field ", field.number, " is a number, expected a message"));
  return field.bytes;
}

void Require(const ProtoFile& file, std::string_view message, const std::string& why_not) {
  if (!why_not.empty()) file.Fail(message.data(), why_not);
}

template <class Visit>
void ForEachField(const ProtoFile& file, std::string_view message, const Visit& visit) {
  ProtoReader reader(file, message);
  for (ProtoField field; reader.Next(field);) visit(field);
}

void ReadDescriptor(const ProtoFile& file, std::string_view message, Descriptor& descriptor) {
  std::vector<std::uint32_t> words;
  ForEachField(file, message, [&](const ProtoField& field) {
    if (field.number == 1) AppendFixed32(file, field, words);
  });
  if (words.size() * sizeof(std::uint32_t) != descriptor.size())
    file.Fail(message.data(), Concat("a descriptor of ", words.size(), " words, expected 8"));
  std::memcpy(descriptor.data(), words.data(), descriptor.size());
}

CameraMatrix ReadCameraMatrix(const ProtoFile& file, std::string_view message) {
  CameraMatrix camera{};
  ForEachField(file, message, [&](const ProtoField& field) {
    if (field.number >= 1 && field.number <= camera.size()) camera[field.number - 1] = field.AsFloat();
  });
  Require(file, message, WhyNoCamera(camera));
  return camera;
}

// A count is a float there.
std::int32_t CountOf(float value) {
  constexpr float kMost = 1 << 30;
  return value >= 1 && value < kMost ? static_cast<std::int32_t>(value) : MapPoint::kNoCount;
}

MapPoint ReadPoint(const ProtoFile& file, std::string_view message) {
  MapPoint point;
  point.id = MapPointId(0);
  point.descriptor_form = MatrixForm::kEmpty;
  ForEachField(file, message, [&](const ProtoField& field) {
    switch (field.number) {
      case 1:
        point.id = MapPointId(field.value);
        break;
      case 2:
        ForEachField(file, BytesOf(file, field), [&](const ProtoField& axis) {
          if (axis.number >= 1 && axis.number <= 3) point.position[axis.number - 1] = axis.AsFloat();
        });
        break;
      case 3:
        point.visible_count = CountOf(field.AsFloat());
        break;
      case 4:
        point.found_count = CountOf(field.AsFloat());
        break;
      case 5:
        ReadDescriptor(file, BytesOf(file, field), point.descriptor);
        point.descriptor_form = MatrixForm::kUsual;
        break;
      default:;
    }
  });
  Require(file, message, detail::WhyNoPosition(point.position.cast<double>()));
  return point;
}

Rigid3f ReadPose(const ProtoFile& file, std::string_view message) {
  std::vector<float> values;
  ForEachField(file, message, [&](const ProtoField& field) {
    if (field.number == 1) AppendFixed32(file, field, values);
  });
  if (values.size() != 12) file.Fail(message.data(), Concat("a pose of ", values.size(), " numbers, expected 12"));
  const Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>> matrix(values.data());
  const Eigen::Matrix3d rotation = matrix.leftCols<3>().cast<double>();
  const Eigen::Vector3d translation = matrix.col(3).cast<double>();
  Require(file, message, detail::WhyNoPose(rotation, translation));
  return detail::PoseOf(rotation, translation);
}

struct ReadKeyFrame {
  KeyFrame keyframe;
  std::uint64_t camera = 0;  // row of Header::cameras
  std::optional<CameraMatrix> own_camera;
};

ReadKeyFrame ReadOne(const ProtoFile& file, std::string_view message) {
  ReadKeyFrame read;
  KeyFrame& keyframe = read.keyframe;
  keyframe.id = KeyFrameId(0);
  ForEachField(file, message, [&](const ProtoField& field) {
    switch (field.number) {
      case 1:
        keyframe.id = KeyFrameId(field.value);
        break;
      case 2:
        keyframe.camera_from_world = ReadPose(file, BytesOf(file, field));
        break;
      case 3:
        read.own_camera = ReadCameraMatrix(file, BytesOf(file, field));
        break;
      case 4:
        read.camera = field.value;
        break;
      case 5: {
        if (!field.is_bytes()) {
          keyframe.loop_edges.push_back(KeyFrameId(field.value));
          break;
        }
        for (ProtoReader packed(file, field.bytes); !packed.rest().empty();)
          keyframe.loop_edges.push_back(KeyFrameId(packed.TakeVarint()));
        break;
      }
      case 6:
        keyframe.timestamp = field.AsDouble();
        break;
      default:;
    }
  });
  return read;
}

class MapReader {
 public:
  MapReader(const Source& source, const ReadOptions& options, Notices& notices)
      : path_(source.path), options_(options), notices_(notices) {
    files_.Note(path_);
    const WholeFile header(source);
    detail::WarnOfOpenEnd(header.text(), path_, notices);
    header_ = ParseHeader(header.text(), path_);
    for (const Side* side : {&header_.points, &header_.keyframes, &header_.features})
      if (!side->file.empty()) files_.Note(sides_.emplace_back(PathOf(path_, *side)));
    RefuseUnfinished();
  }

  Atlas Read() {
    Map& map = atlas_.maps.emplace_back();
    map.id = MapId(0);
    if (!header_.points.file.empty()) ReadPoints(map);
    if (!header_.keyframes.file.empty()) ReadKeyFrames(map);
    if (!header_.features.file.empty()) ReadFeatures(map);
    RefuseUnfinished();
    files_.RequireSame();
    Tell();
    detail::CompleteAtlas(atlas_, "osmap", options_.threads, notices_);
    return std::move(atlas_);
  }

 private:
  void RefuseUnfinished() const {
    for (const std::string& side : sides_) detail::RefuseUnfinished(detail::UnfinishedBeside(side), path_);
  }

  void ReadPoints(Map& map) {
    const SideFile side(path_, header_.points);
    const ProtoFile& file = side.proto();
    ForEachField(file, file.bytes, [&](const ProtoField& field) {
      if (field.number == 1) map.points.push_back(ReadPoint(file, BytesOf(file, field)));
    });
    Compare(file, header_.points, map.points.size(), "map point");
  }

  void ReadKeyFrames(Map& map) {
    const SideFile side(path_, header_.keyframes);
    const ProtoFile& file = side.proto();
    ForEachField(file, file.bytes, [&](const ProtoField& field) {
      if (field.number != 1) return;
      ReadKeyFrame read = ReadOne(file, BytesOf(file, field));
      SetCamera(read, field.bytes.data(), file);
      map.keyframes.push_back(std::move(read.keyframe));
    });
    Compare(file, header_.keyframes, map.keyframes.size(), "keyframe");
    CloseLoops(map);
  }

  void SetCamera(ReadKeyFrame& read, const char* at, const ProtoFile& file) {
    if (!read.own_camera && read.camera >= header_.cameras.size())
      file.Fail(at, Concat("camera ", read.camera, " of the ", header_.cameras.size(), " in ", path_));
    const CameraMatrix k = read.own_camera ? *read.own_camera : header_.cameras[read.camera];
    detail::SetPinhole(read.keyframe, k[0], k[1], k[2], k[3]);
    read.keyframe.camera = cameras_.IdOf(k, atlas_);
  }

  // Of each loop the keyframe of the larger id has the edge.
  static void CloseLoops(Map& map) {
    const IdTable rows = KeyFrameTable(map);
    for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
      const KeyFrameId id = map.keyframes[row].id;
      const std::vector<KeyFrameId> edges(map.keyframes[row].loop_edges.begin(), map.keyframes[row].loop_edges.end());
      for (const KeyFrameId other : edges)
        if (const std::uint32_t found = rows.Find(other.value()); found != kNoRow && other != id)
          map.keyframes[found].loop_edges.push_back(id);
    }
    detail::SortLoops(map.keyframes);
  }

  // The features of one keyframe: where they are in the file.
  struct Block {
    std::uint64_t keyframe = 0;
    std::vector<std::string_view> features;
  };

  void ReadFeatures(Map& map) {
    const SideFile side(path_, header_.features);
    const ProtoFile& file = side.proto();
    std::vector<Block> blocks;
    if ((header_.options & kDelimited) != 0) {
      for (ProtoReader messages(file, file.bytes); !messages.rest().empty();)
        FindBlocks(file, messages.TakeDelimited(), blocks);
    } else {
      FindBlocks(file, file.bytes, blocks);
    }
    const IdTable rows = KeyFrameTable(map);
    std::vector<const Block*> of_row(map.keyframes.size());
    std::uint64_t features = 0, strangers = 0;
    for (const Block& block : blocks) {
      features += block.features.size();
      const std::uint32_t row = rows.Find(block.keyframe);
      if (row == kNoRow || of_row[row] != nullptr)
        ++strangers;
      else
        of_row[row] = &block;
    }
    Compare(file, header_.features, features, "feature");
    if (strangers > 0)
      notices_.Lose("left out: features of keyframes that are not there, or had some already: " +
                    Counted(strangers, "keyframe"));
    detail::ParallelFor(of_row.size(), 8, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        if (of_row[row] != nullptr) Fill(file, *of_row[row], map.keyframes[row].features);
    });
    if (undescribed_ > 0)
      notices_.Lose(Concat("left out: descriptors of features whose keyframes have other features without one (",
                           detail::Thousands(undescribed_), ")"));
  }

  static void FindBlocks(const ProtoFile& file, std::string_view message, std::vector<Block>& blocks) {
    ForEachField(file, message, [&](const ProtoField& field) {
      if (field.number != 1) return;
      Block& block = blocks.emplace_back();
      ForEachField(file, BytesOf(file, field), [&](const ProtoField& inner) {
        if (inner.number == 1) block.keyframe = inner.value;
        if (inner.number == 2) block.features.push_back(BytesOf(file, inner));
      });
    });
  }

  void Fill(const ProtoFile& file, const Block& block, Features& features) {
    const std::size_t count = block.features.size();
    features.undistorted.resize(count);
    features.map_points.resize(count);
    features.descriptors.resize(count);
    std::size_t described = 0;
    for (std::size_t row = 0; row < count; ++row) {
      Keypoint& keypoint = features.undistorted[row];
      keypoint = detail::KeypointAt(0, 0);
      ForEachField(file, block.features[row], [&](const ProtoField& field) {
        if (field.number == 2 && field.value != 0) features.map_points[row] = MapPointId(field.value);
        if (field.number == 3) ReadKeypoint(file, BytesOf(file, field), keypoint);
        if (field.number != 4) return;
        ReadDescriptor(file, BytesOf(file, field), features.descriptors[row]);
        ++described;
      });
    }
    if (described == count) return;
    features.descriptors.clear();  // an atlas has one for each keypoint, or none
    undescribed_ += described;
  }

  static void ReadKeypoint(const ProtoFile& file, std::string_view message, Keypoint& keypoint) {
    ForEachField(file, message, [&](const ProtoField& field) {
      if (field.number == 1) keypoint.x = field.AsFloat();
      if (field.number == 2) keypoint.y = field.AsFloat();
      if (field.number == 3) keypoint.angle = field.AsFloat();
      if (field.number != 4) return;
      static const ScalePyramid kPyramid = DerivePyramid(kMostOctaves, 1.2F);
      const float octave = field.AsFloat();
      keypoint.octave = octave >= 0 && octave < kMostOctaves ? static_cast<std::int32_t>(octave) : 0;
      keypoint.size = detail::PatchAt(keypoint.octave, kPyramid);
    });
  }

  // A message that was cut off between two of its elements is whole to protobuf; the count alone tells.
  static void Compare(const ProtoFile& file, const Side& side, std::uint64_t count, std::string_view what) {
    if (side.count && *side.count != count)
      throw Error(ErrorKind::kDamaged, file.path, "",
                  Concat("holds ", Counted(count, what), ", its header says ", *side.count,
                         "; the file was cut off, or is another map's"));
  }

  void Tell() {
    notices_.Note(
        "an osmap map knows keypoints by their undistorted positions, and cameras without distortion; diameters of "
        "keypoints are those of their octaves, responses are 0, the vocabulary has no name");
    if ((header_.options & kPointFeaturesOnly) != 0)
      notices_.Warn("the map was saved without the keypoints that see no point");
  }

  std::string path_;
  const ReadOptions& options_;
  Notices& notices_;
  Header header_;
  std::vector<std::string> sides_;
  detail::FilesRead files_;
  Atlas atlas_;
  detail::PinholeCameras cameras_;
  std::atomic<std::uint64_t> undescribed_ = 0;  // descriptors of keyframes that have too few
};

}  // namespace

Atlas Read(const Source& source, const ReadOptions& options, Notices& notices) {
  if (!source.is_file())
    throw Error(ErrorKind::kUsage, source.path, "", "an osmap map is four files: give the path of its .yaml file");
  Atlas atlas = MapReader(source, options, notices).Read();
  detail::Select(options.selection, atlas);
  return atlas;
}

}  // namespace slamdb::osmap
