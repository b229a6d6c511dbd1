// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/kept_database.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/folders.h"

namespace slamdb::colmap {

using detail::Concat;

KeptDatabase::KeptDatabase(const std::string& folder) : path_(FindDatabase(folder).value_or("")) {
  if (path_.empty()) return;
  try {
    database_ = std::make_unique<FeatureDatabase>(path_);
  } catch (const Error& error) {
    problem_ = error.problem();
  }
}

void KeptDatabase::Compare(const Model& model) {
  if (path_.empty() || !problem_.empty()) return;
  try {
    for (const Image& image : model.images) {
      if (database_->Find(image)) continue;
      problem_ = Concat("has no image ", image.id, " (", image.name, ") of ",
                        detail::Counted(image.points.size(), "keypoint"));
      return;
    }
  } catch (const Error& error) {
    problem_ = error.problem();
  }
}

void KeptDatabase::Warn(Notices& notices) const {
  if (problem_.empty()) return;
  notices.Warn(Concat(
      path_, ": is not the database of the model that is written, beside which it stays, and COLMAP does not notice: ",
      problem_, "; --with-database into a new folder writes one that is"));
}

}  // namespace slamdb::colmap
