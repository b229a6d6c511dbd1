// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"

// ORB-SLAM3 v1.0 atlas files (.osa): Boost.Serialization archives, binary and text, without ORB-SLAM3 and without
// Boost. The bytes are described in schema/orbslam3.md. Reading a file and writing it again gives the same bytes.
//
// Why not through Boost's own archive classes: they know neither the bytes left (a damaged count allocates what it
// says) nor where they are (an error has no offset and no object path), they fix the library version and the width of
// `long`, and one virtual call, one lookup and one heap object per element make them several times slower than this
// codec.
namespace slamdb {

SLAMDB_EXPORT extern const Format kOrbslam3Format;      // `orbslam3`: writes binary archives
SLAMDB_EXPORT extern const Format kOrbslam3TextFormat;  // `orbslam3-text`: writes text archives

// Reads either kind. Thread-safe. Throws Error with byte offset and object path.
[[nodiscard]] SLAMDB_EXPORT Atlas ReadOrbslam3(const Source& source, const ReadOptions& options, Notices& notices);

// Writes the kind that atlas.encoding says, as Orbslam3WriteOptions has it.
// Throws Error, also when an id does not fit into a 4-byte long.
SLAMDB_EXPORT void WriteOrbslam3(const Atlas& atlas, const Target& target, const WriteOptions& options,
                                 Notices& notices);

// The same bytes in memory.
[[nodiscard]] SLAMDB_EXPORT std::string EncodeOrbslam3(const Atlas& atlas);

}  // namespace slamdb
