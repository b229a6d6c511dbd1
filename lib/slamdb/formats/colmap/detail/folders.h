// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamdb::colmap {

inline constexpr std::string_view kBinary = ".bin", kText = ".txt";
inline constexpr std::string_view kDatabase = "database.db";
inline constexpr std::size_t kNeeded = 3;  // of kPartNames; older versions write no more

std::string FileOf(const std::string& folder, std::string_view part, std::string_view suffix);
bool HasModel(const std::string& folder, std::string_view suffix);
inline bool HasModel(const std::string& folder) { return HasModel(folder, kBinary) || HasModel(folder, kText); }

// The folder and those above it that may be the workspace of its model, as COLMAP's tutorials lay it: above `sparse/0`.
std::vector<std::string> WorkspacesOf(const std::string& folder);

// The database of the workspace, from which the model in the folder gets its features.
std::optional<std::string> FindDatabase(const std::string& folder);

// Throws Error when a program was killed, or is at work, that replaces the files of the model
// (detail::RefuseUnfinished).
void RefuseUnfinished(const std::string& folder);

// What an earlier run wrote stays where it is: a model or scene that would be read in place of what is written, or as a
// further map of it, is refused, and so is one that what is written would hide.
//
// `written`: the folders in `folder` that get one: ``, `0/`, `sparse/0/`.
//
// Throws Error: kAlreadyExists; as RefuseUnfinished() does, for what was replaced from a folder above.
void RefuseOtherModels(const std::string& folder, const std::vector<std::string>& written, std::string_view suffix,
                       std::size_t parts);
// The same of all that `has` finds in a folder.
void RefuseLeft(const std::string& folder, const std::vector<std::string>& written,
                const std::function<bool(const std::string& folder)>& has);
// The cloud of points that a scene for splats has beside its model: trainers take it in place of the model's points.
// Throws Error (kAlreadyExists).
void RefuseOtherCloud(const std::string& folder, const std::vector<std::string>& written);

}  // namespace slamdb::colmap
