// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli/help/tree.h"
#include "cli/ranges.h"
#include "slamdb/formats/formats.h"
#include "slamdb/many/selected.h"

// Which part of an atlas a verb works on.
namespace slamdb::cli {

// --map, --keyframes A:B, --time A:B, --box.
struct SelectionOptions {
  std::optional<std::uint64_t> map;
  std::string keyframes, time, box;

  bool everything() const { return !map && keyframes.empty() && time.empty() && box.empty(); }
};
void AddSelection(CLI::App& verb, SelectionOptions& options);

// The part that was asked for. Times that count from the first keyframe (`+10`) or to the last (`-10`) need the span of
// the keyframes. Throws Error when there is none.
bool NeedsSpan(const SelectionOptions& options);
Selection ParseSelection(const SelectionOptions& options, const std::optional<TimeSpan>& span = {});
// The same, with the span read from the input where it is needed.
Selection ParseSelection(const SelectionOptions& options, const HeldSource& input, const ReadOptions& read);

}  // namespace slamdb::cli
