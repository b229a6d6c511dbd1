// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/base/error.h"
#include "slamdb/base/file.h"

namespace slamdb::detail {

// What `parse` makes of the text of a file. Its errors get the path; those that it calls wrong usage, since it also
// reads texts that are given as options, are those of a damaged file.
template <class Parse>
auto ParseFile(const Source& source, const Parse& parse) {
  const MappedFile file(source);
  try {
    return parse(file.text());
  } catch (const Error& error) {
    const ErrorKind kind = error.kind() == ErrorKind::kUsage ? ErrorKind::kDamaged : error.kind();
    throw Error(kind, source.path, error.place(), error.problem());
  }
}

}  // namespace slamdb::detail
