// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/formats/format.h"

namespace slamdb::python {

// What reading and writing had to say: kind (loss, warning, note) and text.
using NoticeList = std::vector<std::pair<std::string, std::string>>;
NoticeList ListOf(const Notices& notices);

class Arguments;
struct AtlasOrPath;

// map, keyframes, time, box: what of an atlas is read.
Selection ReadSelectionOf(Arguments& given);

// The same and format, layout, wait, threads, progress: how a source that is a path, or bytes, is read.
ReadOptions ReadingOf(Arguments& given);

// Throws Error (kUsage) where a part is asked for of what is in memory, which is whole.
void RefuseIdleSelection(const AtlasOrPath& source, const ReadOptions& read);

// Writes a page or a picture, which never replaces an atlas; nothing where no path is named.
void WriteShown(const std::string& path, bool overwrite, const std::string& bytes);

}  // namespace slamdb::python
