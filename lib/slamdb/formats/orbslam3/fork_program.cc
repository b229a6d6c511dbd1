// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/fork_program.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/member_forms.h"
#include "slamdb/formats/orbslam3/detail/fork_conversions.h"
#include "slamdb/formats/orbslam3/detail/fork_steps.h"
#include "slamdb/formats/orbslam3/detail/number_archive.h"

namespace slamdb::orbslam3 {
namespace {

using detail::Concat;
using LayoutKind = LayoutType::Kind;

// The classes that ORB-SLAM3 has too, by the type that a layout gives them.
struct KnownClass {
  std::string_view type;
  WireClass wire_class;
};
constexpr std::array kKnownClasses = std::to_array<KnownClass>({
    {"Atlas", WireClass::kAtlas},
    {"Pinhole", WireClass::kPinhole},
    {"KannalaBrandt8", WireClass::kKannalaBrandt8},
    {"vec<ptr<Map>>", WireClass::kMapList},
    {"Map", WireClass::kMap},
    {"vec<ptr<KeyFrame>>", WireClass::kKeyFrameList},
    {"KeyFrame", WireClass::kKeyFrame},
    {"vec<f32>", WireClass::kFloats},
    {"BowVector", WireClass::kBowVector},
    {"map<u32,f64>", WireClass::kBowMap},
    {"pair map<u32,f64>", WireClass::kBowPair},
    {"FeatureVector", WireClass::kFeatureVector},
    {"map<u32,vec<u32>>", WireClass::kFeatureMap},
    {"pair map<u32,vec<u32>>", WireClass::kFeaturePair},
    {"vec<u32>", WireClass::kUnsigneds},
    {"vec<i64>", WireClass::kLongLongs},
    {"vec<vec<vec<size>>>", WireClass::kGrid},
    {"vec<vec<size>>", WireClass::kGridColumn},
    {"vec<size>", WireClass::kSizes},
    {"map<u64,i32>", WireClass::kWeightMap},
    {"pair map<u64,i32>", WireClass::kWeightPair},
    {"vec<u64>", WireClass::kUnsignedLongs},
    {"vec<i32>", WireClass::kInts},
    {"Bias", WireClass::kBias},
    {"Preintegrated", WireClass::kPreintegrated},
    {"vec<val<integrable>>", WireClass::kMeasurementList},
    {"integrable", WireClass::kMeasurement},
    {"Calib", WireClass::kCalib},
    {"vec<ptr<MapPoint>>", WireClass::kMapPointList},
    {"MapPoint", WireClass::kMapPoint},
    {"vec<ptr<GeometricCamera>>", WireClass::kCameraList},
    {"GeometricCamera", WireClass::kGeometricCamera},
});

constexpr std::string_view kEntities[] = {"Atlas", "Map", "KeyFrame", "MapPoint"};

bool IsOneOf(std::string_view name, std::span<const std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

class Compiler {
 public:
  explicit Compiler(const Layout& layout) : layout_(layout), own_(*FindKnownLayout("v1.0")) {}

  [[noreturn]] void Refuse(const std::string& problem) const {
    throw Error(ErrorKind::kUnsupported,
                Concat("layout ", layout_.id.empty() ? "of a file" : layout_.id, ": ", problem));
  }

  WireClass ClassOf(const std::string& type) {
    const auto known = std::find_if(kKnownClasses.begin(), kKnownClasses.end(),
                                    [&](const KnownClass& each) { return each.type == type; });
    if (known != kKnownClasses.end()) return known->wire_class;
    const auto [found, is_new] = classes_.try_emplace(
        type, static_cast<WireClass>(static_cast<std::size_t>(WireClass::kCount) + 1 + classes_.size()));
    if (static_cast<std::size_t>(found->second) >= kMostWireClasses)
      Refuse(Concat("more than ", classes_.size() - 1, " classes that ORB-SLAM3 does not have"));
    return found->second;
  }

  TypeNode NodeOf(const LayoutType& given, int depth = 0) {
    constexpr int kDeepest = 24;
    if (depth > kDeepest) Refuse("its objects hold each other through pointers, which is not read");
    constexpr std::size_t kMostNodes = std::size_t{1} << 16;
    if (++nodes_ > kMostNodes) Refuse(Concat("its classes have more than ", kMostNodes, " members in each other"));
    TypeNode node = NodeOfKind(given.kind == LayoutKind::kVector ? WithSizes(given) : given, depth);
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 20;
    if (BytesOfNothing(node) > kMostBytes)
      Refuse(Concat("a ", ToString(given), " has more than ", kMostBytes, " bytes"));
    return node;
  }
  TypeNode NodeOfKind(const LayoutType& type, int depth) {
    TypeNode node;
    switch (type.kind) {
      case LayoutKind::kNumber:
        node.number = type.number;
        return node;
      case LayoutKind::kString:
        node.kind = TypeNode::Kind::kString;
        return node;
      case LayoutKind::kArray:
        return ArrayOf(type, depth);
      case LayoutKind::kVector:
      case LayoutKind::kSet:
      case LayoutKind::kList:
        return ListOf(type, depth);
      case LayoutKind::kMap:
        node.kind = TypeNode::Kind::kMap;
        node.wire_class = ClassOf(ToString(type));
        node.pair_class = ClassOf("pair " + ToString(type));
        for (const LayoutType& element : type.elements) node.children.push_back(ElementOf(element, depth));
        return node;
      case LayoutKind::kValue:
      case LayoutKind::kRaw:
        return ClassNode(type, depth);
      case LayoutKind::kMatrix:
        node.kind = TypeNode::Kind::kMatrix;
        return node;
      case LayoutKind::kMatrix2:
        node.kind = TypeNode::Kind::kMatrix2;
        node.wire_class = ClassOf("Mat");
        return node;
      case LayoutKind::kKeypoints:
        node.kind = TypeNode::Kind::kKeypoints;
        return node;
      case LayoutKind::kPointer:
        return PointerTo(type, depth);
    }
    return node;
  }

  bool IsCamera(const std::string& name) const {
    if (name == "GeometricCamera") return true;
    const LayoutClass* of = layout_.Find(name);
    return of != nullptr && std::ranges::any_of(of->members, [](const LayoutMember& member) {
             return member.type == "val<GeometricCamera>" || member.type == "raw<GeometricCamera>";
           });
  }

  // Whether the class, and all in it, is as in v1.0.
  bool IsOwn(const std::string& name) const {
    const LayoutClass *of = layout_.Find(name), *own = own_.Find(name);
    if (of == nullptr || own == nullptr || of->members.size() != own->members.size()) return false;
    for (std::size_t i = 0; i < of->members.size(); ++i)
      if (of->members[i].type != own->members[i].type || !IsOwn(ParseLayoutType(of->members[i].type))) return false;
    return true;
  }
  bool IsOwn(const LayoutType& type) const {
    const bool holds = type.kind == LayoutKind::kValue || type.kind == LayoutKind::kRaw;
    return (!holds || IsOwn(type.name)) &&
           std::ranges::all_of(type.elements, [this](const LayoutType& element) { return IsOwn(element); });
  }

  // Which type the model expects of a member; null for one that it does not know.
  static const LayoutType* ModelTypeOf(std::string_view of_class, std::string_view name) {
    static const LayoutType kCount{.number = LayoutType::Number::kI32}, kOrigin{.number = LayoutType::Number::kU32};
    if (of_class == "MapPoint" && (name == "mnVisible" || name == "mnFound")) return &kCount;
    if (of_class == "MapPoint" && name == "mnOriginMapId") return &kOrigin;
    return layouts::OwnTypeOf(of_class, name);
  }

  template <class Entity, class StepsOf = Entity>
  void Add(const LayoutClass& of, Program<Entity>& program, std::vector<std::string>& foreign) {
    for (std::size_t i = 0; i < of.members.size();) i += AddMember<Entity, StepsOf>(of, i, program, foreign);
  }

  void AddCamera(const LayoutClass& of, Program<Camera>& program, std::vector<std::string>& foreign) {
    in_camera_ = true;
    Add<Camera>(of, program, foreign);
    in_camera_ = false;
  }

 private:
  // vector<vector<size_t>> is what grids consist of; vector<unsigned long> alone are ids.
  static LayoutType WithSizes(LayoutType type, bool nested = false) {
    LayoutType& element = type.elements.front();
    if (element.kind == LayoutKind::kVector)
      element = WithSizes(element, true);
    else if (nested && element.kind == LayoutKind::kNumber && element.number == LayoutType::Number::kU64)
      element.number = LayoutType::Number::kSize;
    return type;
  }

  // What a container holds. Elements without bytes could be any number of them.
  TypeNode ElementOf(const LayoutType& type, int depth) {
    TypeNode element = NodeOf(type, depth + 1);
    if (BytesOfNothing(element) == 0) Refuse("a container of what has no members");
    return element;
  }
  TypeNode ArrayOf(const LayoutType& type, int depth) {
    TypeNode element = ElementOf(type.elements.front(), depth);
    if (element.kind == TypeNode::Kind::kNumbers && std::uint64_t{element.count} * type.count < (1U << 20)) {
      element.count *= type.count;
      return element;
    }
    TypeNode node{.kind = TypeNode::Kind::kArray, .count = type.count};
    node.children.push_back(std::move(element));
    return node;
  }
  TypeNode ListOf(const LayoutType& type, int depth) {
    TypeNode element = ElementOf(type.elements.front(), depth);
    TypeNode node{.kind = TypeNode::Kind::kList, .wire_class = ClassOf(ToString(type))};
    const bool plain = element.kind == TypeNode::Kind::kNumbers && element.count == 1;
    if (plain && type.kind == LayoutKind::kVector) {
      node.kind = TypeNode::Kind::kVector;
      node.number = element.number;
      return node;
    }
    node.has_info = !plain;
    node.children.push_back(std::move(element));
    return node;
  }
  TypeNode ClassNode(const LayoutType& type, int depth) {
    TypeNode node{.kind = TypeNode::Kind::kClass};
    if (type.kind == LayoutKind::kValue) {
      node.wire_class = ClassOf(type.name);
      RefuseBoth(type.name, values_, pointers_);
    }
    for (const LayoutMember& member : layout_.Find(type.name)->members)
      node.children.push_back(NodeOf(ParseLayoutType(member.type), depth + 1));
    for (const TypeNode& child : node.children) {
      constexpr std::uint32_t kMostBytes = 1U << 20;
      if (child.kind != TypeNode::Kind::kNumbers || node.run_bytes > kMostBytes) break;
      node.run_bytes += static_cast<std::uint32_t>(WidthOf(child.number) * child.count);
      ++node.run_nodes;
    }
    return node;
  }
  // Boost numbers the values of a class as objects, too, once there are pointers to it.
  void RefuseBoth(const std::string& name, std::set<std::string>& these, const std::set<std::string>& others) {
    these.insert(name);
    if (others.contains(name)) Refuse(Concat(name, " stands there by value and behind pointers, which is not read"));
  }
  TypeNode PointerTo(const LayoutType& type, int depth) {
    TypeNode node{.kind = TypeNode::Kind::kPointer, .class_name = type.name};
    if (!layout_.Find(type.name)->abstract) node.wire_class = ClassOf(type.name);
    node.to_camera = IsCamera(type.name);
    if (node.to_camera && in_camera_) Refuse("cameras that point to cameras, which are not read");
    if (node.to_camera || IsOneOf(type.name, kEntities)) return node;
    if (layout_.Find(type.name)->abstract) Refuse(Concat("pointers to the abstract class ", type.name));
    RefuseBoth(type.name, pointers_, values_);
    node.children.push_back(NodeOf({.kind = LayoutKind::kRaw, .name = type.name}, depth + 1));
    return node;
  }

  // Adds member i, and those that belong to it; returns how many those are.
  template <class Entity, class StepsOf>
  std::size_t AddMember(const LayoutClass& of, std::size_t i, Program<Entity>& program,
                        std::vector<std::string>& foreign) {
    const LayoutMember& member = of.members[i];
    const LayoutType type = ParseLayoutType(member.type);
    if (AddList(member, type, program)) return 1;
    if (AddPart<Entity, StepsOf>(member, type, program, foreign)) return 1;
    const bool twice = std::any_of(of.members.begin(), of.members.begin() + static_cast<std::ptrdiff_t>(i),
                                   [&](const LayoutMember& other) { return other.name == member.name; });
    const LayoutType* expected = ModelTypeOf(of.name, member.name);
    const bool same_type = expected != nullptr && *expected == type && IsOwn(type);
    const bool observations = std::is_same_v<Entity, MapPoint> && member.name == "mBackupObservationsId1";
    const bool has_second = i + 1 < of.members.size() && of.members[i + 1].name == "mBackupObservationsId2" &&
                            of.members[i + 1].type == member.type;
    if (same_type && !twice && (!observations || has_second)) {
      const auto& steps = StepTable<NumberArchive<false>, const StepsOf>::Steps();
      for (std::size_t step = 0; step < steps.size(); ++step) {
        if (steps[step].name != member.name) continue;
        program.push_back({.kind = Op<Entity>::Kind::kStep, .index = step, .name = member.name});
        return observations ? 2 : 1;
      }
    }
    return AddCarried(of, i, twice, program, foreign);
  }

  template <class Entity>
  std::size_t AddCarried(const LayoutClass& of, std::size_t i, bool twice, Program<Entity>& program,
                         std::vector<std::string>& foreign) {
    Op<Entity> op{.kind = Op<Entity>::Kind::kCarried, .name = of.members[i].name};
    const std::size_t behind = std::min(i + 2, of.members.size());
    const std::span<const LayoutMember> members(of.members.data() + i, behind - i);
    for (const LayoutMember& member : members) op.nodes.push_back(NodeOf(ParseLayoutType(member.type)));
    FoundConversion<Entity> found;
    const LayoutType* own = ModelTypeOf(of.name, layouts::NameOf(op.name));
    for (const char* camera : {"GeometricCamera", "KannalaBrandt8"})
      if (own == nullptr && in_camera_) own = ModelTypeOf(camera, op.name);
    if (!twice && own != nullptr) found = FindConversion<Entity>(members, op.nodes, *own);
    op.conversion = found.conversion;
    op.nodes.resize(found.conversion ? found.members : 1);
    if (!found.conversion) foreign.push_back(op.name);
    const std::size_t taken = op.nodes.size();
    program.push_back(std::move(op));
    return taken;
  }

  // The lists of the model.
  template <class Entity>
  bool AddList(const LayoutMember& member, const LayoutType& type, Program<Entity>& program) {
    const bool of_pointers = !type.elements.empty() && type.elements.front().kind == LayoutKind::kPointer;
    if (!of_pointers || type.kind == LayoutKind::kMap) return false;
    const std::string& target = type.elements.front().name;
    auto kind = Op<Entity>::Kind::kStep;
    if constexpr (std::is_same_v<Entity, Atlas>) {
      if (member.name == "mvpBackupMaps" && target == "Map") kind = Op<Entity>::Kind::kMaps;
      if (member.name == "mvpCameras" && IsCamera(target)) kind = Op<Entity>::Kind::kCameras;
    } else if constexpr (std::is_same_v<Entity, Map>) {
      if (member.name == "mvpBackupKeyFrames" && target == "KeyFrame") kind = Op<Entity>::Kind::kKeyFrames;
      if (member.name == "mvpBackupMapPoints" && target == "MapPoint") kind = Op<Entity>::Kind::kPoints;
    }
    if (kind == Op<Entity>::Kind::kStep) return false;
    if (type.kind != LayoutKind::kVector) Refuse(Concat(member.name, " is of type ", member.type, ", expected a vec"));
    const bool abstract = layout_.Find(target)->abstract;
    program.push_back({.kind = kind,
                       .wire_class = ClassOf(ToString(type)),
                       .element_class = abstract ? WireClass::kCount : ClassOf(target),
                       .name = member.name});
    return true;
  }

  // The base class of cameras, and a preintegration that is another than v1.0's: their members one by one.
  template <class Entity, class StepsOf>
  bool AddPart(const LayoutMember& member, const LayoutType& type, Program<Entity>& program,
               std::vector<std::string>& foreign) {
    const bool is_value = type.kind == LayoutKind::kValue || type.kind == LayoutKind::kRaw;
    if (!is_value) return false;
    const auto class_info = [&] {
      if (type.kind == LayoutKind::kValue)
        program.push_back({.kind = Op<Entity>::Kind::kClassInfo, .wire_class = ClassOf(type.name)});
    };
    if constexpr (std::is_same_v<Entity, Camera>) {
      if (type.name != "GeometricCamera") return false;
      class_info();
      Add<Entity, StepsOf>(*layout_.Find(type.name), program, foreign);
      return true;
    } else if constexpr (std::is_same_v<Entity, KeyFrame>) {
      const bool is_preintegration = member.name == "mBackupImuPreintegrated" && type.name == "Preintegrated";
      if (!is_preintegration || IsOwn(type.name)) return false;
      class_info();
      program.push_back({.kind = Op<Entity>::Kind::kPreintegration, .name = member.name});
      return true;
    } else {
      return false;
    }
  }

  const Layout& layout_;
  const Layout& own_;
  std::map<std::string, WireClass> classes_;
  std::set<std::string> values_, pointers_;
  std::size_t nodes_ = 0;
  bool in_camera_ = false;
};

std::optional<CameraModel> ModelOf(const std::string& name) {
  if (name == "Pinhole") return CameraModel::kPinhole;
  if (name == "KannalaBrandt8") return CameraModel::kKannalaBrandt8;
  return name == "Equirectangular" ? std::optional(CameraModel::kEquirectangular) : std::nullopt;
}

// `ORB_SLAM3::Pinhole` is the class Pinhole.
std::string_view WithoutScope(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  return colon == name.npos ? name : name.substr(colon + 1);
}

}  // namespace

std::size_t WidthOf(LayoutType::Number number) {
  std::size_t width = 0;
  layouts::WithNumberType(number, [&](auto zero) { width = sizeof(zero); });
  return width;
}

std::uint64_t BytesOfNothing(const TypeNode& node) {
  using Kind = TypeNode::Kind;
  switch (node.kind) {
    case Kind::kNumbers:
      return WidthOf(node.number) * node.count;
    case Kind::kVector:
    case Kind::kString:
    case Kind::kList:
    case Kind::kMap:
      return sizeof(std::uint64_t);
    case Kind::kArray:
      return BytesOfNothing(node.children[0]) * node.count;
    case Kind::kClass:
      return std::accumulate(node.children.begin(), node.children.end(), std::uint64_t{0},
                             [](std::uint64_t sum, const TypeNode& child) { return sum + BytesOfNothing(child); });
    case Kind::kMatrix:
      return 3 * sizeof(std::int32_t) + 1;
    case Kind::kMatrix2:
      return 2 * sizeof(std::int32_t) + 2 * sizeof(std::uint64_t);
    case Kind::kKeypoints:
      return sizeof(std::int32_t);
    case Kind::kPointer:
      return 1;
  }
  return 0;
}

ForkProgram::ForkProgram(Layout given) : layout(std::move(given)) {
  Compiler compiler(layout);
  for (const char* name : {"Atlas", "Map", "KeyFrame", "MapPoint", "GeometricCamera"})
    if (layout.Find(name) == nullptr) compiler.Refuse(Concat("it has no class ", name, ", so it is of no atlas"));
  for (const std::string_view name : kEntities)
    if (layout.Find(name)->abstract) compiler.Refuse(Concat("its class ", name, " is abstract"));
  if (std::ranges::count(layout.root, "ptr<Atlas>") != 1) compiler.Refuse("its root is no atlas");
  if (!layout.header) compiler.Refuse("files without the header of an archive are not read");
  std::size_t strings = 0;
  for (const std::string& type : layout.root) {
    Op<Atlas> op{.kind = Op<Atlas>::Kind::kCarried, .name = type};
    if (type == "ptr<Atlas>")
      op.kind = Op<Atlas>::Kind::kMaps;
    else if (type == "string" && strings < 2)
      op = {.kind = Op<Atlas>::Kind::kStep, .index = strings++};
    else
      op.nodes.push_back(compiler.NodeOf(ParseLayoutType(type)));
    if (op.kind == Op<Atlas>::Kind::kCarried) foreign_atlas.push_back(type);
    root.push_back(std::move(op));
  }
  for (const LayoutClass& of : layout.classes) {
    if (of.abstract || !compiler.IsCamera(of.name) || of.name == "GeometricCamera") continue;
    cameras.push_back({of.name, of.exported, compiler.ClassOf(of.name), ModelOf(of.name), {}});
    compiler.AddCamera(of, cameras.back().program, foreign_camera);
  }
  for (const std::string& name : layout.Find("Atlas")->registers) registered.push_back(compiler.ClassOf(name));
  compiler.Add<Atlas, Counters>(*layout.Find("Atlas"), atlas, foreign_atlas);
  compiler.Add<Map>(*layout.Find("Map"), map, foreign_map);
  compiler.Add<KeyFrame>(*layout.Find("KeyFrame"), keyframe, foreign_keyframe);
  compiler.Add<MapPoint>(*layout.Find("MapPoint"), point, foreign_point);
  if (const LayoutClass* imu = layout.Find("Preintegrated"))
    compiler.Add<ImuPreintegration>(*imu, preintegration, foreign_keyframe);
  for (const auto& [ops, list] : {std::pair(&atlas, Op<Atlas>::Kind::kMaps)})
    if (std::ranges::find(*ops, list, &Op<Atlas>::kind) == ops->end()) compiler.Refuse("Atlas has no mvpBackupMaps");
  for (const auto list : {Op<Map>::Kind::kKeyFrames, Op<Map>::Kind::kPoints})
    if (std::ranges::find(map, list, &Op<Map>::kind) == map.end())
      compiler.Refuse("Map has no vectors of keyframes and map points");
  const Layout& own = *FindKnownLayout("v1.0");
  for (const LayoutClass& of : own.classes)
    for (const LayoutMember& member : of.members) {
      const LayoutClass* here = layout.Find(of.name);
      const auto is_it = [&](const LayoutMember& other) {
        return other.name == member.name || other.name.starts_with(member.name + ".");
      };
      if (here == nullptr || std::ranges::none_of(here->members, is_it)) missing.push_back(of.name + "." + member.name);
    }
  lacks_stereo = Lacks("KeyFrame.mvuRight");
  lacks_origins = Lacks("KeyFrame.mnOriginMapId");
}

bool ForkProgram::Lacks(std::string_view member) const { return std::ranges::find(missing, member) != missing.end(); }

const CameraClass* ForkProgram::FindCamera(WireClass wire_class) const {
  const auto found = std::ranges::find(cameras, wire_class, &CameraClass::wire_class);
  return found == cameras.end() ? nullptr : &*found;
}
const CameraClass* ForkProgram::FindCamera(CameraModel model) const {
  const auto found = std::ranges::find(cameras, std::optional(model), &CameraClass::model);
  return found == cameras.end() ? nullptr : &*found;
}
const CameraClass* ForkProgram::FindExported(std::string_view key) const {
  const auto found = std::ranges::find_if(cameras, [key](const CameraClass& camera) {
    return (!camera.exported.empty() && camera.exported == key) || camera.name == WithoutScope(key);
  });
  return found == cameras.end() ? nullptr : &*found;
}

}  // namespace slamdb::orbslam3
