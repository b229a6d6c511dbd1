// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/base/error.h"
#include "slamdb/base/file.h"

namespace slamdb::detail {

// What a file is that no format reads, with what to do about it: `not an atlas: this is a COLMAP database ...`.
struct ForeignFile {
  ErrorKind kind;
  std::string sentence;
};

// By its first bytes; nullopt when nothing is known about it. May look into a folder, or further into a database.
std::optional<ForeignFile> RecognizeOther(const Probe& probe);

// The sentence for everything else: text or bytes that mean nothing here.
std::string DescribeUnknown(const Probe& probe);

}  // namespace slamdb::detail
