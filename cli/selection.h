// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli/help/tree.h"
#include "cli/ranges.h"
#include "slamdb/formats/formats.h"

// Which part of an atlas a verb works on.
namespace slamdb::cli {

// --map, --keyframes A:B, --time A:B, --box.
struct SelectionOptions {
  std::optional<std::uint64_t> map;
  std::string keyframes, time, box;

  bool everything() const { return !map && keyframes.empty() && time.empty() && box.empty(); }
};
void AddSelection(CLI::App& verb, SelectionOptions& options);

// Of the keyframes of the atlas, or of one map, that have a time; nothing where none has one.
std::optional<TimeSpan> SpanOf(const Atlas& atlas, std::optional<std::uint64_t> map = {});

// The part that was asked for. Times that count from the first keyframe (`+10`) or to the last (`-10`) need the span of
// the keyframes. Throws Error when there is none.
bool NeedsSpan(const SelectionOptions& options);
Selection ParseSelection(const SelectionOptions& options, const std::optional<TimeSpan>& span = {});
// The same, with the span read from the input where it is needed.
Selection ParseSelection(const SelectionOptions& options, const HeldSource& input, const ReadOptions& read);

// What to say when no keyframe is in the time that was asked for: `has no keyframe from 5 s to 7 s; its keyframes are
// from 1403636579.763555 to 1403636597.663555 (2014-06-24 19:02:59 UTC, 17.9 s)`.
std::string NoKeyframeIn(const Selection& selection, const std::optional<TimeSpan>& span);

// What a miss says: that, the keyframes that there are, or the map. The input is read again for it.
std::string MissText(const Selection& selection, const HeldSource& input, const ReadOptions& read);

}  // namespace slamdb::cli
