// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/similarity_text.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/lengths.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/pose_columns.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/detail/time_units.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb {
namespace {

// ---- a row under names

const detail::TableKind& NamedTransform() {
  static const detail::TableKind kind = [] {
    detail::TableKind made{.by_position = false};
    for (std::size_t i = 0; i < 3; ++i) made.columns.push_back(detail::PositionColumn(i));
    for (std::size_t i = 0; i < 4; ++i) made.columns.push_back(detail::QuaternionColumn(i));
    made.columns.push_back({{"scale", "s"}, detail::Column::kOptional});
    return made;
  }();
  return kind;
}

// The 7 or 8 numbers of the row under `tx ty tz qx qy qz qw [scale]`, in any order of columns; none without such names.
std::vector<double> NumbersUnderNames(std::string_view text) {
  if (detail::FindLayout(text, NamedTransform()).names.empty()) return {};
  detail::Table table(text, NamedTransform());
  std::vector<double> numbers;
  while (table.Next()) {
    if (!numbers.empty()) throw table.LineError("expected one row, a transform: is this a trajectory?");
    for (std::size_t i = 0; i < NamedTransform().columns.size(); ++i)
      if (table.Has(i)) numbers.push_back(table.Get<double>(i) * (i < 3 ? detail::MetresIn(table, i) : 1));
  }
  if (numbers.empty()) throw Error(ErrorKind::kUsage, "names the columns of a transform, but no row is below");
  return numbers;
}

// ---- numbers alone, between any separators

bool Has(std::string_view text, char letter) { return text.find(letter) != text.npos; }

// Where cells are quoted, commas between them are separators, and those within are not.
std::string WithoutQuotes(std::string_view text) {
  if (!Has(text, '"')) return std::string(text);
  std::string plain;
  bool quoted = false;
  for (const char letter : text) {
    if (letter == '"') quoted = !quoted;
    plain += letter == '"' ? ' ' : letter == ',' && !quoted ? ';' : letter;
  }
  return plain;
}

// The words between blanks, semicolons and line ends, in which commas may stand.
std::vector<std::string_view> WordsIn(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    line = line.substr(0, line.find_first_of("#%"));
    if (line.starts_with("sep=")) continue;
    for (auto word = detail::TakeWord(line, " \t;"); !word.empty(); word = detail::TakeWord(line, " \t;"))
      if (word != ",") words.push_back(word);
  }
  return words;
}

bool IsCount(std::size_t numbers) { return numbers == 7 || numbers == 8 || numbers == 12 || numbers == 16; }

// Commas between digits are decimal commas where something else separates the numbers, as in tables; where that gives
// no transform they separate.
bool HasDecimalCommas(const std::vector<std::string_view>& words, std::size_t between_commas) {
  if (std::ranges::none_of(words, [](std::string_view word) { return Has(word, ','); })) return false;
  const bool decimals =
      std::ranges::all_of(words, [](std::string_view word) { return !Has(word, ',') || detail::IsDecimalComma(word); });
  if (!decimals || !IsCount(words.size())) return false;
  if (std::ranges::none_of(words, [](std::string_view word) { return Has(word, '.'); })) return true;
  throw Error(ErrorKind::kUsage,
              detail::Concat("a transform has one decimal mark, but commas and points stand in it: ", words.size(),
                             " numbers with decimal commas, or ", between_commas, " between commas"));
}

std::vector<double> NumbersIn(std::string_view text) {
  const std::string plain = WithoutQuotes(text);
  std::vector<std::string_view> words = WordsIn(plain), parts;
  for (std::string_view word : words)
    for (auto part = detail::TakeWord(word, ","); !part.empty(); part = detail::TakeWord(word, ","))
      parts.push_back(part);
  const bool decimal = HasDecimalCommas(words, parts.size());
  std::vector<double> numbers;
  for (const std::string_view word : decimal ? words : parts) {
    const auto number = detail::ParseNumber<double>(decimal ? detail::WithPoint(word) : std::string(word));
    if (!number)
      throw Error(ErrorKind::kUsage,
                  detail::Concat("a transform is numbers only, but '", word.substr(0, 40), "' is none"));
    numbers.push_back(*number);
  }
  return numbers;
}

// ---- what the numbers mean

// A line of a trajectory: time, position and orientation are 8 numbers as well.
void RefuseTimedPose(const std::vector<double>& n) {
  const bool behind_time = detail::IsNearUnit(Eigen::Quaterniond(n[7], n[4], n[5], n[6]));
  const bool plain = detail::IsNearUnit(Eigen::Quaterniond(n[6], n[3], n[4], n[5]));
  if (!behind_time || (plain && !detail::IsEpoch(n[0]))) return;
  throw Error(
      ErrorKind::kUsage,
      detail::Concat("8 numbers are tx ty tz qx qy qz qw scale, but these look like a line of a TUM trajectory, "
                     "whose first number is a time: ",
                     detail::Digits(n[0], 13), "; give the 7 behind it"));
}

Similarity3d FromQuaternion(const std::vector<double>& n) {
  if (n.size() == 8) RefuseTimedPose(n);
  const Similarity3d transform{
      n.size() == 8 ? n[7] : 1, Eigen::Quaterniond(n[6], n[3], n[4], n[5]), {n[0], n[1], n[2]}};
  RequireTransform(transform);
  if (!detail::IsNearUnit(transform.rotation))
    throw Error(ErrorKind::kUsage,
                detail::Concat("the quaternion of the transform, qx qy qz qw = ", n[3], ' ', n[4], ' ', n[5], ' ', n[6],
                               ", is of length ", transform.rotation.norm(), ", but must be of length 1"));
  return transform;
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
  text = detail::WithoutMark(text);
  std::vector<double> numbers = NumbersUnderNames(text);
  if (numbers.empty()) numbers = NumbersIn(text);
  if (!IsCount(numbers.size()))
    throw Error(ErrorKind::kUsage,
                detail::Concat("a transform has 7 or 8 numbers (tx ty tz qx qy qz qw [scale]), or the 12 or 16 of a "
                               "matrix, not ",
                               numbers.size()));
  Similarity3d transform = numbers.size() >= 12 ? FromMatrix(numbers) : FromQuaternion(numbers);
  RequireTransform(transform);
  transform.rotation.normalize();
  return transform;
}

Similarity3d ReadSimilarity(const std::string& text_or_path) {
  std::error_code missing;
  if (std::filesystem::exists(text_or_path, missing))
    return detail::ParseFile(text_or_path, "a transform", ParseSimilarity);
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
