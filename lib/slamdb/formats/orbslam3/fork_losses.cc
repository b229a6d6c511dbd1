// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/fork_losses.h"

#include <algorithm>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/detail/member_forms.h"
#include "slamdb/formats/orbslam3/detail/encoder.h"
#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/formats/orbslam3/detail/fork_files.h"
#include "slamdb/formats/orbslam3/detail/fork_steps.h"
#include "slamdb/model/detail/carried_members.h"

namespace slamdb::orbslam3 {
namespace {

using detail::Concat;

// ---- Members of a fork

struct Carriers {
  std::uint64_t keyframes = 0, points = 0, others = 0;
};

Carriers CountCarriers(const Atlas& atlas) {
  Carriers count{.others = detail::HasMembers(atlas.carried) ? 1U : 0U};
  for (const Map& map : atlas.maps) {
    count.others += detail::HasMembers(map.carried);
    for (const KeyFrame& keyframe : map.keyframes) count.keyframes += detail::HasMembers(keyframe.carried);
    for (const MapPoint& point : map.points) count.points += detail::HasMembers(point.carried);
  }
  for (const Camera& camera : atlas.cameras) count.others += detail::HasMembers(camera.carried);
  return count;
}

std::string Of(const std::string& names, std::uint64_t count, std::string_view one, std::string_view many) {
  return Concat(names, " of ", detail::Thousands(count), " ", count == 1 ? one : many);
}

// What is lost of an atlas whose carried members cannot be written.
std::string Dropped(const Atlas& atlas) {
  const Carriers count = CountCarriers(atlas);
  if (count.keyframes + count.points + count.others == 0) return {};
  if (IsOwnLayout(atlas.layout))
    return Concat("the members of a fork that ", detail::Thousands(count.keyframes), " keyframes and ",
                  detail::Thousands(count.points), " map points carry");
  return ForeignMembers(ForkProgram(LayoutOf(atlas.layout)), count.keyframes, count.points, count.others);
}

// ---- Members of v1.0

// The bytes of a member as v1.0 writes it.
template <class Step, class Entity>
std::string BytesOf(const Step& step, const Entity& entity) {
  slamdb::detail::Pieces pieces;
  const ArchiveEncoding encoding;
  Encoder<BinaryOutput> encoder(BinaryOutput(pieces, encoding), ClassTable(encoding));
  step.run(encoder, step.name, entity);
  std::string bytes;
  pieces.ForEach([&](Bytes all) { bytes.assign(reinterpret_cast<const char*>(all.data()), all.size()); });
  return bytes;
}

// The members of a class that the model has and a program neither reads nor converts.
template <class Entity>
class LackedMembers {
 public:
  template <class OpsOf>
  explicit LackedMembers(const Program<OpsOf>& program, const std::string& prefix = {}) {
    const auto& steps = StepTable<Encoder<BinaryOutput>, const Entity>::Steps();
    for (std::size_t row = 0; row < steps.size(); ++row)
      if (!IsHeld(program, row, steps[row].name)) lacked_.push_back({prefix + steps[row].name, &steps[row]});
  }

  bool empty() const { return lacked_.empty(); }
  void Forget(std::string_view name) {
    std::erase_if(lacked_, [name](const Lacked& lacked) { return lacked.name == name; });
  }
  void Rename(std::string_view name, std::string_view other) {
    for (Lacked& lacked : lacked_)
      if (lacked.name == name) lacked.name = other;
  }
  // `nothing`: an entity that has none of them; `back`: what is read back of this one.
  void Count(const Entity& entity, const Entity& nothing, const Entity& back) {
    ++entities_;
    for (Lacked& lacked : lacked_) {
      if (lacked.lost) continue;
      const std::string bytes = BytesOf(*lacked.step, entity);
      const auto are_of = [&](const Entity& other) { return bytes == BytesOf(*lacked.step, other); };
      lacked.lost = !are_of(nothing) && !are_of(back);
    }
  }
  // Those that some entity has; all of them lose these: `mbf, mb of 14 keyframes`.
  void Tell(std::string_view one, std::string_view many, std::string& text) const {
    std::vector<std::string> names;
    for (const Lacked& lacked : lacked_)
      if (lacked.lost) names.push_back(lacked.name);
    if (!names.empty()) text += (text.empty() ? "" : "; ") + Of(Listed(names), entities_, one, many);
  }

 private:
  using Step = MemberStep<Encoder<BinaryOutput>, const Entity>;
  struct Lacked {
    std::string name;
    const Step* step;
    bool lost = false;
  };

  template <class OpsOf>
  static bool IsHeld(const Program<OpsOf>& program, std::size_t row, std::string_view name) {
    using OpKind = typename Op<OpsOf>::Kind;
    return std::ranges::any_of(program, [&](const Op<OpsOf>& op) {
      if (op.kind == OpKind::kStep) return op.index == row;
      return (op.conversion || op.kind == OpKind::kPreintegration) && layouts::NameOf(op.name) == name;
    });
  }

  std::vector<Lacked> lacked_;
  std::uint64_t entities_ = 0;
};

// A matrix without rows says nothing, whichever way it is written.
KeyFrame NothingLike(const KeyFrame& keyframe) {
  KeyFrame nothing;
  nothing.features.descriptors_form = keyframe.features.descriptors_form;
  return nothing;
}
MapPoint NothingLike(const MapPoint& point) {
  MapPoint nothing;
  nothing.descriptor_form = point.descriptor_form;
  return nothing;
}

void TellKeyFrames(const Atlas& atlas, const ForkProgram& program, std::string& text) {
  LackedMembers<KeyFrame> members(program.keyframe);
  const bool has_imu = std::ranges::find(program.keyframe, Op<KeyFrame>::Kind::kPreintegration, &Op<KeyFrame>::kind) !=
                       program.keyframe.end();
  LackedMembers<ImuPreintegration> of_imu(has_imu ? program.preintegration : Program<ImuPreintegration>(),
                                          "mBackupImuPreintegrated.");
  if (members.empty() && (!has_imu || of_imu.empty())) return;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      const KeyFrame nothing = NothingLike(keyframe);
      KeyFrame back = nothing;
      back.features.keypoints = keyframe.features.keypoints;
      DeriveLacking(program, map, FeatureColumns::kAll, back);
      members.Count(keyframe, nothing, back);
      if (has_imu) of_imu.Count(keyframe.preintegration, {}, {});
    }
  members.Tell("keyframe", "keyframes", text);
  of_imu.Tell("keyframe", "keyframes", text);
}

// The two sides of observations are one member of the model, which a layout may have half of.
void TellPoints(const Atlas& atlas, const ForkProgram& program, std::string& text) {
  constexpr std::string_view kLeft = "mBackupObservationsId1", kRight = "mBackupObservationsId2";
  Program<MapPoint> sides, rest;
  for (const Op<MapPoint>& op : program.point)
    (op.conversion && (op.name == kLeft || op.name == kRight) ? sides : rest).push_back(op);
  LackedMembers<MapPoint> members(sides.size() == 2 ? program.point : rest);
  for (const char* tracking : {"mnOriginMapId", "mnVisible", "mnFound"}) members.Forget(tracking);  // are none of v1.0
  if (sides.size() == 1 && sides.front().name == kLeft) members.Rename(kLeft, kRight);
  if (members.empty()) return;
  for (const Map& map : atlas.maps)
    for (const MapPoint& point : map.points) {
      const MapPoint nothing = NothingLike(point);
      MapPoint back = nothing;
      for (const Op<MapPoint>& side : sides) {
        ByteWriter packed;
        side.conversion->Encode(point, packed);
        side.conversion->Decode(packed.bytes(), back);
      }
      for (Observation& observation : back.observations)  // what is absent says no more than `not seen`
        for (const auto side : {&Observation::left, &Observation::right})
          observation.*side = std::max(observation.*side, -1);
      members.Count(point, nothing, back);
    }
  members.Tell("map point", "map points", text);
}

void TellOthers(const Atlas& atlas, const ForkProgram& program, std::string& text) {
  LackedMembers<Map> of_maps(program.map);
  for (const Map& map : atlas.maps) of_maps.Count(map, {}, {});
  of_maps.Tell("map", "maps", text);
  for (const CameraClass& of : program.cameras) {
    LackedMembers<Camera> of_cameras(of.program);
    for (const Camera& camera : atlas.cameras)
      if (camera.model == of.model) of_cameras.Count(camera, {}, {});
    of_cameras.Tell("camera", "cameras", text);
  }
  LackedMembers<Counters> of_atlas(program.atlas);
  if (program.Lacks("Atlas.KeyFrame::nNextId"))  // then all are derived
    for (const char* name :
         {"Map::nNextId", "Frame::nNextId", "KeyFrame::nNextId", "MapPoint::nNextId", "GeometricCamera::nNextId"})
      of_atlas.Forget(name);
  of_atlas.Count(atlas.next_ids, {}, {});
  of_atlas.Tell("atlas", "atlases", text);
  const auto tell = [&](std::string_view name, std::size_t count, std::string_view one, std::string_view many) {
    if (count > 0) text += (text.empty() ? "" : "; ") + Of(std::string(name), count, one, many);
  };
  if (std::ranges::find(program.atlas, Op<Atlas>::Kind::kCameras, &Op<Atlas>::kind) == program.atlas.end())
    tell("mvpCameras", atlas.cameras.size(), "camera", "cameras");
  const auto names = std::ranges::count(program.root, Op<Atlas>::Kind::kStep, &Op<Atlas>::kind);
  tell("name and checksum", names < 2 && !atlas.vocabulary.name.empty() ? 1 : 0, "vocabulary", "vocabularies");
}

}  // namespace

bool IsOfSameLayout(const Atlas& atlas, const std::string& layout) {
  if (IsOwnLayout(atlas.layout) || IsOwnLayout(layout)) return false;
  return atlas.layout == layout || SameBytes(LayoutOf(layout), LayoutOf(atlas.layout));
}

std::string TitleOf(const Layout& layout) { return layout.id.empty() ? "of a file" : layout.id; }

std::string Listed(std::span<const std::string> texts, std::string_view between, std::size_t most) {
  std::string listed;
  for (std::size_t i = 0; i < std::min(texts.size(), most); ++i)
    listed += Concat(i == 0 ? std::string_view() : between, texts[i]);
  if (texts.size() <= most) return listed;
  return Concat(listed, between == "; " ? "; and " : " and ", texts.size() - most, " more");
}

std::string ForeignMembers(const ForkProgram& program, std::uint64_t keyframes, std::uint64_t points,
                           std::uint64_t others) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& names, std::uint64_t count, std::string_view one,
                       std::string_view many) {
    if (!names.empty() && count > 0) text += (text.empty() ? "" : "; ") + Of(Listed(names), count, one, many);
  };
  add(program.foreign_keyframe, keyframes, "keyframe", "keyframes");
  add(program.foreign_point, points, "map point", "map points");
  std::vector<std::string> names = program.foreign_atlas;
  names.insert(names.end(), program.foreign_map.begin(), program.foreign_map.end());
  names.insert(names.end(), program.foreign_camera.begin(), program.foreign_camera.end());
  std::ranges::sort(names);  // cameras of two classes have members of one name
  names.erase(std::unique(names.begin(), names.end()), names.end());
  add(names, others, "other entity", "others: the atlas, maps and cameras");
  return text;
}

std::vector<std::string> LossesInLayout(const Atlas& atlas, const std::string& layout) {
  std::vector<std::string> losses;
  const auto lose = [&](const std::string& title, const std::string& members) {
    if (!members.empty()) losses.push_back(Concat("the layout ", title, " cannot hold ", members));
  };
  if (IsOwnLayout(layout)) {
    for (const Camera& camera : atlas.cameras)
      if (camera.model == CameraModel::kEquirectangular)
        throw Error(ErrorKind::kNotPossible, "", ToString(camera.id),
                    "is equirectangular, for which ORB-SLAM3 v1.0 has no class");
    lose("v1.0", Dropped(atlas));
    return losses;
  }
  const ForkProgram program(LayoutOf(layout));
  if (!IsOfSameLayout(atlas, layout)) lose(TitleOf(program.layout), Dropped(atlas));
  std::string lacked;
  TellKeyFrames(atlas, program, lacked);
  TellPoints(atlas, program, lacked);
  TellOthers(atlas, program, lacked);
  lose(TitleOf(program.layout), lacked);
  return losses;
}

Content HeldBy(const Atlas& atlas, const std::string& layout) {
  const Content held = Content::kAtlas | Content::kCarried;
  if (IsOwnLayout(layout)) return held;
  const ForkProgram program(LayoutOf(layout));
  if (std::ranges::find(program.point, "mnVisible", &Op<MapPoint>::name) == program.point.end()) return held;
  const auto has_origin = [](const Map& map) {
    return std::ranges::any_of(map.points,
                               [](const MapPoint& point) { return point.origin_map != MapPoint::kNoOrigin; });
  };
  return std::ranges::none_of(atlas.maps, has_origin) ? held | Content::kTracking : held;
}

}  // namespace slamdb::orbslam3
