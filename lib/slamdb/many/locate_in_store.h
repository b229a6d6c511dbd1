// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/align/locate_report.h"
#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/picture_features.h"

namespace slamdb {

struct LocateInStoreOptions {
  double lock_timeout = 5;  // seconds to wait for a program that holds the store
  int threads = 0;          // 0: every core
  Progress progress;        // may be empty
};

// The features of a picture, by its number, as the camera of an atlas takes pictures; nullopt: it takes none like that.
// Called from many threads.
using FeaturesFor = std::function<std::optional<PictureFeatures>(std::size_t picture, const Atlas& atlas)>;

struct LocatedInStore {
  // Of each picture, the atlases that were asked for it: the surest first, then those where it has most inliers.
  std::vector<std::vector<AtlasLocalization>> pictures;
  // Atlases that could not be asked, and why: damaged ones, those of which the store does not know what they look like,
  // and those whose server does not answer (StoredPlaces).
  std::vector<std::string> not_asked;
};

// Finds pictures in the atlases of a store: the store tells which keyframes look like them (Store::PlacesLike), and the
// maps of these are loaded, each once for all pictures, and asked (Locator::LocateAt).
// `looks`: by what places are recognised; descriptors are enough.
//
// Throws Error as Store::PlacesLike does.
// Cost: that, and for each map that is asked, loading it and comparing the picture with three places at most.
[[nodiscard]] SLAMDB_EXPORT LocatedInStore LocateInStore(Store& store, std::span<const PictureFeatures> looks,
                                                         const FeaturesFor& features_for,
                                                         const LocateInStoreOptions& options = {});

}  // namespace slamdb
