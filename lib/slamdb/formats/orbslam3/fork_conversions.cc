// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/fork_conversions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "slamdb/formats/orbslam3/detail/fork_steps.h"
#include "slamdb/formats/orbslam3/detail/number_archive.h"

namespace slamdb::orbslam3 {
namespace {

using Kind = TypeNode::Kind;
using Numbers = std::vector<Number>;
constexpr std::int32_t kFloat = 5, kDouble = 6;  // OpenCV's CV_32F, CV_64F

// Calls use(T()) with the type that a packed number has.
template <class Use>
void WithType(LayoutType::Number number, const Use& use) {
  using N = LayoutType::Number;
  switch (number) {
    case N::kU8:
    case N::kBool:
      return use(std::uint8_t());
    case N::kI8:
      return use(std::int8_t());
    case N::kI16:
      return use(std::int16_t());
    case N::kU16:
      return use(std::uint16_t());
    case N::kI32:
      return use(std::int32_t());
    case N::kU32:
      return use(std::uint32_t());
    case N::kU64:
    case N::kULongLong:
    case N::kSize:
      return use(std::uint64_t());
    case N::kI64:
    case N::kLong:
      return use(std::int64_t());
    case N::kF32:
      return use(float());
    case N::kF64:
      return use(double());
  }
}

void TakeNumbers(ByteReader& in, LayoutType::Number type, std::size_t count, Numbers& numbers) {
  WithType(type, [&](auto zero) {
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(static_cast<Number>(in.Get<decltype(zero)>()));
  });
}

template <class T>
T Narrowed(Number number) {
  if constexpr (std::is_floating_point_v<T>) return static_cast<T>(number);
  if (!(std::abs(number) < Number{18446744073709551616.0L})) return T{};
  return number < 0 ? static_cast<T>(static_cast<std::int64_t>(std::max(number, Number{-9223372036854775808.0L})))
                    : static_cast<T>(static_cast<std::uint64_t>(number));
}

void PutNumbers(ByteWriter& out, LayoutType::Number type, const Numbers& numbers) {
  WithType(type, [&](auto zero) {
    for (const Number number : numbers) out.Put(Narrowed<decltype(zero)>(number));
  });
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
  const bool known = matrix.type == kFloat || matrix.type == kDouble;
  if (!known || matrix.columns < 0 || matrix.rows < 0 || matrix.columns > 4 || matrix.rows > 4) return {};
  const auto count = static_cast<std::size_t>(matrix.columns * matrix.rows);
  TakeNumbers(in, matrix.type == kFloat ? LayoutType::Number::kF32 : LayoutType::Number::kF64, count, matrix.values);
  return matrix;
}

void PutMatrix(ByteWriter& out, std::int32_t rows, std::int32_t columns, const Numbers& values) {
  for (const std::int32_t number : {columns, rows, kFloat}) out.Put(number);
  out.Put(std::uint8_t{1});
  PutNumbers(out, LayoutType::Number::kF32, values);
}

// A pose as v1.0 has it, w x y z and the translation, from the upper rows of a 4x4 or 3x4 matrix, and back.
Numbers PoseOf(const PackedMatrix& matrix) {
  if (matrix.columns != 4 || matrix.rows < 3) return {};
  Eigen::Matrix3d rotation;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      rotation(row, column) = static_cast<double>(matrix.values[static_cast<std::size_t>(4 * row + column)]);
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  return {q.w(), q.x(), q.y(), q.z(), matrix.values[3], matrix.values[7], matrix.values[11]};
}
Numbers MatrixOfPose(const Numbers& pose) {
  const auto at = [&](std::size_t i) { return static_cast<double>(pose[i]); };
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(at(0), at(1), at(2), at(3)).normalized().toRotationMatrix();
  Numbers values;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) values.push_back(rotation(row, column));
    values.push_back(pose[static_cast<std::size_t>(4 + row)]);
  }
  values.insert(values.end(), {0, 0, 0, 1});
  return values;
}
Numbers Transposed(const Numbers& m) { return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}; }

bool SameNumbers(const Numbers& a, const Numbers& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](Number x, Number y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

// A member that consists of numbers, in other numbers or as a matrix.
template <class Entity>
class NumberConversion : public Conversion<Entity> {
 public:
  using Read = MemberStep<NumberArchive<true>, Entity>;
  using Write = MemberStep<NumberArchive<false>, const Entity>;
  NumberConversion(const TypeNode& node, const Read& read, const Write& write, std::size_t count)
      : matrix_(node.kind == Kind::kMatrix), type_(node.number), count_(count), read_(read), write_(write) {}

  bool Decode(Bytes bytes, Entity& entity) const override {
    Numbers numbers = Unpacked(bytes);
    if (numbers.size() != count_) return true;  // an empty matrix says nothing
    NumberArchive<true> archive(numbers);
    read_.run(archive, read_.name, entity);
    return true;
  }
  void Encode(const Entity& entity, ByteWriter& out) const override {
    const Numbers numbers = Of(entity);
    if (!matrix_) return PutNumbers(out, type_, numbers);
    if (count_ == 7) return PutMatrix(out, 4, 4, MatrixOfPose(numbers));
    if (count_ == 9) return PutMatrix(out, 3, 3, Transposed(numbers));
    PutMatrix(out, static_cast<std::int32_t>(count_), 1, numbers);
  }
  bool Same(const Entity& a, const Entity& b) const override { return SameNumbers(Of(a), Of(b)); }

  static Numbers Of(const Write& write, const Entity& entity) {
    Numbers numbers;
    NumberArchive<false> archive(numbers);
    write.run(archive, write.name, entity);
    return numbers;
  }

 private:
  Numbers Of(const Entity& entity) const { return Of(write_, entity); }
  Numbers Unpacked(Bytes bytes) const {
    if (!matrix_) {
      Numbers numbers;
      ByteReader in(bytes);
      TakeNumbers(in, type_, count_, numbers);
      return numbers;
    }
    const PackedMatrix matrix = TakeMatrix(bytes);
    if (count_ == 7) return PoseOf(matrix);
    if (count_ == 9) return matrix.rows == 3 && matrix.columns == 3 ? Transposed(matrix.values) : Numbers();
    return matrix.values;
  }

  bool matrix_;
  LayoutType::Number type_;
  std::size_t count_;
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

// One side of a point's observations, where the two maps do not stand side by side.
class ObservationConversion : public Conversion<MapPoint> {
 public:
  explicit ObservationConversion(std::int32_t Observation::*side) : side_(side) {}

  bool Decode(Bytes bytes, MapPoint& point) const override {
    ByteReader in(bytes);
    const auto count = in.Get<std::uint64_t>();
    Column<Observation> given;
    for (std::uint64_t i = 0; i < count; ++i) {
      Observation observation;
      observation.keyframe = KeyFrameId(in.Get<std::uint64_t>());
      observation.left = observation.right = Observation::kAbsent;
      observation.*side_ = in.Get<std::int32_t>();
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
      out.Put(observation.keyframe.value());
      out.Put(observation.*side_);
    }
  }
  bool Same(const MapPoint& a, const MapPoint& b) const override {
    ByteWriter of_a, of_b;
    Encode(a, of_a);
    Encode(b, of_b);
    return std::ranges::equal(of_a.bytes(), of_b.bytes());
  }

 private:
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
    return a.measurements.size() == b.measurements.size() &&
           std::memcmp(static_cast<const void*>(a.measurements.data()), static_cast<const void*>(b.measurements.data()),
                       a.measurements.size() * sizeof(ImuMeasurement)) == 0;
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

// The member of that name in numbers. A matrix may be of a vector, a 3x3 matrix or a pose.
template <class Entity>
FoundConversion<Entity> FindNumbers(const LayoutMember& member, const TypeNode& node) {
  if (node.kind != Kind::kNumbers && node.kind != Kind::kMatrix) return {};
  const auto& reads = StepTable<NumberArchive<true>, Entity>::Steps();
  const auto& writes = StepTable<NumberArchive<false>, const Entity>::Steps();
  for (std::size_t i = 0; i < reads.size(); ++i) {
    if (reads[i].name != member.name) continue;
    const std::size_t count = NumberConversion<Entity>::Of(writes[i], Entity()).size();
    const bool fits = node.kind == Kind::kMatrix ? count == 3 || count == 7 || count == 9 : count == node.count;
    if (fits && count > 0) return {std::make_shared<NumberConversion<Entity>>(node, reads[i], writes[i], count)};
  }
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
FoundConversion<Entity> FindConversion(std::span<const LayoutMember> members, std::span<const TypeNode> nodes) {
  return FindNumbers<Entity>(members[0], nodes[0]);
}
template <>
FoundConversion<KeyFrame> FindConversion(std::span<const LayoutMember> members, std::span<const TypeNode> nodes) {
  FoundConversion<KeyFrame> found = FindOfKeyFrame(members, nodes);
  return found.conversion ? found : FindNumbers<KeyFrame>(members[0], nodes[0]);
}
template <>
FoundConversion<MapPoint> FindConversion(std::span<const LayoutMember> members, std::span<const TypeNode> nodes) {
  using N = LayoutType::Number;
  const TypeNode& node = nodes[0];
  const bool is_map =
      node.kind == Kind::kMap && IsNumber(node.children[0], N::kU64) && IsNumber(node.children[1], N::kI32);
  if (is_map && members[0].name == "mBackupObservationsId1")
    return {std::make_shared<ObservationConversion>(&Observation::left)};
  if (is_map && members[0].name == "mBackupObservationsId2")
    return {std::make_shared<ObservationConversion>(&Observation::right)};
  return FindNumbers<MapPoint>(members[0], node);
}
// The counters alone are the model's.
template <>
FoundConversion<Atlas> FindConversion(std::span<const LayoutMember>, std::span<const TypeNode>) {
  return {};
}
template <>
FoundConversion<ImuPreintegration> FindConversion(std::span<const LayoutMember> members,
                                                  std::span<const TypeNode> nodes) {
  const TypeNode& node = nodes[0];
  if (members[0].name != "mvMeasurements" || node.kind != Kind::kList || node.children[0].kind != Kind::kClass)
    return FindNumbers<ImuPreintegration>(members[0], node);
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

template FoundConversion<Map> FindConversion(std::span<const LayoutMember>, std::span<const TypeNode>);
template FoundConversion<Camera> FindConversion(std::span<const LayoutMember>, std::span<const TypeNode>);

}  // namespace slamdb::orbslam3
