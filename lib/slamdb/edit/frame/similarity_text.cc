// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/similarity_text.h"

#include <Eigen/LU>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"

namespace slamdb {
namespace {

constexpr std::string_view kSeparators = " \t\r\n,;";

std::string WithoutComments(std::string_view text) {
  std::string kept;
  bool comment = false;
  for (const char letter : text) {
    if (letter == '#') comment = true;
    if (letter == '\n') comment = false;
    if (!comment) kept += letter;
  }
  return kept;
}

std::vector<double> ParseNumbers(std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t begin = text.find_first_not_of(kSeparators); begin != std::string_view::npos;
       begin = text.find_first_not_of(kSeparators, begin)) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    double number = 0;
    const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size())
      throw Error("a transform is numbers only, but '" + std::string(word.substr(0, 40)) + "' is none");
    numbers.push_back(number);
    begin = end;
  }
  return numbers;
}

Similarity3d FromQuaternion(const std::vector<double>& n) {
  return {n.size() == 8 ? n[7] : 1, Eigen::Quaterniond(n[6], n[3], n[4], n[5]), {n[0], n[1], n[2]}};
}

Similarity3d FromMatrix(const std::vector<double>& numbers) {
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const Eigen::Map<const Rows> matrix(numbers.data());
  if (numbers.size() == 16 && !(numbers[12] == 0 && numbers[13] == 0 && numbers[14] == 0 && numbers[15] == 1))
    throw Error("the last row of a 4x4 transform must be 0 0 0 1");
  const Eigen::Matrix3d scaled = matrix.leftCols<3>();
  const double determinant = scaled.determinant();
  if (std::isfinite(determinant) && determinant < 0)
    throw Error("the matrix mirrors (its determinant is negative), which no motion does");
  if (determinant == 0) throw Error("the matrix is singular: it has no inverse");
  const double scale = std::cbrt(determinant);
  const Eigen::Matrix3d rotation = scaled / scale;
  constexpr double kTolerance = 1e-3;  // of matrices that were written with few digits
  if (std::isfinite(determinant) && !(rotation * rotation.transpose()).isIdentity(kTolerance))
    throw Error("the matrix shears or scales its axes differently: its left 3x3 part must be a scale times a rotation");
  return {scale, Eigen::Quaterniond(rotation), matrix.col(3)};
}

}  // namespace

Similarity3d ParseSimilarity(std::string_view text) {
  const std::vector<double> numbers = ParseNumbers(WithoutComments(text));
  const bool matrix = numbers.size() == 12 || numbers.size() == 16;
  if (!matrix && numbers.size() != 7 && numbers.size() != 8)
    throw Error("a transform has 7 or 8 numbers (tx ty tz qx qy qz qw [scale]), or the 12 or 16 of a matrix, not " +
                std::to_string(numbers.size()));
  Similarity3d transform = matrix ? FromMatrix(numbers) : FromQuaternion(numbers);
  RequireTransform(transform);
  transform.rotation.normalize();
  return transform;
}

std::string ToText(const Similarity3d& transform) {
  const Eigen::Vector3d& t = transform.translation;
  const Eigen::Quaterniond& q = transform.rotation;
  std::string text;
  for (const double number : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), transform.scale}) {
    std::array<char, 32> digits{};
    const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    if (!text.empty()) text += ' ';
    text.append(digits.data(), result.ptr);
  }
  return text;
}

}  // namespace slamdb
