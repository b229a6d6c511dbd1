// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/similarity.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "cli/report/layout.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/edit/frame/similarity_text.h"

namespace slamdb::cli {
namespace {

std::string Listed(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d unsigned_zeros = vector.array() + 0.0;
  return Short(unsigned_zeros.x(), 6) + " " + Short(unsigned_zeros.y(), 6) + " " + Short(unsigned_zeros.z(), 6);
}

}  // namespace

Similarity3d ReadSimilarity(const std::string& text_or_path) {
  std::error_code missing;
  if (!std::filesystem::exists(text_or_path, missing)) {
    if (text_or_path.find_first_of("0123456789") == std::string::npos)
      throw Error(text_or_path, "", "is neither a transform nor a file that holds one");
    return ParseSimilarity(text_or_path);
  }
  const MappedFile file(text_or_path);
  try {
    return ParseSimilarity(file.text());
  } catch (const Error& error) {
    throw Error(text_or_path, error.place(), error.problem());
  }
}

std::string SimilarityText(const Similarity3d& transform) {
  constexpr double kNothing = 1e-12;  // what a fit in double precision leaves of nothing
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (transform.translation.norm() > kNothing) add("translation " + Listed(transform.translation));
  const Eigen::AngleAxisd turn(transform.rotation);
  if (turn.angle() > kNothing)
    add("rotation " + Short(turn.angle() * 180 / std::numbers::pi, 6) + " degrees about " + Listed(turn.axis()));
  if (std::abs(transform.scale - 1) > kNothing) add("scale " + Short(transform.scale, 8));
  return text.empty() ? "nothing" : text;
}

}  // namespace slamdb::cli
