// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/orbslam3/detail/fork_program.h"

// What of an atlas a file in a layout does not hold, and how it is said.
namespace slamdb::orbslam3 {

// Whether what the entities of the atlas carry is of that layout.
bool IsOfSameLayout(const Atlas& atlas, const std::string& layout);

// What people call a layout.
std::string TitleOf(const Layout& layout);
// The first ones, and how many more: `mnExtra, mpCamera3`.
std::string Listed(std::span<const std::string> texts, std::string_view between = ", ", std::size_t most = 8);
// The same of sentences.
inline std::string ListedSentences(std::span<const std::string> texts) { return Listed(texts, "; ", 4); }
// Members that the model does not know, of so many entities: `mnExtra of 14 keyframes; mpCamera3 of 200 map points`.
// Empty where nothing has any.
std::string ForeignMembers(const ForkProgram& program, std::uint64_t keyframes, std::uint64_t points,
                           std::uint64_t others);

// One sentence each for what is dropped: members of a fork that the layout does not have, and members of v1.0 that it
// does not have and that would not be the same when they are read back. Throws Error (kNotPossible) for a camera that
// v1.0 has no class for.
std::vector<std::string> LossesInLayout(const Atlas& atlas, const std::string& layout);

// What a file of the layout can hold, apart from what LossesInLayout names.
Content HeldBy(const Atlas& atlas, const std::string& layout);

}  // namespace slamdb::orbslam3
