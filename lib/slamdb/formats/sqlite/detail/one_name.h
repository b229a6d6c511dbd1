// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

// SQLite keeps one log per name of a file. A store that is written under two names has two logs, each of which is lost
// on whoever comes by the other name: so a store that is written has one name.
namespace slamdb::sqlite {

// Throws Error (kUsage) when the file, which need not exist, has another name: a hard link, or one outside the mount
// that was made of this file alone. Symbolic links are no names: SQLite follows them.
void CheckHasOneName(const std::string& path);

// Throws Error (kUsage) when the file has another name in its folder beside which there is a log that this name lacks.
void CheckLogIsOfThisName(const std::string& path);

}  // namespace slamdb::sqlite
