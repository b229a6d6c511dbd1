// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/edit/ids/id_map.h"

// Files of id maps: JSON when their name ends with .json (schema/id_map.schema.json), CSV otherwise.
namespace slamdb::cli {

// Reads one. Throws Error with the path.
std::vector<IdMap> ReadIdMaps(const std::string& path);

// The id map of one input. Throws Error when the file has several and `input` names none of them.
IdMap ReadIdMap(const std::string& path, const std::string& input);

// An id map to be written once the work has succeeded. Throws Error at once when the file is there and may not be
// replaced. With an empty path it does nothing.
class IdMapFile {
 public:
  IdMapFile(const std::string& path, bool overwrite);
  void Write(std::span<const IdMap> maps);

 private:
  std::string path_;
  std::optional<AtomicFile> file_;
};

}  // namespace slamdb::cli
