// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>

#include "slamdb/formats/format.h"
#include "slamdb/formats/orbslam3/detail/fork_program.h"

// Files of forks: which layout they are read in, and what is said about it.
namespace slamdb::orbslam3 {

// Whether a layout, as options and atlases name it, is that of ORB-SLAM3 itself.
bool IsOwnLayout(std::string_view layout);
// How an atlas names the layout that it was read in: a known one by its id, v1.0 not at all.
std::string NameFor(const Layout& layout);

// A file in the layout that the options name, and whether all of it is like one.
struct LayoutReading {
  Atlas atlas;
  bool fits = true;
};
LayoutReading ReadInLayout(const Source& source, const ForkProgram& program, const ReadOptions& options,
                           Notices& notices);

// Reads a file in the known layout that fits: its last byte is reached, and keyframes have sensible times and
// orientations. Nothing when none does.
std::optional<Atlas> ReadInKnownLayout(const Source& source, const ReadOptions& options, Notices& notices);

// Hands the bytes of an atlas in another layout than v1.0 to `write`; LossesInLayout says what is not in them.
void WriteInLayout(const Atlas& atlas, const ArchiveEncoding& encoding, const std::string& layout,
                   const Target::Sink& write, const std::string& path, Notices& notices);

}  // namespace slamdb::orbslam3
