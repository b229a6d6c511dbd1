// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/fork_conversions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "slamdb/formats/layouts/detail/member_forms.h"
#include "slamdb/formats/orbslam3/detail/fork_steps.h"
#include "slamdb/formats/orbslam3/detail/number_archive.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::orbslam3 {
namespace {

using Kind = TypeNode::Kind;
using layouts::Numbers;
using slamdb::detail::kCv32F;
using slamdb::detail::kCv64F;

void TakeNumber(ByteReader& in, LayoutType::Number type, Numbers& numbers) {
  layouts::WithNumberType(type, [&](auto zero) { numbers.push_back(static_cast<Number>(in.Get<decltype(zero)>())); });
}
void PutNumber(ByteWriter& out, LayoutType::Number type, Number number) {
  layouts::WithNumberType(type, [&](auto zero) { out.Put(layouts::Narrowed<decltype(zero)>(number)); });
}

// Packed lists of numbers, with their counts.
void TakeNumbers(ByteReader& in, const TypeNode& node, Numbers& numbers) {
  std::uint64_t count = node.count;
  const bool is_list = node.kind == Kind::kVector || node.kind == Kind::kList || node.kind == Kind::kMap;
  if (is_list) numbers.push_back(static_cast<Number>(count = in.Get<std::uint64_t>()));
  for (std::uint64_t i = 0; i < count; ++i) {
    if (node.children.empty()) TakeNumber(in, node.number, numbers);
    for (const TypeNode& child : node.children) TakeNumbers(in, child, numbers);
  }
}
void PutNumbers(ByteWriter& out, const TypeNode& node, const Numbers& numbers, std::size_t& next) {
  std::uint64_t count = node.count;
  const bool is_list = node.kind == Kind::kVector || node.kind == Kind::kList || node.kind == Kind::kMap;
  if (is_list) out.Put(count = static_cast<std::uint64_t>(numbers[next++]));
  for (std::uint64_t i = 0; i < count; ++i) {
    if (node.children.empty()) PutNumber(out, node.number, numbers[next++]);
    for (const TypeNode& child : node.children) PutNumbers(out, child, numbers, next);
  }
}

struct PackedMatrix {
  std::int32_t columns = 0, rows = 0, type = 0;
  Numbers values;  // row after row
};

// Of floats or doubles; empty otherwise.
PackedMatrix TakeMatrix(Bytes bytes) {
  ByteReader in(bytes);
  PackedMatrix matrix{in.Get<std::int32_t>(), in.Get<std::int32_t>(), in.Get<std::int32_t>()};
  in.Get<std::uint8_t>();
  const bool known = matrix.type == kCv32F || matrix.type == kCv64F;
  if (!known || matrix.columns < 0 || matrix.rows < 0 || matrix.columns > 4 || matrix.rows > 4) return {};
  const auto count = static_cast<std::size_t>(matrix.columns * matrix.rows);
  for (std::size_t i = 0; i < count; ++i)
    TakeNumber(in, matrix.type == kCv32F ? LayoutType::Number::kF32 : LayoutType::Number::kF64, matrix.values);
  return matrix;
}

void PutMatrix(ByteWriter& out, std::int32_t rows, std::int32_t columns, const Numbers& values) {
  for (const std::int32_t number : {columns, rows, kCv32F}) out.Put(number);
  out.Put(std::uint8_t{1});
  for (const Number value : values) PutNumber(out, LayoutType::Number::kF32, value);
}

bool SameNumbers(const Numbers& a, const Numbers& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](Number x, Number y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

// A member that consists of numbers, in other numbers, in another form or as a matrix.
template <class Entity>
class NumberConversion : public Conversion<Entity> {
 public:
  using Read = MemberStep<NumberArchive<true>, Entity>;
  using Write = MemberStep<NumberArchive<false>, const Entity>;
  NumberConversion(std::string_view form, const TypeNode& node, const Read& read, const Write& write)
      : form_(form), node_(node), read_(read), write_(write) {
    if (node.kind == Kind::kMatrix && Of(Entity()).size() != 3) form_ += form_.empty() ? "rows" : ".rows";
  }

  bool Decode(Bytes bytes, Entity& entity) const override {
    Numbers numbers = layouts::ToOwn(form_, Unpacked(bytes));
    if (numbers.empty()) return node_.kind == Kind::kMatrix;  // an empty matrix says nothing
    NumberArchive<true> archive(numbers);
    read_.run(archive, read_.name, entity);
    return true;
  }
  void Encode(const Entity& entity, ByteWriter& out) const override {
    if (node_.kind != Kind::kMatrix) {
      std::size_t next = 0;
      return PutNumbers(out, node_, layouts::FromOwn(form_, Of(entity), node_.count), next);
    }
    constexpr std::size_t kMostElements = 16;
    const Numbers values = layouts::FromOwn(form_, Of(entity), kMostElements);
    const std::int32_t columns = values.size() == 3 ? 1 : values.size() == 9 ? 3 : 4;
    PutMatrix(out, static_cast<std::int32_t>(values.size()) / columns, columns, values);
  }
  bool Same(const Entity& a, const Entity& b) const override { return SameNumbers(Of(a), Of(b)); }

 private:
  Numbers Of(const Entity& entity) const {
    Numbers numbers;
    NumberArchive<false> archive(numbers);
    write_.run(archive, write_.name, entity);
    return numbers;
  }
  Numbers Unpacked(Bytes bytes) const {
    if (node_.kind == Kind::kMatrix) return TakeMatrix(bytes).values;
    Numbers numbers;
    ByteReader in(bytes);
    TakeNumbers(in, node_, numbers);
    return numbers;
  }

  std::string form_;
  TypeNode node_;
  Read read_;
  Write write_;
};

// The time in whole seconds and nanoseconds.
class TimeConversion : public Conversion<KeyFrame> {
 public:
  bool Decode(Bytes bytes, KeyFrame& keyframe) const override {
    ByteReader in(bytes);
    const auto seconds = in.Get<std::uint32_t>(), nanoseconds = in.Get<std::uint32_t>();
    keyframe.timestamp = static_cast<double>(seconds) + static_cast<double>(nanoseconds) * 1e-9;
    return nanoseconds < kNanoseconds;
  }
  void Encode(const KeyFrame& keyframe, ByteWriter& out) const override {
    const double time = keyframe.timestamp;
    const bool fits = time >= 0 && time < 4294967295.0;
    double seconds = fits ? std::floor(time) : 0;
    double nanoseconds = fits ? std::round((time - seconds) * 1e9) : 0;
    if (nanoseconds >= kNanoseconds) seconds += 1, nanoseconds = 0;
    out.Put(static_cast<std::uint32_t>(seconds));
    out.Put(static_cast<std::uint32_t>(nanoseconds));
  }
  bool Same(const KeyFrame& a, const KeyFrame& b) const override {
    return a.timestamp == b.timestamp || (std::isnan(a.timestamp) && std::isnan(b.timestamp));
  }

 private:
  static constexpr std::uint32_t kNanoseconds = 1000000000;
};

template <class T>
void TakeColumn(ByteReader& in, Column<T>& values) {
  const auto count = in.Get<std::uint64_t>();
  const std::byte* const begin = in.TakeArray(count, sizeof(T));
  values.resize(count);
  if (count > 0) std::memcpy(values.data(), begin, count * sizeof(T));
}
template <class T>
void PutColumn(ByteWriter& out, const T* values, std::size_t count) {
  out.Put(static_cast<std::uint64_t>(count));
  out.PutBytes(std::as_bytes(std::span(values, count)));
}

// Words and weights: as a map, or as two vectors.
class BowConversion : public Conversion<KeyFrame> {
 public:
  explicit BowConversion(bool map) : map_(map) {}
  bool Decode(Bytes bytes, KeyFrame& keyframe) const override {
    ByteReader in(bytes);
    BagOfWords& bow = keyframe.features.bag_of_words;
    if (map_) {
      for (auto count = in.Get<std::uint64_t>(); count > 0; --count) {
        bow.words.push_back(in.Get<std::uint32_t>());
        bow.weights.push_back(in.Get<double>());
      }
      return true;
    }
    TakeColumn(in, bow.words);
    TakeColumn(in, bow.weights);
    if (bow.words.size() != bow.weights.size()) bow = {};
    return true;
  }
  void Encode(const KeyFrame& keyframe, ByteWriter& out) const override {
    const BagOfWords& bow = keyframe.features.bag_of_words;
    if (!map_) {
      PutColumn(out, bow.words.data(), bow.words.size());
      return PutColumn(out, bow.weights.data(), bow.weights.size());
    }
    out.Put(static_cast<std::uint64_t>(bow.words.size()));
    for (std::size_t i = 0; i < bow.words.size(); ++i) {
      out.Put(bow.words[i]);
      out.Put(bow.weights[i]);
    }
  }
  bool Same(const KeyFrame& a, const KeyFrame& b) const override {
    return a.features.bag_of_words == b.features.bag_of_words;
  }

 private:
  bool map_;
};

class FeatureVectorConversion : public Conversion<KeyFrame> {
 public:
  explicit FeatureVectorConversion(bool map) : map_(map) {}
  bool Decode(Bytes bytes, KeyFrame& keyframe) const override {
    ByteReader in(bytes);
    FeatureVector& vector = keyframe.features.feature_vector;
    if (!map_) TakeColumn(in, vector.nodes);
    for (auto count = in.Get<std::uint64_t>(); count > 0; --count) {
      if (map_) vector.nodes.push_back(in.Get<std::uint32_t>());
      const auto size = in.Get<std::uint64_t>();
      const std::byte* const begin = in.TakeArray(size, sizeof(std::uint32_t));
      const std::size_t old = vector.features.size();
      vector.features.resize(old + size);
      if (size > 0) std::memcpy(vector.features.data() + old, begin, size * sizeof(std::uint32_t));
      vector.sizes.push_back(static_cast<std::uint32_t>(size));
    }
    if (vector.nodes.size() != vector.sizes.size()) vector = {};
    return true;
  }
  void Encode(const KeyFrame& keyframe, ByteWriter& out) const override {
    const FeatureVector& vector = keyframe.features.feature_vector;
    if (!map_) PutColumn(out, vector.nodes.data(), vector.nodes.size());
    out.Put(static_cast<std::uint64_t>(vector.sizes.size()));
    const std::uint32_t* next = vector.features.data();
    for (std::size_t i = 0; i < vector.sizes.size(); ++i) {
      if (map_) out.Put(vector.nodes[i]);
      PutColumn(out, next, vector.sizes[i]);
      next += vector.sizes[i];
    }
  }
  bool Same(const KeyFrame& a, const KeyFrame& b) const override {
    return a.features.feature_vector == b.features.feature_vector;
  }

 private:
  bool map_;
};

// One side of a point's observations, where the two maps do not stand side by side or are of other numbers.
class ObservationConversion : public Conversion<MapPoint> {
 public:
  ObservationConversion(const TypeNode& node, std::int32_t Observation::*side) : node_(node), side_(side) {}

  bool Decode(Bytes bytes, MapPoint& point) const override {
    ByteReader in(bytes);
    Numbers numbers;
    TakeNumbers(in, node_, numbers);
    Column<Observation> given;
    for (std::size_t i = 1; i + 1 < numbers.size(); i += 2) {
      Observation observation;
      observation.keyframe = KeyFrameId(layouts::Narrowed<std::uint64_t>(numbers[i]));
      observation.left = observation.right = Observation::kAbsent;
      observation.*side_ = layouts::Narrowed<std::int32_t>(numbers[i + 1]);
      given.push_back(observation);
    }
    Column<Observation> both;
    auto other = point.observations.begin();
    for (Observation& observation : given) {
      while (other != point.observations.end() && other->keyframe < observation.keyframe) both.push_back(*other++);
      if (other != point.observations.end() && other->keyframe == observation.keyframe)
        (both.emplace_back(*other++)).*side_ = observation.*side_;
      else
        both.push_back(observation);
    }
    both.insert(both.end(), other, point.observations.end());
    point.observations = std::move(both);
    return true;
  }
  void Encode(const MapPoint& point, ByteWriter& out) const override {
    const Column<Observation>& observations = point.observations;
    out.Put(static_cast<std::uint64_t>(std::ranges::count_if(
        observations, [this](const Observation& observation) { return observation.*side_ != Observation::kAbsent; })));
    for (const Observation& observation : observations) {
      if (observation.*side_ == Observation::kAbsent) continue;
      PutNumber(out, node_.children[0].number, static_cast<Number>(observation.keyframe.value()));
      PutNumber(out, node_.children[1].number, static_cast<Number>(observation.*side_));
    }
  }
  bool Same(const MapPoint& a, const MapPoint& b) const override {
    ByteWriter of_a, of_b;
    Encode(a, of_a);
    Encode(b, of_b);
    return std::ranges::equal(of_a.bytes(), of_b.bytes());
  }

 private:
  TypeNode node_;
  std::int32_t Observation::*side_;
};

// IMU samples of which each has more than ORB-SLAM3's.
class MeasurementConversion : public Conversion<ImuPreintegration> {
 public:
  // Where the seven floats begin in `bytes` of each.
  MeasurementConversion(std::size_t bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  bool Decode(Bytes bytes, ImuPreintegration& imu) const override {
    ByteReader in(bytes);
    const auto count = in.Get<std::uint64_t>();
    const std::byte* begin = in.TakeArray(count, bytes_);
    imu.measurements.resize(count);
    for (ImuMeasurement& measurement : imu.measurements) {
      std::memcpy(static_cast<void*>(&measurement), begin + at_, sizeof(measurement));
      begin += bytes_;
    }
    return true;
  }
  void Encode(const ImuPreintegration& imu, ByteWriter& out) const override {
    out.Put(static_cast<std::uint64_t>(imu.measurements.size()));
    for (const ImuMeasurement& measurement : imu.measurements) {
      char* const element = out.Extend(bytes_);
      std::memset(element, 0, bytes_);
      std::memcpy(element + at_, static_cast<const void*>(&measurement), sizeof(measurement));
    }
  }
  bool Same(const ImuPreintegration& a, const ImuPreintegration& b) const override {
    const std::size_t count = a.measurements.size();
    if (count == 0 || b.measurements.size() != count) return b.measurements.size() == count;
    return std::memcmp(static_cast<const void*>(a.measurements.data()), static_cast<const void*>(b.measurements.data()),
                       count * sizeof(ImuMeasurement)) == 0;
  }

 private:
  std::size_t bytes_, at_;
};

bool IsNumber(const TypeNode& node, LayoutType::Number number) {
  return node.kind == Kind::kNumbers && node.count == 1 && node.number == number;
}
bool IsVectorOf(const TypeNode& node, LayoutType::Number number) {
  return node.kind == Kind::kVector && node.number == number;
}
bool IsListOfVectors(const TypeNode& node) {
  return node.kind == Kind::kList && IsVectorOf(node.children[0], LayoutType::Number::kU32);
}

// The member of that name in numbers, in another form than its own.
template <class Entity>
FoundConversion<Entity> FindNumbers(const LayoutMember& member, const TypeNode& node, const LayoutType& own) {
  const std::string_view form = layouts::FormOf(member.name);
  if (!layouts::IsForm(form, ParseLayoutType(member.type), own)) return {};
  const auto& reads = StepTable<NumberArchive<true>, Entity>::Steps();
  const auto& writes = StepTable<NumberArchive<false>, const Entity>::Steps();
  for (std::size_t i = 0; i < reads.size(); ++i)
    if (reads[i].name == layouts::NameOf(member.name))
      return {std::make_shared<NumberConversion<Entity>>(form, node, reads[i], writes[i])};
  return {};
}

FoundConversion<KeyFrame> FindOfKeyFrame(std::span<const LayoutMember> members, std::span<const TypeNode> nodes) {
  using N = LayoutType::Number;
  const auto are = [&](std::string_view first, std::string_view second) {
    return members.size() > 1 && members[0].name == first && members[1].name == second;
  };
  if (are("mTimeStamp.seconds", "mTimeStamp.nanoseconds") && IsNumber(nodes[0], N::kU32) && IsNumber(nodes[1], N::kU32))
    return {std::make_shared<TimeConversion>(), 2};
  if (are("mBowVec.words", "mBowVec.weights") && IsVectorOf(nodes[0], N::kU32) && IsVectorOf(nodes[1], N::kF64))
    return {std::make_shared<BowConversion>(false), 2};
  if (are("mFeatVec.nodes", "mFeatVec.features") && IsVectorOf(nodes[0], N::kU32) && IsListOfVectors(nodes[1]))
    return {std::make_shared<FeatureVectorConversion>(false), 2};
  if (nodes[0].kind != Kind::kMap || !IsNumber(nodes[0].children[0], N::kU32)) return {};
  if (members[0].name == "mBowVec" && IsNumber(nodes[0].children[1], N::kF64))
    return {std::make_shared<BowConversion>(true)};
  if (members[0].name == "mFeatVec" && IsVectorOf(nodes[0].children[1], N::kU32))
    return {std::make_shared<FeatureVectorConversion>(true)};
  return {};
}

}  // namespace

template <class Entity>
FoundConversion<Entity> FindConversion(std::span<const LayoutMember> members, std::span<const TypeNode> nodes,
                                       const LayoutType& own) {
  return FindNumbers<Entity>(members[0], nodes[0], own);
}
template <>
FoundConversion<KeyFrame> FindConversion(std::span<const LayoutMember> members, std::span<const TypeNode> nodes,
                                         const LayoutType& own) {
  FoundConversion<KeyFrame> found = FindOfKeyFrame(members, nodes);
  return found.conversion ? found : FindNumbers<KeyFrame>(members[0], nodes[0], own);
}
template <>
FoundConversion<MapPoint> FindConversion(std::span<const LayoutMember> members, std::span<const TypeNode> nodes,
                                         const LayoutType& own) {
  const TypeNode& node = nodes[0];
  const bool is_map = layouts::IsForm("", ParseLayoutType(members[0].type), own) && node.kind == Kind::kMap;
  if (is_map && members[0].name == "mBackupObservationsId1")
    return {std::make_shared<ObservationConversion>(node, &Observation::left)};
  if (is_map && members[0].name == "mBackupObservationsId2")
    return {std::make_shared<ObservationConversion>(node, &Observation::right)};
  return FindNumbers<MapPoint>(members[0], node, own);
}
// The counters alone are the model's.
template <>
FoundConversion<Atlas> FindConversion(std::span<const LayoutMember>, std::span<const TypeNode>, const LayoutType&) {
  return {};
}
template <>
FoundConversion<ImuPreintegration> FindConversion(std::span<const LayoutMember> members,
                                                  std::span<const TypeNode> nodes, const LayoutType& own) {
  const TypeNode& node = nodes[0];
  if (members[0].name != "mvMeasurements" || node.kind != Kind::kList || node.children[0].kind != Kind::kClass)
    return FindNumbers<ImuPreintegration>(members[0], node, own);
  // Plain numbers, and among them the acceleration, the angular velocity and the duration, side by side.
  std::size_t bytes = 0, at = 0;
  const std::vector<TypeNode>& fields = node.children[0].children;
  bool found = false;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].kind != Kind::kNumbers) return {};
    const auto is = [&](std::size_t which, std::uint32_t count) {
      return which < fields.size() && fields[which].kind == Kind::kNumbers && fields[which].count == count &&
             fields[which].number == LayoutType::Number::kF32;
    };
    if (!found && is(i, 3) && is(i + 1, 3) && is(i + 2, 1)) {
      found = true;
      at = bytes;
    }
    bytes += WidthOf(fields[i].number) * fields[i].count;
  }
  if (!found) return {};
  return {std::make_shared<MeasurementConversion>(bytes, at)};
}

template FoundConversion<Map> FindConversion(std::span<const LayoutMember>, std::span<const TypeNode>,
                                             const LayoutType&);
template FoundConversion<Camera> FindConversion(std::span<const LayoutMember>, std::span<const TypeNode>,
                                                const LayoutType&);

}  // namespace slamdb::orbslam3
