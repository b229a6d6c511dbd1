// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace slamdb::rows {

// schema/0005_places.words, compiled into the library.
std::span<const unsigned char> PlaceTreeBytes();

}  // namespace slamdb::rows
