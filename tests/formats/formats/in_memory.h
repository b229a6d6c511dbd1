// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/formats/format.h"

namespace slamdb {

// The bytes that a format makes of an atlas, and the atlas that it makes of bytes, without files. Both throw Error.
std::string Encoded(const Format& format, const Atlas& atlas, const WriteOptions& options, Notices& notices);
std::string Encoded(const Format& format, const Atlas& atlas, const WriteOptions& options = {});
Atlas Decoded(const Format& format, std::string_view bytes, const ReadOptions& options = {});

// Whether it has columns that tell of keyframes, which it does not hold: written again they are others.
bool TellsOfKeyFrames(const Format& format);

// Options that every format can be written with: KML, GeoJSON and LAS need to know where on earth the map is.
WriteOptions ForAnyFormat(const WriteOptions& options = {});

}  // namespace slamdb
