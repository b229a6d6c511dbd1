// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/model/atlas.h"

// ORB-SLAM3 atlas files by stock Boost.Serialization and slamdb/boost.h: the oracle of the codec's tests, and the speed
// that the codec has to beat. It shares no code with the codec.
namespace slamdb::reference {

enum class Encoding { kBinary, kText };

// The atlas of a file; its encoding is left as for new files.
// Throws what slamdb/boost.h says. A damaged file can also crash it. It does not look at what stands behind the atlas.
Atlas Load(const std::string& path, Encoding encoding);

// The library version that Save writes and the newest that Load takes.
unsigned int ArchiveVersion();

// Replaces the file in place, with the library version of the Boost it is compiled with.
void Save(const Atlas& atlas, const std::string& path, Encoding encoding);

}  // namespace slamdb::reference
