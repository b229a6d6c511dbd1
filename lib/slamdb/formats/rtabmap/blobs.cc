// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rtabmap/detail/blobs.h"

#include <zlib.h>

#include <Eigen/SVD>
#include <array>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::rtabmap {
namespace {

using detail::Concat;

// A zlib stream, and behind it rows, columns and type. Both types have 4 bytes an element.
template <class Value>
std::vector<Value> ValuesOf(Bytes blob, std::int32_t type, const Place& place) {
  static_assert(sizeof(Value) == 4);
  constexpr std::uint64_t kMostSwelling = 1032;  // zlib's own limit
  std::array<std::int32_t, 3> shape{};
  if (blob.empty()) return {};
  if (blob.size() < sizeof shape) place.Fail("a compressed matrix is cut");
  std::memcpy(shape.data(), blob.data() + blob.size() - sizeof shape, sizeof shape);
  const auto [rows, columns, found] = shape;
  if (found != type) place.Fail(Concat("a matrix has OpenCV's type ", found, ", expected ", type));
  if (rows < 0 || columns < 0) place.Fail(Concat("a matrix has ", rows, " rows and ", columns, " columns"));
  const Bytes stream = blob.first(blob.size() - sizeof shape);
  const std::uint64_t count = static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns);
  if (count > kMostSwelling * stream.size() / sizeof(Value))
    place.Fail(Concat("a matrix claims ", count, " numbers, which its ", stream.size(), " bytes cannot hold"));
  std::vector<Value> values(count);
  auto size = static_cast<uLongf>(count * sizeof(Value));
  const uLongf expected = size;
  if (count > 0 &&
      (uncompress(reinterpret_cast<Bytef*>(values.data()), &size, reinterpret_cast<const Bytef*>(stream.data()),
                  static_cast<uLong>(stream.size())) != Z_OK ||
       size != expected))
    place.Fail("a compressed matrix cannot be unpacked");
  return values;
}

}  // namespace

void Place::Fail(const std::string& problem) const { throw Error(ErrorKind::kDamaged, path, where, problem); }
void Place::Require(const std::string& why_not) const {
  if (!why_not.empty()) Fail(why_not);
}

std::optional<Pose> PoseOf(const float* rows, const Place& place) {
  const Eigen::Matrix<double, 3, 4> matrix =
      Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(rows).cast<double>();
  if (matrix.hasNaN() || matrix.isZero(0)) return std::nullopt;
  place.Require(detail::WhyNoPose(Eigen::Matrix3d(matrix.leftCols<3>()), matrix.col(3)));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix.leftCols<3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose pose = Pose::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = matrix.col(3);
  return pose;
}

std::optional<Pose> PoseOf(Bytes blob, const Place& place) {
  if (blob.empty()) return std::nullopt;
  std::array<float, 12> rows;
  if (blob.size() != sizeof rows) place.Fail(Concat("a pose has ", blob.size(), " bytes, expected ", sizeof rows));
  std::memcpy(rows.data(), blob.data(), sizeof rows);
  return PoseOf(rows.data(), place);
}

std::optional<GpsFix> FixOf(Bytes blob, double stamp, const Place& place) {
  if (blob.empty()) return std::nullopt;
  std::array<double, 6> numbers;
  if (blob.size() != sizeof numbers) place.Fail(Concat("a GPS fix has ", blob.size(), " bytes, expected 48"));
  std::memcpy(numbers.data(), blob.data(), sizeof numbers);
  GpsFix fix{.timestamp = numbers[0] > 0 ? numbers[0] : stamp, .place = {numbers[2], numbers[1], numbers[3]}};
  if (!IsPlace(fix.place)) return std::nullopt;
  return fix;
}

std::vector<std::int32_t> IntegersOf(Bytes blob, const Place& place) {
  return ValuesOf<std::int32_t>(blob, detail::kCv32S, place);
}
std::vector<float> FloatsOf(Bytes blob, const Place& place) { return ValuesOf<float>(blob, detail::kCv32F, place); }

}  // namespace slamdb::rtabmap
