// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace slamdb {

// What the atlases of a store are looked for by, besides what their maps cover (MapQuery): what the store tells of
// them, so that none is read.
struct AtlasQuery {
  // Of the newest revision, as StoredAtlas has them.
  enum class Number {
    kMaps,
    kKeyframes,
    kPoints,
    kObservations,
    kLandmarks,
    kLength,    // of the trajectory, metres or map units
    kDuration,  // seconds
    kBytes,
    kRevision,
  };
  struct Range {
    Number number = Number::kMaps;
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();  // included
  };
  std::vector<Range> ranges;  // all of them

  // The atlas has a revision, which can still be read, that meets all of these. In each `*` stands for any letters and
  // `?` for one; letters of either case differ. Empty: any.
  std::string who;         // saved it: `user@host`, or without @ one of both
  std::string provenance;  // what it was made of, as the log tells: the whole where there is a `*` or `?`, else a part
  std::string tag;

  bool everything() const { return ranges.empty() && who.empty() && provenance.empty() && tag.empty(); }
};

}  // namespace slamdb
