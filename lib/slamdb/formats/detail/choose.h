// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <new>
#include <string>
#include <string_view>

#include "slamdb/base/error.h"
#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The format with the longest suffix that the path ends with in any case, the first of equals, among those that `has`
// asks for; null when there is none.
const Format* FormatBySuffix(std::string_view path, bool (*has)(const Format&));

// The source, held so that its format can be told and then be read. A stream is refused by its beginning.
HeldSource Hold(const Source& source, const ReadOptions& options);

// The format to read a held source with: that of the options, or by content, then by suffix. Throws Error when there is
// none, or it does not read, or holds no atlases by name and one is named.
const Format& FormatToRead(const Source& source, const ReadOptions& options);

// The format to write a target with: that of the options, or by suffix. Throws Error likewise.
const Format& FormatToWrite(const Target& target, const WriteOptions& options);

// What `work` gives; running out of memory, which large and damaged files make it do, becomes an Error.
template <class Work>
auto InMemory(const std::string& path, const char* problem, const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::kOutOfResources, path, "", problem);
  }
}

// What reading a source gives; errors as InMemory.
template <class Work>
auto ReadInMemory(const Source& source, const Work& work) {
  return InMemory(source.path, "the machine has too little memory left to read it", work);
}

}  // namespace slamdb::detail
