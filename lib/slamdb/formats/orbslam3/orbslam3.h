// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"

// ORB-SLAM3 v1.0 atlas files (.osa): Boost.Serialization archives, binary and text, without ORB-SLAM3 and without
// Boost.
// The bytes are described in schema/orbslam3.md.
// Reading a file and writing it again gives the same bytes.
//
// Why not through Boost's own archive classes:
//   they do not know the bytes left: a damaged count allocates what it says
//   they do not know where they are: an error has no offset and no object path
//   they fix the library version and the width of `long`
//   one virtual call, one lookup and one heap object per element make them several times slower than this codec
namespace slamdb {

SLAMDB_EXPORT extern const Format kOrbslam3Format;      // `orbslam3`: writes binary archives
SLAMDB_EXPORT extern const Format kOrbslam3TextFormat;  // `orbslam3-text`: writes text archives

// Reads either kind.
//
// Throws Error with byte offset and object path: kDamaged where bytes are wrong, kUnsupported for archives of other
// versions and machines.
// Thread-safe.
[[nodiscard]] SLAMDB_EXPORT Atlas ReadOrbslam3(const Source& source, const ReadOptions& options, Notices& notices);

// Writes the kind that atlas.encoding says, as Orbslam3WriteOptions has it.
//
// Throws Error as AtomicFile does, and
//   kUsage        the options ask for a Boost version or a width of long that there is not
//   kNotPossible  an id does not fit into a 4-byte long, or a repeated entry refers to no map before it
SLAMDB_EXPORT void WriteOrbslam3(const Atlas& atlas, const Target& target, const WriteOptions& options,
                                 Notices& notices);

// The same bytes in memory.
[[nodiscard]] SLAMDB_EXPORT std::string EncodeOrbslam3(const Atlas& atlas);

}  // namespace slamdb
