// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "slamdb/base/detail/file_stream.h"
#include "slamdb/formats/orbslam3/detail/input.h"
#include "slamdb/model/keyframe.h"

// The archive as a stream of tokens: numbers, counts, class information, pointers, matrices.
namespace slamdb::orbslam2 {

// The C++ types that take part in Boost's class table, named after what they hold. See schema/orbslam2.md.
enum class WireClass : std::uint8_t {
  kMap,
  kMapPoint,
  kKeyFrame,
  kDatabase,         // KeyFrameDatabase; behind it: what no pointer leads to
  kPointSet,         // set<MapPoint*>
  kPointList,        // vector<MapPoint*>
  kKeyFrameSet,      // set<KeyFrame*>
  kKeyFrameList,     // vector<KeyFrame*>
  kObservationMap,   // map<KeyFrame*, size_t>
  kObservationPair,  //
  kWeightMap,        // map<KeyFrame*, int>
  kWeightPair,       //
  kInvertedFile,     // vector<list<KeyFrame*>>
  kWordList,         // list<KeyFrame*>
  kMat,              // cv::Mat
  kKeypointList,     // vector<cv::KeyPoint>
  kKeypoint,         //
  kBowVector,        // BowVector, derived from ...
  kBowMap,           // ... map<unsigned, double>
  kBowPair,          //
  kFeatureVector,    // FeatureVector, derived from ...
  kFeatureMap,       // ... map<unsigned, vector<unsigned>>
  kFeaturePair,      //
  kGrid,             // vector<vector<vector<size_t>>>
  kGridColumn,       // vector<vector<size_t>>
  kSizes,            // vector<size_t>
  kFloats,           // vector<float>
  kUnsigneds,        // vector<unsigned>
  kInts,             // vector<int>
  kCount,
};
inline constexpr std::size_t kPointees = 4;  // the first classes, to which pointers lead

// An object that a pointer leads to: the `row`th of its class that the file holds.
struct Pointer {
  static constexpr std::uint32_t kNull = ~std::uint32_t{0};
  std::uint32_t row = kNull;
  bool is_new = false;  // its members stand here
};

// Reads tokens and keeps Boost's tables of classes and objects, which both sides of an archive fill alike. Checks every
// count against the bytes left; throws Error with byte offset and object.
class Archive {
 public:
  explicit Archive(detail::FileStream& file) : input_(&file, encoding_) { ids_.fill(-1); }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  orbslam3::Place& place() { return input_.place; }
  std::size_t offset() const { return input_.offset(); }
  bool AtEnd() const { return input_.AtEnd(); }
  std::size_t count(WireClass pointee) const { return counts_[static_cast<std::size_t>(pointee)]; }
  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind = ErrorKind::kDamaged) const {
    input_.Fail(problem, kind);
  }
  void Require(const std::string& why_not) const {
    if (!why_not.empty()) Fail(why_not);
  }

  template <class T>
  T Take(const char* field) {
    input_.place.field = field;
    return input_.Take<T>();
  }
  template <class T>
  void Skip(const char* field, std::size_t count) {
    input_.place.field = field;
    input_.SkipArray<T>(count);
  }
  // A bool is a byte, whatever it holds.
  Flag TakeFlag(const char* field) {
    Flag flag;
    flag.recorded = Take<std::uint8_t>(field);
    return flag;
  }

  // How many elements a collection has that take at least `bytes` each; and what stands before its first one.
  std::uint64_t TakeCollection(const char* field, WireClass collection, std::size_t bytes);
  // What stands in front of a value of a class, the first time.
  void TakeClassInfo(WireClass wire_class, std::uint8_t tracking = 0);
  // A vector of numbers.
  template <class Vector>
  void TakeNumbers(const char* field, WireClass vector, Vector& values) {
    values.resize(TakeCount(field, vector, sizeof values[0]));
    input_.TakeArray(values.data(), values.size());
  }
  Pointer TakePointer(WireClass pointee);

  Matrix TakeMatrix(const char* field);
  // A matrix of so many floats; leaves them as they are where it is empty.
  void TakeFloats(const char* field, float* values, std::int32_t rows, std::int32_t columns);
  void SkipMatrix(const char* field);
  void TakeKeypoints(const char* field, Column<Keypoint>& keypoints);
  void TakeBagOfWords(BagOfWords& bag);
  void TakeFeatureVector(FeatureVector& vector);
  void TakeGrid(FeatureGrid& grid);

 private:
  struct MatrixHead {
    std::int32_t columns, rows, type;
    std::uint64_t bytes;
  };
  struct Object {
    WireClass wire_class;
    std::uint32_t row;
  };

  std::int16_t Register(WireClass wire_class);
  std::uint64_t TakeCount(const char* field, WireClass vector, std::size_t bytes);
  std::uint64_t CheckCount(std::uint64_t count, std::size_t bytes) const { return input_.CheckCount(count, bytes, 1); }
  MatrixHead TakeMatrixHead(const char* field);

  ArchiveEncoding encoding_;
  orbslam3::BinaryInput input_;
  std::array<std::int16_t, static_cast<std::size_t>(WireClass::kCount)> ids_{};
  std::array<bool, static_cast<std::size_t>(WireClass::kCount)> informed_{};
  std::int16_t next_id_ = 0;
  std::vector<Object> objects_;
  std::array<std::uint32_t, kPointees> counts_{};
};

}  // namespace slamdb::orbslam2
