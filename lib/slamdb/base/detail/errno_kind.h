// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/error.h"

namespace slamdb::detail {

// What a program can do about an errno: ENOENT is kNotFound, EACCES kPermission, ENOSPC kOutOfResources, and so on.
ErrorKind KindOfErrno(int code);

}  // namespace slamdb::detail
