// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/base/notices.h"

namespace slamdb::detail {

// What `parse` makes of the text of a file, which is to be `wanted` (`a journal`); one that is known to be something
// else, and not of `takes`, is refused as that. Errors of `parse` get the path; those that it calls wrong usage, since
// it also reads texts that are given as options, are those of a damaged file.
template <class Parse>
auto ParseFile(const Source& source, std::string_view wanted, const Parse& parse,
               std::initializer_list<std::string_view> takes = {}) {
  const auto refuse = [&](const Probe& beginning) { RefuseOther(beginning, wanted, takes); };
  const WholeFile file(source, refuse);
  refuse(Probe::Of({file.bytes(), file.path()}));
  try {
    return parse(file.text());
  } catch (const Error& error) {
    const ErrorKind kind = error.kind() == ErrorKind::kUsage ? ErrorKind::kDamaged : error.kind();
    throw Error(kind, source.path, error.place(), error.problem());
  }
}

// The same as ParseFile, of a text whose lines are records.
template <class Parse>
auto ParseLines(const Source& source, std::string_view wanted, Notices& notices, const Parse& parse) {
  return ParseFile(source, wanted, [&](std::string_view text) {
    WarnOfOpenEnd(text, source.path, notices);
    return parse(text);
  });
}

}  // namespace slamdb::detail
