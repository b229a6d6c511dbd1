// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/formats/colmap/detail/database.h"

namespace slamdb::colmap {

// The database that lies where readers of a model look for its features, and that is not written with it: the user's,
// or what an earlier run left. It stays, and is of the model only as far as it has all of its images.
class KeptDatabase {
 public:
  // Of the model that is written into the folder.
  explicit KeptDatabase(const std::string& folder);

  void Compare(const Model& model);
  // When it is not of all models that were compared.
  void Warn(Notices& notices) const;

 private:
  std::string path_;     // empty: there is none
  std::string problem_;  // the first
  std::unique_ptr<FeatureDatabase> database_;
};

}  // namespace slamdb::colmap
