// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/orbslam3/detail/class_table.h"
#include "slamdb/model/detail/packing.h"

// A fork's layout, made ready: for each class a list of what to do, member by member.
//   a member that the model knows, of the type that ORB-SLAM3 v1.0 has: a step of layout.h
//   anything else: packed into Carried::members, by the type that the layout says
//   the same, of a member that the model knows in another type: it is converted into the model besides
namespace slamdb::orbslam3 {

using detail::ByteReader;
using detail::ByteWriter;

// The type of a carried member, with the numbers of its classes.
struct TypeNode {
  enum class Kind : std::uint8_t {
    kNumbers,  // `count` of them
    kVector,   // of numbers
    kString,
    kArray,  // `count` times the child
    kList,   // vectors of anything else, sets, lists
    kMap,
    kClass,  // with class info unless wire_class is kCount; the children are its members
    kMatrix,
    kMatrix2,
    kKeypoints,
    kPointer,
  };
  Kind kind = Kind::kNumbers;
  LayoutType::Number number = LayoutType::Number::kU8;
  std::uint32_t count = 1;
  WireClass wire_class = WireClass::kCount;  // of a pointer: what it is declared to point to; kCount when abstract
  WireClass pair_class = WireClass::kCount;
  std::string class_name;  // kPointer
  bool to_camera = false;  // kPointer
  bool has_info = true;    // kList: Boost writes no class info for sets and lists of numbers
  std::vector<TypeNode> children;
  std::uint32_t run_bytes = 0;  // of a class: its first `run_nodes` members are so many bytes, where longs have 8
  std::uint32_t run_nodes = 0;
};

// How many bytes a number has in Carried::members.
std::size_t WidthOf(LayoutType::Number number);

// How many bytes Carried::members has of nothing of the type: zeros, empty lists, null pointers.
std::uint64_t BytesOfNothing(const TypeNode& node);

// What a carried member means to the model.
template <class Entity>
class Conversion {
 public:
  virtual ~Conversion() = default;
  // Fills the entity's member. False: nothing sensible.
  virtual bool Decode(Bytes bytes, Entity& entity) const = 0;
  virtual void Encode(const Entity& entity, ByteWriter& out) const = 0;
  // Whether the member of both is the same.
  virtual bool Same(const Entity& a, const Entity& b) const = 0;
};

struct NoEntity {};

template <class Entity>
struct Op {
  enum class Kind : std::uint8_t {
    kStep,            // step `index` of StepTable
    kCarried,         // `nodes`
    kClassInfo,       // of wire_class
    kPreintegration,  // the members of KeyFrame::preintegration
    kMaps,
    kCameras,
    kKeyFrames,
    kPoints,
  };
  Kind kind = Kind::kStep;
  std::size_t index = 0;
  WireClass wire_class = WireClass::kCount;     // kClassInfo, and of lists
  WireClass element_class = WireClass::kCount;  // what a list of pointers is declared to hold; kCount when abstract
  std::string name;
  std::vector<TypeNode> nodes;
  std::shared_ptr<const Conversion<Entity>> conversion;
};

template <class Entity>
using Program = std::vector<Op<Entity>>;

struct CameraClass {
  std::string name, exported;
  WireClass wire_class;
  std::optional<CameraModel> model;  // none: the model has no such camera
  Program<Camera> program;
};

class ForkProgram {
 public:
  // Throws Error (kUnsupported) for layouts whose objects hold each other through pointers, and that are of no atlas.
  explicit ForkProgram(Layout layout);

  Layout layout;
  Program<Atlas> root, atlas;  // root: what is saved beside the atlas, with kMaps standing for it
  Program<Map> map;
  Program<KeyFrame> keyframe;
  Program<MapPoint> point;
  Program<ImuPreintegration> preintegration;
  std::vector<CameraClass> cameras;
  std::vector<WireClass> registered;  // by the atlas

  // Names of the members that the model does not know, of a class: `mpCamera3, NSideLeft`.
  std::vector<std::string> foreign_atlas, foreign_map, foreign_keyframe, foreign_point, foreign_camera;
  // Members of v1.0 that it lacks: `KeyFrame.mvuRight`.
  std::vector<std::string> missing;
  bool Lacks(std::string_view member) const;
  bool lacks_stereo = false, lacks_origins = false;  // mvuRight and mnOriginMapId of keyframes, which are derived

  const CameraClass* FindCamera(WireClass wire_class) const;
  const CameraClass* FindCamera(CameraModel model) const;
  // By the key under which it is exported, or its name.
  const CameraClass* FindExported(std::string_view key) const;
};

}  // namespace slamdb::orbslam3
