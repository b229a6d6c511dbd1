// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slamdb::colmap {

inline constexpr std::string_view kBinary = ".bin", kText = ".txt";
inline constexpr std::size_t kNeeded = 3;  // of kPartNames; older versions write no more

std::string FileOf(const std::string& folder, std::string_view part, std::string_view suffix);
bool HasModel(const std::string& folder, std::string_view suffix);
inline bool HasModel(const std::string& folder) { return HasModel(folder, kBinary) || HasModel(folder, kText); }

// Models of an earlier run stay where they are: one that would be read in place of what is written, or as a further map
// of it, is refused, and so is one that what is written would hide.
//
// `written`: the folders in `folder` that get a model of `suffix`: ``, `0/`, `sparse/0/`.
//
// Throws Error (kAlreadyExists).
void RefuseOtherModels(const std::string& folder, const std::vector<std::string>& written, std::string_view suffix);

}  // namespace slamdb::colmap
