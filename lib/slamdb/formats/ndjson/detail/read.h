// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/ndjson/detail/member_table.h"

namespace slamdb::detail {

// An atlas as its lines have it, and which members they had.
struct ReadLines {
  struct GivenOfMap {
    Given map;
    std::vector<Given> keyframes, points;
  };
  Atlas atlas;
  Given given;
  std::vector<Given> cameras;
  std::vector<GivenOfMap> maps;
};

// How each kind of line is read.
const MemberTable<Atlas>& AtlasMembers();
const MemberTable<Camera>& CameraMembers();
const MemberTable<Map>& MapMembers();
const MemberTable<KeyFrame>& KeyFrameMembers();
const MemberTable<MapPoint>& PointMembers();
const MemberTable<Landmark>& LandmarkMembers();

// Throws Error with the place when an entity holds lists that do not fit each other, as no archive can.
void RequireSound(JsonScanner& json, Given& given, KeyFrame& keyframe);
void RequireSound(JsonScanner& json, const ArchiveEncoding& encoding);
// The same of entries that no list has.
void RequireSoundEntries(const Atlas& atlas);

// Sets what was left out and has an obvious value, and has CompleteAtlas derive the rest of what was left out: nothing
// when all was there.
void CompleteLines(ReadLines& lines, int threads, Notices& notices);

Atlas ReadNdjson(const Source& source, const ReadOptions& options, Notices& notices);

}  // namespace slamdb::detail
