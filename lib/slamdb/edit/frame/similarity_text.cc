// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/similarity_text.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"

namespace slamdb {
namespace {

std::vector<double> NumbersIn(std::string_view text) {
  constexpr std::string_view kSeparators = " \t,;";
  std::vector<double> numbers;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    line = line.substr(0, line.find_first_of("#%"));
    for (auto word = detail::TakeWord(line, kSeparators); !word.empty(); word = detail::TakeWord(line, kSeparators)) {
      const auto number = detail::ParseNumber<double>(word);
      if (!number)
        throw Error(ErrorKind::kUsage,
                    detail::Concat("a transform is numbers only, but '", word.substr(0, 40), "' is none"));
      numbers.push_back(*number);
    }
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
    throw Error(ErrorKind::kUsage, "the last row of a 4x4 transform must be 0 0 0 1");
  const Eigen::Matrix3d scaled = matrix.leftCols<3>();
  const double determinant = scaled.determinant();
  if (std::isfinite(determinant) && determinant < 0)
    throw Error(ErrorKind::kUsage, "the matrix mirrors (its determinant is negative), which no motion does");
  if (determinant == 0) throw Error(ErrorKind::kUsage, "the matrix is singular: it has no inverse");
  const double scale = std::cbrt(determinant);
  const Eigen::Matrix3d rotation = scaled / scale;
  constexpr double kTolerance = 1e-3;  // of matrices that were written with few digits
  if (std::isfinite(determinant) && !(rotation * rotation.transpose()).isIdentity(kTolerance))
    throw Error(ErrorKind::kUsage,
                "the matrix shears or scales its axes differently: its left 3x3 part must be a scale times a rotation");
  return {scale, Eigen::Quaterniond(rotation), matrix.col(3)};
}

}  // namespace

Similarity3d ParseSimilarity(std::string_view text) {
  const std::vector<double> numbers = NumbersIn(detail::WithoutMark(text));
  const bool matrix = numbers.size() == 12 || numbers.size() == 16;
  if (!matrix && numbers.size() != 7 && numbers.size() != 8)
    throw Error(ErrorKind::kUsage,
                detail::Concat("a transform has 7 or 8 numbers (tx ty tz qx qy qz qw [scale]), or the 12 or 16 of a "
                               "matrix, not ",
                               numbers.size()));
  Similarity3d transform = matrix ? FromMatrix(numbers) : FromQuaternion(numbers);
  RequireTransform(transform);
  transform.rotation.normalize();
  return transform;
}

Similarity3d ReadSimilarity(const std::string& text_or_path) {
  std::error_code missing;
  if (std::filesystem::exists(text_or_path, missing)) return detail::ParseFile(text_or_path, ParseSimilarity);
  if (text_or_path.find_first_of("0123456789") == std::string::npos)
    throw Error(ErrorKind::kNotFound, text_or_path, "", "is neither a transform nor a file that holds one");
  return ParseSimilarity(text_or_path);
}

std::string ToText(const Similarity3d& transform) {
  const Eigen::Vector3d& t = transform.translation;
  const Eigen::Quaterniond& q = transform.rotation;
  std::string text;
  for (const double number : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), transform.scale}) {
    if (!text.empty()) text += ' ';
    detail::AppendNumber(text, number);
  }
  return text;
}

}  // namespace slamdb
