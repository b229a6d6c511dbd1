// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/folders.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/model.h"

namespace slamdb::colmap {
namespace {

namespace fs = std::filesystem;
using detail::Concat;

bool MayHoldModels(const std::string& name) {
  return name == "sparse" || detail::ParseNumber<std::uint32_t>(name).has_value();
}

// `place` in the folder and those below it, as deep as scenes of several maps are: `1/sparse/0/`.
void AddModels(const std::string& folder, const std::string& place, int deeper, std::vector<std::string>& places) {
  const fs::path here = fs::path(folder) / place;
  if (HasModel(here.string())) places.push_back(place);
  if (deeper == 0) return;
  std::error_code failed, missing;
  for (fs::directory_iterator entry(here, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (MayHoldModels(name) && entry->is_directory(missing))
      AddModels(folder, Concat(place, name, "/"), deeper - 1, places);
  }
}

}  // namespace

std::string FileOf(const std::string& folder, std::string_view part, std::string_view suffix) {
  return (fs::path(folder) / Concat(part, suffix)).string();
}

bool HasModel(const std::string& folder, std::string_view suffix) {
  std::error_code missing;
  return std::ranges::all_of(kPartNames.begin(), kPartNames.begin() + kNeeded, [&](std::string_view part) {
    return fs::is_regular_file(FileOf(folder, part, suffix), missing);
  });
}

void RefuseOtherModels(const std::string& folder, const std::vector<std::string>& written, std::string_view suffix) {
  constexpr int kDeepest = 3;
  std::vector<std::string> places;
  AddModels(folder, "", kDeepest, places);
  std::ranges::sort(places);
  for (const std::string& place : places) {
    const std::string path = place.empty() ? folder : (fs::path(folder) / place).parent_path().string();
    const bool is_replaced = std::ranges::find(written, place) != written.end();
    if (is_replaced && (suffix == kBinary || !HasModel(path, kBinary))) continue;
    throw Error(ErrorKind::kAlreadyExists, folder, "",
                Concat("holds a model in ", path,
                       " that would be read with what is written, or in its place, or never again; remove it, "
                       "or name another folder"));
  }
}

}  // namespace slamdb::colmap
