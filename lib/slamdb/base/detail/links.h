// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "slamdb/export.h"

namespace slamdb::detail {

// Where a path leads when every symbolic link is followed, also one that leads to nothing yet: the folder is canonical,
// and the last name is no link. A path that leads nowhere (a missing folder, a ring of links) comes back as it is.
// Links to open files of a process (`/dev/stdout`, `/dev/fd/3`) are not followed: what they show is no path that leads
// there.
std::filesystem::path FollowLinks(const std::filesystem::path& path);

// Where a file lies that is read or written with others beside it: what a symbolic link leads to, or the path as it is.
SLAMDB_EXPORT std::string LeadsTo(const std::string& path);

// Whether a followed path is an open file of a process, as `/proc/self/fd/1` is.
bool IsOpenFile(const std::filesystem::path& followed);

// `.` for a path without one.
std::filesystem::path FolderOf(const std::filesystem::path& path);

}  // namespace slamdb::detail
