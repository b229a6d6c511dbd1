// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/atlas.h"

// The part of an atlas that was asked for, once it is read.
namespace slamdb {

// When keyframes were taken, in seconds.
struct TimeSpan {
  double begin = 0, end = 0;
};

// Of the keyframes of the atlas, or of one map, that have a time; nothing where none has one. ReadSpan reads the input
// for its times alone.
[[nodiscard]] SLAMDB_EXPORT std::optional<TimeSpan> SpanOf(const Atlas& atlas, std::optional<std::uint64_t> map = {});
[[nodiscard]] SLAMDB_EXPORT std::optional<TimeSpan> ReadSpan(const HeldSource& input, ReadOptions read,
                                                             const std::optional<MapId>& map);

// What to say when no keyframe is in the time that was asked for: `has no keyframe from 5 s to 7 s; its keyframes are
// from 1403636579.763555 to 1403636597.663555 (17.9 s from 2014-06-24 19:02:59 UTC); ...`.
[[nodiscard]] SLAMDB_EXPORT std::string NoKeyframeIn(const Selection& selection, const std::optional<TimeSpan>& span);

// What a miss says: that, the keyframes that there are, or the map. The input is read again for it.
[[nodiscard]] SLAMDB_EXPORT std::string MissText(const Selection& selection, const HeldSource& input,
                                                 const ReadOptions& read);

// Throws Error (kNotFound) where nothing of the atlas is in the part that was asked for. `name` is that of the input.
SLAMDB_EXPORT void RefuseEmptySelection(const Atlas& atlas, const std::string& name, const HeldSource& input,
                                        const ReadOptions& read);

// The part that is to be looked at: of ranges of keyframes and times with the points that those keyframes observe.
//
// Throws Error as ReadAtlas does, and where nothing is in the part.
[[nodiscard]] SLAMDB_EXPORT Atlas ReadPartToShow(const std::string& name, const HeldSource& input,
                                                 const ReadOptions& read, Notices& notices);

}  // namespace slamdb
