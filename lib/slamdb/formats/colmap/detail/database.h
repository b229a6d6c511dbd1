// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "slamdb/base/atomic_file.h"
#include "slamdb/formats/colmap/detail/model.h"
#include "slamdb/formats/colmap/detail/outline.h"
#include "slamdb/formats/sqlite/detail/database.h"

// COLMAP's database of features and matches: schema/colmap.md.
namespace slamdb::colmap {

// Makes a database of models.
class DatabaseWriter {
 public:
  // Of the cameras, rigs, images, keypoints and descriptors of the outline. `path` is for errors.
  DatabaseWriter(const Outline& outline, ColmapSchema schema, const std::string& path);

  // The pairs of images that see the same points, with the relation of their poses.
  void AddPairs(const MapOutline& map, const Model& model);

  // Writes all of it.
  void Write(AtomicFile& file);

  std::uint64_t images() const { return images_; }
  std::uint64_t keypoints() const { return keypoints_; }
  std::uint64_t pairs() const { return pairs_; }

 private:
  void AddCameras();
  void AddRigs();
  void AddImages();
  void AddFeatures(const View& view, sqlite::Statement& keypoints, sqlite::Statement& descriptors);

  const Outline& outline_;
  ColmapSchema schema_;
  sqlite::Database database_;
  sqlite::Transaction transaction_;
  std::uint64_t images_ = 0, keypoints_ = 0, pairs_ = 0;
};

// What a database knows of the keypoints of one image.
struct ImageFeatures {
  std::size_t keypoints = 0;
  std::vector<float> scales, angles;   // of keypoints, pixels of the full image and radians; empty: not known
  std::size_t descriptor_bytes = 0;    // of each; 0: none
  std::vector<std::byte> descriptors;  // one behind the other, as many as keypoints
};

// The features of images. Reads without changing the file.
class FeatureDatabase {
 public:
  // Throws Error: no such file, no database of COLMAP.
  explicit FeatureDatabase(const std::string& path);

  // nullopt when it has no such image, or another one under that id.
  //
  // Throws Error (kDamaged) for blobs of another size than they say.
  std::optional<ImageFeatures> Find(const Image& image);

 private:
  sqlite::Database database_;
  std::unique_ptr<sqlite::Statement> name_, keypoints_, descriptors_;
};

}  // namespace slamdb::colmap
