// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/layouts/invented_layouts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/orbslam3/detail/fork_program.h"
#include "slamdb/formats/orbslam3/detail/fork_values.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

namespace slamdb::testing {
namespace {

using detail::ByteReader;
using detail::ByteWriter;
using detail::Concat;
using Kind = LayoutType::Kind;
using Number = LayoutType::Number;
using Random = std::mt19937_64;

std::uint64_t Below(Random& random, std::uint64_t end) { return end == 0 ? 0 : random() % end; }
double Uniform(Random& random, double least, double most) {
  return least + (most - least) * static_cast<double>(random() >> 11U) * 0x1p-53;
}
template <class T, std::size_t kCount>
const T& Pick(Random& random, const std::array<T, kCount>& of) {
  return of[Below(random, kCount)];
}

// ---- Layouts

// What forks have put in, the usual more often.
constexpr std::array<const char*, 44> kTypes = {
    "bool",          "u8",           "i32",          "u32",          "f32",        "i64",        "u64",
    "f64",           "bool",         "i32",          "u32",          "f32",        "u64",        "f64",
    "f32",           "arr<f32,3>",   "arr<f64,3>",   "arr<f32,7>",   "arr<f32,2>", "arr<i32,4>", "arr<f64,7>",
    "u16",           "vec<f32>",     "vec<f32>",     "vec<i32>",     "vec<f64>",   "vec<u64>",   "vec<u8>",
    "vec<u16>",      "string",       "string",       "mat",          "mat",        "kps",        "set<u64>",
    "set<i32>",      "map<u64,i32>", "map<u64,f32>", "map<i32,f64>", "list<u64>",  "list<f32>",  "vec<string>",
    "vec<vec<f32>>", "val<Label>"};

// Members without which nothing is a map.
bool IsNeeded(const std::string& name) {
  constexpr std::array<std::string_view, 6> kNeeded = {"mnId",       "mvpBackupMaps",      "mvpCameras",
                                                       "mnGridCols", "mvpBackupKeyFrames", "mvpBackupMapPoints"};
  return std::ranges::find(kNeeded, name) != kNeeded.end();
}

LayoutClass Label() {
  LayoutClass label;
  label.name = "Label";
  label.members = {{"score", "f32"}, {"id", "i32"}, {"known", "bool"}};
  return label;
}

// ---- Values

// How the values of one member go; drawn once for all entities.
struct Habit {
  std::uint64_t lengths = 0, numbers = 0, constant = 0;
};

class Values {
 public:
  Values(const Layout& layout, Random& random) : layout_(layout), random_(random) {
    for (const LayoutClass& of : layout.classes)
      for (const LayoutMember& member : of.members)
        if (IsNew(member.name)) habits_.push_back({&member, {random(), random(), random()}});
  }
  static bool IsNew(std::string_view name) { return name.starts_with("x"); }

  // A value of a member that is new, packed.
  void Add(std::string_view name, ByteWriter& out) {
    const auto known = std::ranges::find_if(habits_, [&](const Known& one) { return one.member->name == name; });
    habit_ = known->habit;
    Put(ParseLayoutType(known->member->type), out);
  }

 private:
  struct Known {
    const LayoutMember* member;
    Habit habit;
  };

  std::uint64_t Length() {
    switch (habit_.lengths % 4) {
      case 0:
        return Below(random_, 6);
      case 1:
        return 1 + Below(random_, 12);
      case 2:
        return 3;
      default:
        return Below(random_, 3) == 0 ? Below(random_, 40) : 0;
    }
  }

  double Real() {
    switch (habit_.numbers % 6) {
      case 0:
        return 0;
      case 1:
        return Uniform(random_, 0, 1);
      case 2:
        return Uniform(random_, -10, 10);
      case 3:
        return Uniform(random_, 0, 700);
      case 4:
        return static_cast<double>(Below(random_, 5));
      default:
        return 1.4e9 + Uniform(random_, 0, 100);
    }
  }
  std::int64_t Whole() {
    switch (habit_.numbers % 6) {
      case 0:
        return 0;
      case 1:
        return static_cast<std::int64_t>(Below(random_, 2));
      case 2:
        return static_cast<std::int64_t>(Below(random_, 100));
      case 3:
        return -1;
      case 4:
        return static_cast<std::int64_t>(habit_.constant % 1000);
      default:
        return static_cast<std::int64_t>(Below(random_, 5000));
    }
  }

  void PutNumber(Number number, ByteWriter& out) {
    switch (number) {
      case Number::kU8:
        return out.Put(static_cast<std::uint8_t>(Whole()));
      case Number::kBool:
        return out.Put(static_cast<std::uint8_t>(habit_.numbers % 3 == 0 ? 0 : Below(random_, 2)));
      case Number::kI16:
      case Number::kU16:
        return out.Put(static_cast<std::uint16_t>(Whole()));
      case Number::kI32:
      case Number::kU32:
        return out.Put(static_cast<std::int32_t>(Whole()));
      case Number::kF32:
        return out.Put(static_cast<float>(Real()));
      case Number::kF64:
        return out.Put(Real());
      default:
        return out.Put(Whole());
    }
  }

  void Put(const LayoutType& type, ByteWriter& out) {
    switch (type.kind) {
      case Kind::kNumber:
        return PutNumber(type.number, out);
      case Kind::kArray:
        for (std::uint32_t i = 0; i < type.count; ++i) Put(type.elements[0], out);
        return;
      case Kind::kString: {
        const std::uint64_t length = Length();
        out.Put(length);
        for (std::uint64_t i = 0; i < length; ++i) out.Put(static_cast<std::uint8_t>('a' + Below(random_, 26)));
        return;
      }
      case Kind::kVector:
      case Kind::kList: {
        const std::uint64_t length = Length();
        out.Put(length);
        for (std::uint64_t i = 0; i < length; ++i) Put(type.elements[0], out);
        return;
      }
      case Kind::kSet:
      case Kind::kMap:
        return PutSorted(type, out);
      case Kind::kValue:
        for (const LayoutMember& member : layout_.Find(type.name)->members) Put(ParseLayoutType(member.type), out);
        return;
      case Kind::kMatrix:
        return PutMatrix(out);
      case Kind::kKeypoints: {
        const auto length = static_cast<std::int32_t>(Length());
        out.Put(length);
        for (std::int32_t i = 0; i < length * 7; ++i) {
          if (i % 7 < 5)
            out.Put(static_cast<float>(Uniform(random_, 0, 640)));
          else
            out.Put(static_cast<std::int32_t>(Below(random_, 8)));
        }
        return;
      }
      default:
        return out.Put(std::uint8_t{0});  // a null pointer
    }
  }
  void PutSorted(const LayoutType& type, ByteWriter& out) {
    const std::uint64_t length = Length();
    out.Put(length);
    std::int64_t key = 0;
    for (std::uint64_t i = 0; i < length; ++i) {
      key += 1 + static_cast<std::int64_t>(Below(random_, 9));
      if (type.elements[0].number == Number::kI32 || type.elements[0].number == Number::kU32)
        out.Put(static_cast<std::int32_t>(key));
      else
        out.Put(key);
      if (type.kind == Kind::kMap) Put(type.elements[1], out);
    }
  }
  // Empty, a 3 x 3 of floats, a row of bytes, or rows of floats.
  void PutMatrix(ByteWriter& out) {
    constexpr std::int32_t kBytes = 0, kFloats = 5;
    std::int32_t columns = 0, rows = 0, type = kBytes;
    if (habit_.lengths % 4 == 1) columns = rows = 3, type = kFloats;
    if (habit_.lengths % 4 == 2) columns = 32, rows = 1;
    if (habit_.lengths % 4 == 3) columns = 8, rows = static_cast<std::int32_t>(Below(random_, 4)), type = kFloats;
    out.Put(columns);
    out.Put(rows);
    out.Put(type);
    out.Put(std::uint8_t{1});
    for (std::int32_t i = 0; i < columns * rows; ++i) {
      if (type == kFloats)
        out.Put(static_cast<float>(Real()));
      else
        out.Put(static_cast<std::uint8_t>(random_()));
    }
  }

  const Layout& layout_;
  Random& random_;
  std::vector<Known> habits_;
  Habit habit_;
};

}  // namespace

Layout Changed(std::string_view changes) {
  Layout layout = KnownLayouts().front();
  layout.id = layout.title = layout.who = "";
  std::istringstream lines{std::string(changes)};
  for (std::string line; std::getline(lines, line, '\n');) {
    const std::size_t dot = line.find('.'), space = std::min(line.find(' '), line.size());
    std::vector<LayoutMember>& members = layout.Find(line.substr(1, dot - 1))->members;
    const auto at = std::ranges::find(members, line.substr(dot + 1, space - dot - 1), &LayoutMember::name);
    const std::size_t colon = std::min(line.find(':', space), line.size());
    const std::string rest = space < line.size() ? line.substr(space + 1) : "";
    const LayoutMember member{rest.substr(0, colon - std::min(colon, space + 1)),
                              colon < line.size() ? line.substr(colon + 1) : ""};
    if (line[0] == '+') members.insert(at + 1, member);
    if (line[0] == '-') members.erase(at);
    if (line[0] == '~') *at = member;
    if (line[0] == '^') std::iter_swap(at - 1, at);
  }
  return layout;
}

Invention InventLayout(Random& random, const InventionOptions& options) {
  constexpr std::array<const char*, 14> kClasses = {"MapPoint", "MapPoint", "MapPoint",        "MapPoint", "KeyFrame",
                                                    "KeyFrame", "KeyFrame", "KeyFrame",        "Map",      "Map",
                                                    "Atlas",    "Atlas",    "GeometricCamera", "KeyFrame"};
  Invention invention{KnownLayouts().front(), {}};
  invention.layout.id = invention.layout.title = invention.layout.who = "";
  invention.layout.classes.push_back(Label());
  const auto any_class = [&]() -> LayoutClass& {
    const std::string name =
        options.classes.empty() ? Pick(random, kClasses) : options.classes[Below(random, options.classes.size())];
    return *invention.layout.Find(name);
  };
  for (int i = 0; i < options.removals;) {
    LayoutClass& of = any_class();
    const std::size_t row = Below(random, of.members.size());
    if (IsNeeded(of.members[row].name) || of.members[row].type.find("val<") == 0) continue;
    invention.changes.push_back(Concat("-", of.name, ".", of.members[row].name));
    of.members.erase(of.members.begin() + static_cast<std::ptrdiff_t>(row));
    ++i;
  }
  for (int i = 0; i < options.insertions; ++i) {
    LayoutClass& of = any_class();
    const std::size_t row = Below(random, of.members.size() + 1);
    const std::string type = Pick(random, kTypes);
    invention.changes.push_back(
        Concat("+", of.name, " ", type, " behind ", row == 0 ? std::string("nothing") : of.members[row - 1].name));
    of.members.insert(of.members.begin() + static_cast<std::ptrdiff_t>(row), {Concat("x", i + 1), type});
  }
  return invention;
}

namespace {

// Gives the carried members of an entity that are new other values.
class Renewer {
 public:
  Renewer(const Layout& layout, Random& random) : program_(layout), values_(program_.layout, random) {}

  void Renew(Atlas& atlas) {
    for (Map& map : atlas.maps) {
      for (KeyFrame& keyframe : map.keyframes) RenewOne(program_.keyframe, keyframe.carried);
      for (MapPoint& point : map.points) RenewOne(program_.point, point.carried);
      RenewOne(program_.map, map.carried);
    }
    for (Camera& camera : atlas.cameras) RenewOne(program_.FindCamera(camera.model)->program, camera.carried);
    RenewOne(program_.atlas, atlas.carried);
  }

 private:
  template <class Entity>
  void RenewOne(const orbslam3::Program<Entity>& program, Boxed<Carried>& carried) {
    if (!carried) return;
    const Column<std::byte> old = carried->members;
    ByteReader in(old);
    ByteWriter out;
    Run(program, in, out);
    const Bytes bytes = out.bytes();
    carried.Make().members.assign(bytes.begin(), bytes.end());
  }
  template <class Entity>
  void Run(const orbslam3::Program<Entity>& program, ByteReader& in, ByteWriter& out) {
    using Op = orbslam3::Op<Entity>;
    for (const Op& op : program) {
      if (op.kind == Op::Kind::kPreintegration) Run(program_.preintegration, in, out);
      if (op.kind != Op::Kind::kCarried) continue;
      const Bytes rest = in.rest();
      for (const orbslam3::TypeNode& node : op.nodes) orbslam3::SkipPacked(node, in);
      if (Values::IsNew(op.name))
        values_.Add(op.name, out);
      else
        out.PutBytes(rest.first(rest.size() - in.left()));
    }
  }

  const orbslam3::ForkProgram program_;
  Values values_;
};

}  // namespace

std::string Forge(const Atlas& atlas, const Layout& layout, Random& random) {
  Notices notices;
  WriteOptions in_layout;
  const std::string json = ToJson(layout);
  in_layout.of<Orbslam3WriteOptions>().layout = json;
  std::string bytes;
  const auto append = [&](Bytes more) { bytes.append(reinterpret_cast<const char*>(more.data()), more.size()); };
  WriteOrbslam3(atlas, Target(append, "forged"), in_layout, notices);
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = json;
  Atlas forged = ReadOrbslam3({std::as_bytes(std::span(bytes)), "forged"}, options, notices);
  Renewer(LayoutOf(json), random).Renew(forged);
  return EncodeOrbslam3(forged);
}

const Atlas& RealSession() {
  static const Atlas atlas = [] {
    Notices notices;
    return ReadOrbslam3(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa", {}, notices);
  }();
  return atlas;
}

Source In(const std::string& bytes) { return {std::as_bytes(std::span(bytes)), "forged"}; }

Atlas ReadAs(const std::string& bytes, const std::string& layout) {
  Notices notices;
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = layout;
  return ReadOrbslam3(In(bytes), options, notices);
}

std::string OwnBytes(Atlas atlas) {
  for (Map& map : atlas.maps) {
    for (KeyFrame& keyframe : map.keyframes) keyframe.carried.Reset();
    for (MapPoint& point : map.points) point.carried.Reset();
    map.carried.Reset();
  }
  for (Camera& camera : atlas.cameras) camera.carried.Reset();
  atlas.carried.Reset();
  atlas.layout = "";
  return EncodeOrbslam3(atlas);
}

bool SameCore(const Atlas& a, const Atlas& b) {
  const auto same_keyframe = [](const KeyFrame& x, const KeyFrame& y) {
    return x.id == y.id && x.timestamp == y.timestamp &&
           x.camera_from_world.rotation.coeffs() == y.camera_from_world.rotation.coeffs() &&
           x.camera_from_world.translation == y.camera_from_world.translation &&
           x.features.map_points == y.features.map_points;
  };
  const auto same_point = [](const MapPoint& x, const MapPoint& y) {
    return x.id == y.id && x.position == y.position && x.observations == y.observations;
  };
  return std::ranges::equal(a.maps, b.maps, [&](const Map& x, const Map& y) {
    return std::ranges::equal(x.keyframes, y.keyframes, same_keyframe) &&
           std::ranges::equal(x.points, y.points, same_point);
  });
}

}  // namespace slamdb::testing
