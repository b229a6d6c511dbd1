// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/location.h"

namespace slamdb {

// The longest suffix of a format that the path ends with (`.keyframes.csv`), or what stands behind its last dot.
[[nodiscard]] SLAMDB_EXPORT std::string SuffixOf(const std::string& path);

// The file's name without that suffix and its folders: what its atlas is called in a store.
[[nodiscard]] SLAMDB_EXPORT std::string StemOf(const std::string& path);

// What an atlas is called: `lab` of maps/lab.osa.txt and of maps.db#lab.
[[nodiscard]] SLAMDB_EXPORT std::string NameOf(const Location& atlas);

// Of a revision of an atlas in a store (lab.db#lab@3) the atlas itself, where it can be found; of all others
// themselves.
[[nodiscard]] SLAMDB_EXPORT Location WithoutRevision(const Location& atlas);

// An output in a store without a name gets that of the input: its name in a store, else the stem of its file. So a
// second atlas comes to lie beside the first. Standard input, what is no file, and a stem that is no name of an atlas
// (IsNameOfAtlas) name nothing. `format`: asked for; empty: as the output's suffix has it.
[[nodiscard]] SLAMDB_EXPORT std::string NamedOutput(const std::string& input, const std::string& output,
                                                    const std::string& format);

}  // namespace slamdb
