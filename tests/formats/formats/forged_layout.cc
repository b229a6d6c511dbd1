// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/formats/forged_layout.h"

#include "slamdb/formats/orbslam3/detail/fork_program.h"
#include "slamdb/formats/orbslam3/detail/fork_values.h"

namespace slamdb {
namespace {

using orbslam3::ForkProgram;
using orbslam3::Op;
using orbslam3::Program;
using orbslam3::TypeNode;

class Forger {
 public:
  explicit Forger(const Layout& layout) : program_(layout) {}

  void Forge(Atlas& atlas) {
    atlas.layout = program_.layout.id;
    if (program_.FindCamera(CameraModel::kEquirectangular) != nullptr) AddEquirectangular(atlas);
    for (Camera& camera : atlas.cameras)
      if (const auto* of = program_.FindCamera(camera.model)) Fill(of->program, camera, camera.carried);
    for (Map& map : atlas.maps) {
      Fill(program_.map, map, map.carried);
      for (KeyFrame& keyframe : map.keyframes) Fill(program_.keyframe, keyframe, keyframe.carried);
      for (MapPoint& point : map.points) Fill(program_.point, point, point.carried);
    }
    Fill(program_.root, atlas, atlas.carried);
  }

 private:
  static void AddEquirectangular(Atlas& atlas) {
    Camera& camera = atlas.cameras.emplace_back();
    camera.id = CameraId(atlas.next_ids.camera++);
    camera.model = CameraModel::kEquirectangular;
    camera.recorded_type = 2;
    camera.parameters = {1920, 960};
  }

  template <class Entity>
  void Fill(const Program<Entity>& program, const Entity& entity, Boxed<Carried>& carried) {
    out_.Clear();
    Put(program, entity);
    const Bytes bytes = out_.bytes();
    if (!bytes.empty()) carried.Make().members.assign(bytes.begin(), bytes.end());
  }

  template <class Entity>
  void Put(const Program<Entity>& program, const Entity& entity) {
    for (const Op<Entity>& op : program) {
      if constexpr (std::is_same_v<Entity, KeyFrame>)
        if (op.kind == Op<Entity>::Kind::kPreintegration) Put(program_.preintegration, entity.preintegration);
      if constexpr (std::is_same_v<Entity, Atlas>)
        if (op.kind == Op<Entity>::Kind::kMaps && &program == &program_.root) Put(program_.atlas, entity);
      if (op.kind != Op<Entity>::Kind::kCarried) continue;
      if (op.conversion)
        op.conversion->Encode(entity, out_);
      else
        for (const TypeNode& node : op.nodes) PutSome(node);
    }
  }

  void PutSome(const TypeNode& node) {
    using Kind = TypeNode::Kind;
    constexpr std::uint64_t kEntries = 2;
    switch (node.kind) {
      case Kind::kNumbers:
        return PutNumbers(node.number, node.count);
      case Kind::kVector:
        out_.Put(kEntries);
        return PutNumbers(node.number, kEntries);
      case Kind::kString:
        out_.Put(std::uint64_t{1});
        return PutNumbers(LayoutType::Number::kU8, 1);
      case Kind::kArray:
        for (std::uint32_t i = 0; i < node.count; ++i) PutSome(node.children[0]);
        return;
      case Kind::kList:
        out_.Put(kEntries);
        for (std::uint64_t i = 0; i < kEntries; ++i) PutSome(node.children[0]);
        return;
      case Kind::kMap:
        out_.Put(kEntries);
        for (std::uint64_t i = 0; i < kEntries; ++i)
          for (const TypeNode& child : node.children) PutSome(child);
        return;
      case Kind::kClass:
        for (const TypeNode& child : node.children) PutSome(child);
        return;
      case Kind::kKeypoints:
        out_.Put(std::int32_t{1});
        PutNumbers(LayoutType::Number::kF32, 5);
        return PutNumbers(LayoutType::Number::kI32, 2);
      case Kind::kMatrix:
      case Kind::kMatrix2:
      case Kind::kPointer:
        return orbslam3::PutNothing(node, out_);
    }
  }

  // 1 to 100, again and again: letters, levels and ids among them.
  void PutNumbers(LayoutType::Number number, std::uint64_t count) {
    using N = LayoutType::Number;
    for (; count > 0; --count) {
      next_ = next_ % 100 + 1;
      if (number == N::kF32)
        out_.Put(static_cast<float>(next_) + 0.5F);
      else if (number == N::kF64)
        out_.Put(static_cast<double>(next_) + 0.5);
      else if (number == N::kBool)
        out_.Put(std::uint8_t{1});
      else
        out_.PutBytes(std::as_bytes(std::span(&next_, 1)).first(orbslam3::WidthOf(number)));
    }
  }

  const ForkProgram program_;
  orbslam3::ByteWriter out_;
  std::uint64_t next_ = 0;
};

}  // namespace

void ForgeLayout(const Layout& layout, Atlas& atlas) { Forger(layout).Forge(atlas); }

}  // namespace slamdb
