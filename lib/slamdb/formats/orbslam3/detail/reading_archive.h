// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/orbslam3/detail/input.h"
#include "slamdb/formats/orbslam3/detail/layout.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::orbslam3 {

// What the two archives (see layout.h) that read share, Decoder and Skipper: class info, counts and list headers. Every
// count is checked against the bytes left, before any allocation. What stands in the file and is not kept, since it has
// one sound value only, must have that value: so every byte of a file is either kept or known.
template <class Input>
class ReadingArchive {
 public:
  ReadingArchive(const Input& at, const ClassTable& table) : input(at), classes(table) {}

  Input input;
  ClassTable classes;

  void ClassInfo(WireClass wire_class) { TakeClassInfo(wire_class, 0); }
  // Tracked classes are those that are stored through pointers.
  void TakeClassInfo(WireClass wire_class, std::uint8_t tracking) {
    if (classes.FirstUse(wire_class)) [[unlikely]]
      TakeFirstInfo(tracking);
  }
  // The size of a container that Boost writes as a class: a map, or a vector of classes or pointers. An element takes
  // at least `bytes` bytes (`tokens` tokens in a text archive).
  std::uint64_t ClassCount(WireClass wire_class, std::size_t bytes, std::size_t tokens) {
    ClassInfo(wire_class);
    const std::uint64_t count = input.CheckCount(input.TakeSize(), bytes, tokens);
    TakeKnown(std::uint32_t{0}, "an item version");
    return count;
  }
  // The size of a vector of numbers.
  std::uint64_t VectorCount(WireClass wire_class, std::size_t bytes) {
    classes.Register(wire_class);
    return VectorCount(bytes);
  }
  // Of a class that is registered.
  std::uint64_t VectorCount(std::size_t bytes) {
    const std::uint64_t count = input.CheckCount(input.TakeSize(), bytes, 1);
    if constexpr (Input::kText) TakeKnown(std::uint32_t{0}, "an item version");
    return count;
  }
  // The headers of a bag of words and of a map<unsigned long, int>, up to their first entry.
  std::uint64_t BowCount() {
    ClassInfo(WireClass::kBowVector);
    const std::uint64_t count = ClassCount(WireClass::kBowMap, 12, 2);
    if (count > 0) ClassInfo(WireClass::kBowPair);
    return count;
  }
  std::uint64_t WeightCount() {
    const std::uint64_t count =
        ClassCount(WireClass::kWeightMap, input.encoding().long_bytes + sizeof(std::int32_t), 2);
    if (count > 0) ClassInfo(WireClass::kWeightPair);
    return count;
  }
  // Passes the entries of a bag of words: a word and a weight each.
  void SkipBowEntries(std::uint64_t count) { input.template SkipPairs<std::uint32_t, double>(count); }
  // Passes the cells of a column of a grid.
  void SkipGridColumn(std::uint64_t cells) {
    const std::uint8_t size_bytes = input.encoding().size_bytes;
    while (cells > 0) {
      cells -= input.TakeSeenSizeVectors(cells, 0, [](std::size_t, const char*) {});
      if (cells == 0) return;
      input.SkipSizes(VectorCount(size_bytes));
      --cells;
    }
  }
  std::uint64_t UnsignedLongCount() { return VectorCount(WireClass::kUnsignedLongs, input.encoding().long_bytes); }
  std::uint64_t KeypointCount() {
    const auto count = input.template Take<std::int32_t>();
    if (count < 0) input.FailCount(static_cast<std::uint32_t>(count));
    return input.CheckCount(static_cast<std::uint64_t>(count), sizeof(Keypoint), 7);
  }
  // A descriptor matrix: rows of ORB descriptors. One of another kind is `other`, without its data, and has no rows of
  // ORB's; `other` is left as it is otherwise.
  std::uint64_t DescriptorRows(MatrixForm* form, Matrix& other) {
    const auto columns = input.template Take<std::int32_t>();
    const auto rows = input.template Take<std::int32_t>();
    const auto type = input.template Take<std::int32_t>();
    const auto continuous = input.template Take<std::uint8_t>();
    if (continuous > 1) RefuseValue("a matrix flag", continuous, "0 or 1");
    if (rows == 0 && columns == 0 && type == 0) {
      *form = continuous != 0 ? MatrixForm::kEmptyContinuous : MatrixForm::kEmpty;
      return 0;
    }
    constexpr std::int32_t kMostColumns = 4096, kKinds = 7;  // one channel of OpenCV's CV_8U .. CV_64F
    if (columns < 1 || columns > kMostColumns || type < 0 || type >= kKinds || rows < 0)
      input.Fail("a descriptor matrix of " + std::to_string(rows) + " x " + std::to_string(columns) + ", type " +
                 std::to_string(type) +
                 ", expected N x 32, type 0: the file is damaged, or written by a fork with other members");
    if (columns != 32 || type != 0) {
      other.rows = rows;
      other.columns = columns;
      other.type = type;
      other.continuous.recorded = continuous;
      *form = MatrixForm::kEmpty;
      return 0;
    }
    *form = continuous != 0 ? MatrixForm::kUsual : MatrixForm::kUsualNotContinuous;
    return input.CheckCount(static_cast<std::uint64_t>(rows), sizeof(Descriptor), sizeof(Descriptor));
  }
  // A small matrix of any type: its header, returns the number of data bytes.
  std::uint64_t MatrixBytes(Matrix& matrix) {
    matrix.columns = input.template Take<std::int32_t>();
    matrix.rows = input.template Take<std::int32_t>();
    matrix.type = input.template Take<std::int32_t>();
    matrix.continuous.recorded = input.template Take<std::uint8_t>();
    if (matrix.columns < 0 || matrix.rows < 0 || !slamdb::detail::IsMatrixType(matrix.type))
      input.Fail("a matrix of " + std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns) + ", type " +
                 std::to_string(matrix.type) + ": the file is damaged, or written by a fork with other members");
    return DataBytes(matrix);
  }
  // How many bytes the data of a matrix has, of which the header is known.
  std::uint64_t DataBytes(const Matrix& matrix) const {
    const std::uint64_t element = slamdb::detail::ElementBytes(matrix.type);
    const std::uint64_t cells = static_cast<std::uint64_t>(matrix.columns) * static_cast<std::uint64_t>(matrix.rows);
    return input.CheckCount(cells, element, element) * element;
  }

 private:
  [[gnu::cold, gnu::noinline]] void TakeFirstInfo(std::uint8_t tracking) {
    TakeKnown(tracking, "class tracking");
    const auto version = input.template Take<std::uint32_t>();
    if (version != 0)
      input.Fail("class version " + std::to_string(version) +
                     ", expected 0: written by a fork, or by an ORB-SLAM3 later than v1.0",
                 ErrorKind::kUnsupported);
  }
  // Takes what the model does not keep.
  template <class T>
  void TakeKnown(T expected, const char* what) {
    if (const T found = input.template Take<T>(); found != expected) [[unlikely]]
      RefuseValue(what, found, expected == 0 ? "0" : "1");
  }
  [[gnu::cold, gnu::noinline]] void RefuseValue(const char* what, std::uint32_t found, const char* expected) const {
    input.Refuse(std::string(what) + " of " + std::to_string(found) + ", expected " + expected +
                 ": the file is damaged, or not written by ORB-SLAM3 v1.0");
  }
};

}  // namespace slamdb::orbslam3
