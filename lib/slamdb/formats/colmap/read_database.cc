// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/database.h"

namespace slamdb::colmap {
namespace {

using detail::Concat;
using sqlite::Database;
using sqlite::Statement;

constexpr double kPatience = 10;  // seconds that a program may hold the database

// A matrix in a row of a table: rows, cols, data.
struct Blob {
  std::uint64_t rows = 0, columns = 0;
  Bytes data;
};

// The row of an image; nullopt when it has none.
std::optional<Blob> Step(Statement& statement, std::uint32_t image, std::size_t element_bytes, const Database& database,
                         std::string_view table) {
  statement.Reset();
  if (!statement.Bind(1, std::int64_t{image}).Step()) return std::nullopt;
  const std::int64_t rows = statement.Integer(0), columns = statement.Integer(1);
  const Bytes data = statement.Blob(2);
  // Blobs have at most 2^31 bytes.
  constexpr std::int64_t kMost = std::int64_t{1} << 31;
  if (rows < 0 || columns < 0 || rows > kMost || columns > kMost ||
      data.size() != static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns) * element_bytes)
    throw Error(ErrorKind::kDamaged, database.path(), Concat("table ", table, ", image ", image),
                Concat("says ", rows, " rows of ", columns, " and has ", data.size(), " bytes"));
  return Blob{static_cast<std::uint64_t>(rows), static_cast<std::uint64_t>(columns), data};
}

// Scale and orientation, which stand as themselves or in an affine matrix.
void SetShapes(const Blob& blob, ImageFeatures& features) {
  constexpr std::uint64_t kScaleAndAngle = 4, kAffine = 6;
  if (blob.columns != kScaleAndAngle && blob.columns != kAffine) return;
  features.scales.reserve(blob.rows);
  features.angles.reserve(blob.rows);
  for (std::uint64_t row = 0; row < blob.rows; ++row) {
    std::array<float, kAffine> values{};
    std::memcpy(values.data(), blob.data.data() + row * blob.columns * sizeof(float), blob.columns * sizeof(float));
    const bool affine = blob.columns == kAffine;
    features.scales.push_back(affine ? std::hypot(values[2], values[4]) : values[2]);
    features.angles.push_back(affine ? std::atan2(values[4], values[2]) : values[3]);
  }
}

void RequireTables(Database& database) {
  for (const std::string_view table : {"images", "keypoints", "descriptors"})
    if (!database.HasTable(table))
      throw Error(ErrorKind::kUnsupported, database.path(), "",
                  Concat("is no database of COLMAP: has no table ", table));
}

}  // namespace

FeatureDatabase::FeatureDatabase(const std::string& path) : database_(path, sqlite::Access::kRead, kPatience) {
  detail::EnterInput(path);
  RequireTables(database_);
  name_ = std::make_unique<Statement>(database_, "SELECT name FROM images WHERE image_id = ?1", "table images");
  keypoints_ = std::make_unique<Statement>(database_, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?1",
                                           "table keypoints");
  descriptors_ = std::make_unique<Statement>(database_, "SELECT rows, cols, data FROM descriptors WHERE image_id = ?1",
                                             "table descriptors");
}

std::optional<ImageFeatures> FeatureDatabase::Find(const Image& image) {
  name_->Reset();
  if (!name_->Bind(1, std::int64_t{image.id}).Step() || name_->Text(0) != image.name) return std::nullopt;
  ImageFeatures features;
  const auto keypoints = Step(*keypoints_, image.id, sizeof(float), database_, "keypoints");
  if (!keypoints || keypoints->rows != image.points.size()) return std::nullopt;
  features.keypoints = keypoints->rows;
  SetShapes(*keypoints, features);
  const auto descriptors = Step(*descriptors_, image.id, 1, database_, "descriptors");
  if (!descriptors || descriptors->rows != features.keypoints) return features;
  features.descriptor_bytes = descriptors->columns;
  features.descriptors.assign(descriptors->data.begin(), descriptors->data.end());
  return features;
}

}  // namespace slamdb::colmap
