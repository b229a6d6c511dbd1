// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/folders.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/detail/unfinished.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/model.h"

namespace slamdb::colmap {
namespace {

namespace fs = std::filesystem;
using detail::Concat;

using Has = std::function<bool(const std::string& folder)>;

bool MayHoldModels(const std::string& name) {
  return name == "sparse" || detail::ParseNumber<std::uint32_t>(name).has_value();
}

// `place` in the folder and those below it, as deep as scenes of several maps are: `1/sparse/0/`.
void AddPlaces(const std::string& folder, const std::string& place, int deeper, const Has& has,
               std::vector<std::string>& places) {
  const fs::path here = fs::path(folder) / place;
  if (has(here.string())) places.push_back(place);
  if (deeper == 0) return;
  std::error_code failed, missing;
  for (fs::directory_iterator entry(here, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (MayHoldModels(name) && entry->is_directory(missing))
      AddPlaces(folder, Concat(place, name, "/"), deeper - 1, has, places);
  }
}

// By whoever replaced files of this folder from one above it.
void RefuseUnfinishedAbove(const std::string& folder) {
  std::error_code failed;
  const fs::path real = fs::weakly_canonical(folder, failed);
  const std::vector<std::string> workspaces = WorkspacesOf(failed ? folder : real.string());
  for (const std::string& workspace : workspaces) {
    if (workspace == workspaces.front()) continue;
    const std::string below = fs::path(workspaces.front()).lexically_relative(workspace).string() + "/";
    detail::RefuseUnfinished(detail::UnfinishedIn(workspace), folder, below);
  }
}

// `folder` and `place` in it, without a slash at the end.
std::string PathOf(const std::string& folder, const std::string& place) {
  return place.empty() ? folder : (fs::path(folder) / place).parent_path().string();
}

Error Left(const std::string& folder, const std::string& place) {
  return {ErrorKind::kAlreadyExists, folder, "",
          Concat("holds a model or scene in ", PathOf(folder, place),
                 " that would be read with what is written, or in its place, or never again; remove it, or name "
                 "another folder")};
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

std::vector<std::string> WorkspacesOf(const std::string& folder) {
  constexpr int kUp = 2;
  std::error_code failed;
  fs::path place = fs::absolute(folder, failed).lexically_normal();
  if (!place.has_filename()) place = place.parent_path();
  std::vector<std::string> workspaces;
  for (int up = 0; up <= kUp; ++up, place = place.parent_path()) workspaces.push_back(place.string());
  return workspaces;
}

std::optional<std::string> FindDatabase(const std::string& folder) {
  std::error_code missing;
  for (const fs::path workspace : WorkspacesOf(folder))
    if (fs::is_regular_file(workspace / kDatabase, missing)) return (workspace / kDatabase).string();
  return std::nullopt;
}

void RefuseUnfinished(const std::string& folder) {
  detail::RefuseUnfinished(detail::UnfinishedIn(folder), folder);
  RefuseUnfinishedAbove(folder);
}

void RefuseLeft(const std::string& folder, const std::vector<std::string>& written, const Has& has) {
  constexpr int kDeepest = 3;
  std::vector<std::string> places;
  AddPlaces(folder, "", kDeepest, has, places);
  std::ranges::sort(places);
  for (const std::string& place : places)
    if (std::ranges::find(written, place) == written.end()) throw Left(folder, place);
}

void RefuseOtherModels(const std::string& folder, const std::vector<std::string>& written, std::string_view suffix,
                       std::size_t parts) {
  RefuseUnfinishedAbove(folder);
  RefuseLeft(folder, written, [](const std::string& place) { return HasModel(place); });
  std::error_code missing;
  for (const std::string& place : written) {
    const std::string path = PathOf(folder, place);
    if (suffix != kBinary && HasModel(path, kBinary)) throw Left(folder, place);
    for (std::size_t part = parts; part < kPartNames.size(); ++part)
      if (const std::string file = FileOf(path, kPartNames[part], suffix); fs::exists(file, missing))
        throw Error(ErrorKind::kAlreadyExists, file, "",
                    "is a part of a model that would be read with what is written; remove it, or name another folder");
  }
}

void RefuseOtherCloud(const std::string& folder, const std::vector<std::string>& written) {
  std::error_code missing;
  for (const std::string& place : written)
    if (const std::string cloud = FileOf(PathOf(folder, place), "points3D", ".ply"); fs::exists(cloud, missing))
      throw Error(ErrorKind::kAlreadyExists, cloud, "",
                  "is the cloud of another model, which trainers of splats would read in place of the points that are "
                  "written; remove it, or name another folder");
}

}  // namespace slamdb::colmap
