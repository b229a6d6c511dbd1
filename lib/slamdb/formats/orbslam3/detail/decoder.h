// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "slamdb/formats/format.h"
#include "slamdb/formats/orbslam3/detail/reading_archive.h"

namespace slamdb::orbslam3 {

using PartBytes = std::array<std::uint64_t, static_cast<std::size_t>(Part::kCount)>;

// The archive that fills the model.
template <class Input>
class Decoder : public ReadingArchive<Input> {
 public:
  // Columns that are not asked for stay empty.
  Decoder(const Input& at, const ClassTable& table, FeatureColumns features)
      : ReadingArchive<Input>(at, table),
        keypoints_(features != FeatureColumns::kNone),
        descriptors_(features == FeatureColumns::kAll),
        indexes_(features == FeatureColumns::kAll) {}

  // Grids and bags of words, by which keypoints are found, stay empty where they are not kept.
  void KeepIndexes(bool keep) { indexes_ = keep; }

  const PartBytes& part_bytes() const { return part_bytes_; }

  void Begin(Part part) {
    part_bytes_[static_cast<std::size_t>(part_)] += this->input.offset() - part_begin_;
    part_begin_ = this->input.offset();
    part_ = part;
  }
  // Starts counting anew at the cursor, so that what was jumped over is nobody's.
  void Restart() { part_begin_ = this->input.offset(); }

  template <class Entity>
  void Identity(const char* name, Id<Entity>& id) {
    UnsignedLong(name, id);
    this->input.place.id = id.value();
  }
  void UnsignedLong(const char* name, std::uint64_t& value) {
    Field(name);
    value = this->input.TakeUnsignedLong();
  }
  template <class Entity>
  void UnsignedLong(const char* name, Id<Entity>& id) {
    Field(name);
    id = Id<Entity>(this->input.TakeUnsignedLong());
  }
  void Long(const char* name, std::int64_t& value) {
    Field(name);
    value = this->input.TakeLong();
  }
  template <class Entity>
  void LongLong(const char* name, Id<Entity>& id) {
    Field(name);
    id = Id<Entity>(static_cast<std::uint64_t>(this->input.template Take<std::int64_t>()));
  }
  void CameraReference(const char* name, CameraId& id) {
    Field(name);
    id = CameraId(BinaryInput::Widen(this->input.template Take<std::uint32_t>()));
  }
  void Int(const char* name, std::int32_t& value) { Number(name, value); }
  void Unsigned(const char* name, std::uint32_t& value) { Number(name, value); }
  void Float(const char* name, float& value) { Number(name, value); }
  void Double(const char* name, double& value) { Number(name, value); }
  void Bool(const char* name, Flag& value) { Number(name, value.recorded); }
  template <class Derived>
  void Floats(const char* name, Eigen::PlainObjectBase<Derived>& values) {
    Field(name);
    this->input.TakeArray(values.data(), static_cast<std::size_t>(values.size()));
  }
  void Pose(const char* name, Rigid3f& pose) {
    Field(name);
    std::array<float, 7> v;  // quaternion w x y z, translation
    this->input.TakeArray(v.data(), v.size());
    pose.rotation.coeffs() << v[1], v[2], v[3], v[0];
    pose.translation << v[4], v[5], v[6];
  }
  void MatrixValue(const char* name, Matrix& matrix) {
    Field(name);
    matrix.data.resize(this->MatrixBytes(matrix));
    this->input.TakeArray(reinterpret_cast<std::uint8_t*>(matrix.data.data()), matrix.data.size());
  }
  void Descriptors(const char* name, Column<Descriptor>& descriptors, MatrixForm& form, Boxed<Carried>& carried) {
    Field(name);
    Matrix other;
    const std::uint64_t rows = this->DescriptorRows(&form, other);
    if (other.columns != 0) return OtherDescriptors(other, carried);
    if (!descriptors_) return this->input.template SkipArray<std::uint8_t>(rows * sizeof(Descriptor));
    descriptors.resize(rows);
    this->input.TakeArray(reinterpret_cast<std::uint8_t*>(descriptors.data()), rows * sizeof(Descriptor));
  }
  void PointDescriptor(const char* name, Descriptor& descriptor, MatrixForm& form, Boxed<Carried>& carried) {
    Field(name);
    Matrix other;
    const std::uint64_t rows = this->DescriptorRows(&form, other);
    if (other.columns != 0) {
      if (other.rows != 1) FailRows(static_cast<std::uint64_t>(other.rows));
      return OtherDescriptors(other, carried);
    }
    const bool has_columns = form == MatrixForm::kUsual || form == MatrixForm::kUsualNotContinuous;
    if (rows != (has_columns ? 1U : 0U)) FailRows(rows);
    if (has_columns) this->input.TakeArray(descriptor.data(), descriptor.size());
  }
  void Keypoints(const char* name, Column<Keypoint>& keypoints) {
    Field(name);
    const std::uint64_t count = this->KeypointCount();
    if (!keypoints_) return SkipKeypoints(count);
    keypoint_count_ = count;
    keypoints.resize(count);
    TakeKeypoints(keypoints.data(), count);
  }
  template <class Vector>
  void FloatVector(const char* name, Vector& values) {
    NumberVector(name, WireClass::kFloats, values);
  }
  void IntVector(const char* name, Column<std::int32_t>& values) { NumberVector(name, WireClass::kInts, values); }
  template <class Entity>
  void LongLongVector(const char* name, Column<Id<Entity>>& ids) {
    static_assert(sizeof(Id<Entity>) == sizeof(std::uint64_t));
    Field(name);
    ids.resize(this->VectorCount(WireClass::kLongLongs, sizeof(std::int64_t)));
    this->input.TakeArray(reinterpret_cast<std::int64_t*>(ids.data()), ids.size());
  }
  template <class Vector>
  void UnsignedLongVector(const char* name, Vector& ids) {
    Field(name);
    ids.resize(this->UnsignedLongCount());
    this->input.TakeUnsignedLongs(reinterpret_cast<std::uint64_t*>(ids.data()), ids.size());
  }

  void Bow(const char* name, BagOfWords& bow) {
    Field(name);
    const std::uint64_t count = this->BowCount();
    if (!indexes_) return this->SkipBowEntries(count);
    bow.words.resize(count);
    bow.weights.resize(count);
    std::uint32_t* words = bow.words.data();
    double* weights = bow.weights.data();
    this->input.template TakePairs<std::uint32_t, double>(count, [&](std::uint32_t word, double weight) {
      *words++ = word;
      *weights++ = weight;
    });
  }
  void FeatureMap(const char* name, FeatureVector& vector) {
    Field(name);
    this->ClassInfo(WireClass::kFeatureVector);
    const std::uint64_t count = this->ClassCount(WireClass::kFeatureMap, 8, 2);
    if (count == 0) return;
    this->ClassInfo(WireClass::kFeaturePair);
    if (indexes_) {
      vector.nodes.reserve(count);
      vector.sizes.reserve(count);
      vector.features.reserve(keypoint_count_);
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto node = this->input.template Take<std::uint32_t>();
      const std::uint64_t size = this->VectorCount(WireClass::kUnsigneds, sizeof(std::uint32_t));
      if (!indexes_) {
        this->input.template SkipArray<std::uint32_t>(size);
        continue;
      }
      vector.nodes.push_back(node);
      vector.sizes.push_back(static_cast<std::uint32_t>(size));
      const std::size_t begin = vector.features.size();
      vector.features.resize(begin + size);
      this->input.TakeArray(vector.features.data() + begin, size);
    }
  }
  void Grid(const char* name, FeatureGrid& grid);
  void Connections(const char* name, Column<Connection>& connections) {
    Field(name);
    const std::uint64_t count = this->WeightCount();
    connections.resize(count);
    Connection* connection = connections.data();
    this->input.TakeWeights(count, [&](std::uint64_t keyframe, std::int32_t weight) {
      *connection++ = {KeyFrameId(keyframe), weight};
    });
  }
  void Observations(const char* left_name, const char* right_name, Column<Observation>& observations);
  void Measurements(const char* name, Column<ImuMeasurement>& measurements) {
    Field(name);
    measurements.resize(this->ClassCount(WireClass::kMeasurementList, sizeof(ImuMeasurement), 7));
    if (measurements.empty()) return;
    this->ClassInfo(WireClass::kMeasurement);
    this->input.TakeArray(reinterpret_cast<float*>(measurements.data()), measurements.size() * 7);
  }

 private:
  void Field(const char* name) { this->input.place.field = name; }
  [[gnu::cold, gnu::noinline]] void OtherDescriptors(Matrix& matrix, Boxed<Carried>& carried) {
    const std::uint64_t bytes = this->DataBytes(matrix);
    if (!descriptors_) return this->input.template SkipArray<std::uint8_t>(bytes);
    matrix.data.resize(bytes);
    this->input.TakeArray(reinterpret_cast<std::uint8_t*>(matrix.data.data()), bytes);
    carried.Make().descriptors = std::move(matrix);
  }
  [[noreturn]] void FailRows(std::uint64_t rows) {
    this->input.Fail("a descriptor of " + std::to_string(rows) + " rows, expected 1: the file is damaged");
  }
  template <class T>
  void Number(const char* name, T& value) {
    Field(name);
    value = this->input.template Take<T>();
  }
  template <class Vector>
  void NumberVector(const char* name, WireClass wire_class, Vector& values) {
    Field(name);
    values.resize(this->VectorCount(wire_class, sizeof(values[0])));
    this->input.TakeArray(values.data(), values.size());
  }
  void CheckKeypointRow(std::int32_t row) const {
    if (row == Observation::kAbsent) [[unlikely]]
      this->input.Fail("a keypoint row of -2147483648: the file is damaged");
  }
  void TakeKeypoints(Keypoint* keypoints, std::size_t count) {
    if constexpr (!Input::kText) {
      this->input.TakeArray(keypoints, count);
    } else {
      for (std::size_t i = 0; i < count; ++i) {
        this->input.TakeArray(&keypoints[i].angle, 1);
        this->input.TakeArray(&keypoints[i].response, 1);
        this->input.TakeArray(&keypoints[i].size, 1);
        this->input.TakeArray(&keypoints[i].x, 1);
        this->input.TakeArray(&keypoints[i].y, 1);
        this->input.TakeArray(&keypoints[i].class_id, 1);
        this->input.TakeArray(&keypoints[i].octave, 1);
      }
    }
  }
  void SkipKeypoints(std::size_t count) { this->input.template SkipArray<float>(count * 7); }
  static constexpr std::size_t kUsualInCell = 2;
  std::size_t TakeGridColumn(std::uint64_t cells, FeatureGrid& grid, std::size_t filled);

  bool keypoints_, descriptors_, indexes_;
  std::size_t keypoint_count_ = 0;  // of the column read last: how much the grid behind it will hold
  Part part_ = Part::kOther;
  std::size_t part_begin_ = 0;
  PartBytes part_bytes_{};
};

// Most cells are empty, the others hold one or two keypoints, and nothing tells which: two are copied from every cell,
// and what is not of it is overwritten by the next, so that the processor has nothing to guess.
template <class Input>
void Decoder<Input>::Grid(const char* name, FeatureGrid& grid) {
  Field(name);
  const std::uint8_t size_bytes = this->input.encoding().size_bytes;
  const std::uint64_t columns = this->ClassCount(WireClass::kGrid, 8, 2);
  std::size_t filled = 0;  // of grid.keypoints
  for (std::uint64_t column = 0; column < columns; ++column) {
    const std::uint64_t cells = this->ClassCount(WireClass::kGridColumn, size_bytes, 2);
    if (cells > 0) this->classes.Register(WireClass::kSizes);
    if (!indexes_) {
      this->SkipGridColumn(cells);
      continue;
    }
    if (column == 0) {
      grid.column_sizes.reserve(columns);
      grid.cell_sizes.reserve(std::min<std::uint64_t>(columns * cells, this->input.remaining() / 4));
      grid.keypoints.resize(keypoint_count_ + kUsualInCell);
    }
    grid.column_sizes.push_back(static_cast<std::uint32_t>(cells));
    filled = TakeGridColumn(cells, grid, filled);
  }
  grid.keypoints.resize(filled);
}

// Returns how many keypoints there are with those of the column.
template <class Input>
std::size_t Decoder<Input>::TakeGridColumn(std::uint64_t cells, FeatureGrid& grid, std::size_t filled) {
  const std::size_t first = grid.cell_sizes.size();
  grid.cell_sizes.resize(first + cells);
  std::uint32_t* size = grid.cell_sizes.data() + first;
  const auto place_for = [&](std::size_t count) {
    *size++ = static_cast<std::uint32_t>(count);
    if (grid.keypoints.size() < filled + count + kUsualInCell) [[unlikely]]
      grid.keypoints.resize(filled + count + keypoint_count_ + kUsualInCell);
    return grid.keypoints.data() + std::exchange(filled, filled + count);
  };
  while (cells > 0) {
    cells -= this->input.TakeSeenSizeVectors(cells, kUsualInCell, [&](std::size_t count, const char* entries) {
      std::uint64_t* const to = place_for(count);
      std::memcpy(to, entries, kUsualInCell * sizeof(*to));
      if (count > kUsualInCell) std::memcpy(to, entries, count * sizeof(*to));
    });
    if (cells == 0) break;
    const std::uint64_t count = this->VectorCount(this->input.encoding().size_bytes);
    this->input.TakeSizes(place_for(count), count);
    --cells;
  }
  return filled;
}

// The two maps are zipped while their keys agree, which is always so in a sound file. From the first disagreement on,
// an entry of one map alone keeps its place with the other side absent, so that both maps can be written back in order.
template <class Input>
void Decoder<Input>::Observations(const char* left_name, const char* right_name, Column<Observation>& observations) {
  Field(left_name);
  const std::uint64_t left_count = this->WeightCount();
  observations.resize(left_count);
  Observation* observation = observations.data();
  this->input.TakeWeights(left_count, [&](std::uint64_t keyframe, std::int32_t left) {
    CheckKeypointRow(left);
    *observation++ = {KeyFrameId(keyframe), left, Observation::kAbsent};
  });
  Field(right_name);
  const std::uint64_t right_count = this->WeightCount();
  Observation* pair = observations.data();  // the next that has not met its right side
  Observation* const pairs_end = pair + left_count;
  bool zipped = true;
  Column<Observation> unpaired;
  auto next_unpaired = unpaired.cbegin();
  this->input.TakeWeights(right_count, [&](std::uint64_t id, std::int32_t right) {
    const KeyFrameId keyframe(id);
    CheckKeypointRow(right);
    if (zipped && pair != pairs_end && pair->keyframe == keyframe) [[likely]] {
      (pair++)->right = right;
      return;
    }
    if (zipped) {
      zipped = false;
      unpaired.assign(pair, pairs_end);
      next_unpaired = unpaired.cbegin();
      observations.resize(static_cast<std::size_t>(pair - observations.data()));
    }
    while (next_unpaired != unpaired.cend() && next_unpaired->keyframe < keyframe)
      observations.push_back(*next_unpaired++);
    const bool pairs = next_unpaired != unpaired.cend() && next_unpaired->keyframe == keyframe;
    observations.push_back({keyframe, pairs ? (next_unpaired++)->left : Observation::kAbsent, right});
  });
  observations.insert(observations.end(), next_unpaired, unpaired.cend());
}

}  // namespace slamdb::orbslam3
