// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam2/detail/archive.h"

#include <algorithm>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::orbslam2 {

using detail::Concat;

namespace {

// As the file has a keypoint. Its size is not stored; its response is, twice.
struct WireKeypoint {
  float angle;
  std::int32_t class_id, octave;
  float response, response_again, x, y;
};
static_assert(sizeof(WireKeypoint) == 28);

}  // namespace

std::int16_t Archive::Register(WireClass wire_class) {
  std::int16_t& id = ids_[static_cast<std::size_t>(wire_class)];
  if (id < 0) id = next_id_++;
  return id;
}

void Archive::TakeClassInfo(WireClass wire_class, std::uint8_t tracking) {
  Register(wire_class);
  bool& informed = informed_[static_cast<std::size_t>(wire_class)];
  if (informed) return;
  informed = true;
  const auto tracked = input_.Take<std::uint8_t>();
  const auto version = input_.Take<std::uint32_t>();
  if (tracked > 1) Fail(Concat("class information with a flag of ", tracked, ": the file is damaged"));
  if (tracked != tracking || version != 0)
    Fail(Concat("a class of version ", version, tracked == 0 ? "" : ", tracked",
                ", expected version 0: the file is damaged, or of a fork with other classes"),
         ErrorKind::kUnsupported);
}

std::uint64_t Archive::TakeCount(const char* field, WireClass vector, std::size_t bytes) {
  input_.place.field = field;
  Register(vector);
  return CheckCount(input_.Take<std::uint64_t>(), bytes);
}

std::uint64_t Archive::TakeCollection(const char* field, WireClass collection, std::size_t bytes) {
  input_.place.field = field;
  TakeClassInfo(collection);
  const std::uint64_t count = CheckCount(input_.Take<std::uint64_t>(), bytes);
  if (const auto version = input_.Take<std::uint32_t>(); version != 0)
    Fail(Concat("elements of version ", version, ", expected 0: the file is damaged, or of a fork with other members"));
  return count;
}

Pointer Archive::TakePointer(WireClass pointee) {
  Register(pointee);
  const auto id = input_.Take<std::int16_t>();
  if (id == -1) return {};
  if (id != ids_[static_cast<std::size_t>(pointee)])
    Fail(Concat("a pointer to class ", id, ", expected ", ids_[static_cast<std::size_t>(pointee)],
                ": the file is damaged, or of a fork with other members"));
  TakeClassInfo(pointee, 1);
  const auto object = input_.Take<std::uint32_t>();
  if (object > objects_.size())
    Fail(Concat("a pointer to object ", object, " of ", objects_.size(), ": the file is damaged"));
  if (object < objects_.size()) {
    if (objects_[object].wire_class != pointee)
      Fail(Concat("a pointer to object ", object, ", which is of another class: the file is damaged"));
    return {.row = objects_[object].row};
  }
  const std::uint32_t row = counts_[static_cast<std::size_t>(pointee)]++;
  objects_.push_back({pointee, row});
  return {.row = row, .is_new = true};
}

Archive::MatrixHead Archive::TakeMatrixHead(const char* field) {
  input_.place.field = field;
  TakeClassInfo(WireClass::kMat);
  MatrixHead head{};
  head.columns = input_.Take<std::int32_t>();
  head.rows = input_.Take<std::int32_t>();
  const auto element = input_.Take<std::uint64_t>();
  const auto type = static_cast<std::int64_t>(input_.Take<std::uint64_t>());
  if (detail::IsMatrixType(type)) head.type = static_cast<std::int32_t>(type);  // an empty one may have any
  if (head.columns < 0 || head.rows < 0)
    Fail(Concat("a matrix of ", head.rows, " x ", head.columns, ": the file is damaged"));
  const std::uint64_t elements = static_cast<std::uint64_t>(head.columns) * static_cast<std::uint64_t>(head.rows);
  if (elements == 0) return head;
  if (!detail::IsMatrixType(type) || element != detail::ElementBytes(head.type))
    Fail(Concat("a matrix of type ", type, " with elements of ", element, " bytes: the file is damaged"));
  head.bytes = CheckCount(elements, element) * element;
  return head;
}

Matrix Archive::TakeMatrix(const char* field) {
  const MatrixHead head = TakeMatrixHead(field);
  Matrix matrix;
  matrix.rows = head.rows;
  matrix.columns = head.columns;
  matrix.type = head.type;
  matrix.continuous.recorded = 1;
  matrix.data.resize(head.bytes);
  input_.TakeArray(matrix.data.data(), matrix.data.size());
  return matrix;
}

void Archive::TakeFloats(const char* field, float* values, std::int32_t rows, std::int32_t columns) {
  const MatrixHead head = TakeMatrixHead(field);
  if (head.bytes == 0) return;
  if (head.rows != rows || head.columns != columns || head.type != detail::kCv32F)
    Fail(Concat("a matrix of ", head.rows, " x ", head.columns, " of type ", head.type, ", expected ", rows, " x ",
                columns, " floats"),
         ErrorKind::kUnsupported);
  input_.TakeArray(values, static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
}

void Archive::SkipMatrix(const char* field) { input_.SkipArray<std::byte>(TakeMatrixHead(field).bytes); }

void Archive::TakeKeypoints(const char* field, Column<Keypoint>& keypoints) {
  keypoints.resize(TakeCollection(field, WireClass::kKeypointList, sizeof(WireKeypoint)));
  if (keypoints.empty()) return;
  TakeClassInfo(WireClass::kKeypoint);
  constexpr std::size_t kBlock = 256;
  std::array<WireKeypoint, kBlock> block;
  for (std::size_t begin = 0; begin < keypoints.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, keypoints.size() - begin);
    input_.TakeArray(block.data(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const WireKeypoint& wire = block[i];
      keypoints[begin + i] = {.angle = wire.angle,
                              .response = wire.response,
                              .size = 0,
                              .x = wire.x,
                              .y = wire.y,
                              .class_id = wire.class_id,
                              .octave = wire.octave};
    }
  }
}

void Archive::TakeBagOfWords(BagOfWords& bag) {
  constexpr std::size_t kPairBytes = sizeof(std::uint32_t) + sizeof(double);
  input_.place.field = "mBowVec";
  TakeClassInfo(WireClass::kBowVector);
  const std::uint64_t count = TakeCollection("mBowVec", WireClass::kBowMap, kPairBytes);
  if (count == 0) return;
  TakeClassInfo(WireClass::kBowPair);
  bag.words.resize(count);
  bag.weights.resize(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    bag.words[i] = input_.Take<std::uint32_t>();
    bag.weights[i] = input_.Take<double>();
  }
}

void Archive::TakeFeatureVector(FeatureVector& vector) {
  constexpr std::size_t kLeastPairBytes = sizeof(std::uint32_t) + sizeof(std::uint64_t);
  input_.place.field = "mFeatVec";
  TakeClassInfo(WireClass::kFeatureVector);
  const std::uint64_t count = TakeCollection("mFeatVec", WireClass::kFeatureMap, kLeastPairBytes);
  if (count == 0) return;
  TakeClassInfo(WireClass::kFeaturePair);
  vector.nodes.resize(count);
  vector.sizes.resize(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    vector.nodes[i] = input_.Take<std::uint32_t>();
    const std::uint64_t size = TakeCount("mFeatVec", WireClass::kUnsigneds, sizeof(std::uint32_t));
    vector.sizes[i] = static_cast<std::uint32_t>(size);
    const std::size_t begin = vector.features.size();
    vector.features.resize(begin + size);
    input_.TakeArray(vector.features.data() + begin, size);
  }
}

void Archive::TakeGrid(FeatureGrid& grid) {
  const std::uint64_t columns = TakeCollection("mGrid", WireClass::kGrid, sizeof(std::uint64_t));
  grid.column_sizes.resize(columns);
  for (std::uint32_t& column : grid.column_sizes) {
    const std::uint64_t cells = TakeCollection("mGrid", WireClass::kGridColumn, sizeof(std::uint64_t));
    column = static_cast<std::uint32_t>(cells);
    for (std::uint64_t cell = 0; cell < cells; ++cell) {
      const std::uint64_t size = TakeCount("mGrid", WireClass::kSizes, sizeof(std::uint64_t));
      grid.cell_sizes.push_back(static_cast<std::uint32_t>(size));
      const std::size_t begin = grid.keypoints.size();
      grid.keypoints.resize(begin + size);
      input_.TakeArray(grid.keypoints.data() + begin, size);
    }
  }
}

}  // namespace slamdb::orbslam2
