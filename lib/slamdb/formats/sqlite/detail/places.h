// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "slamdb/formats/rows/places.h"
#include "slamdb/formats/sqlite/detail/database.h"

namespace slamdb::sqlite {

// Store::PlacesLike, in the caller's transaction.
StoredPlaces FindPlaces(Database& database, std::span<const std::span<const Descriptor>> pictures,
                        const PlaceOptions& options);

}  // namespace slamdb::sqlite
