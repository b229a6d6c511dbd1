// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Counted;

void CountLists(const Salvage& salvage, SalvageReport& report) {
  report.maps = {salvage.maps_listed, salvage.atlas.maps.size()};
  if (salvage.damage.empty()) report.maps.listed = report.maps.read;  // what else is listed are repetitions
  for (const SalvagedMap& map : salvage.maps) {
    report.keyframes.listed += map.keyframes.listed;
    report.points.listed += map.points.listed;
    report.landmarks.listed += map.landmarks.listed;
  }
  for (const Map& map : salvage.atlas.maps) {
    report.keyframes.read += map.keyframes.size();
    report.points.read += map.points.size();
    report.landmarks.read += map.landmarks.size();
  }
  report.points.read -= report.recovery.triangulated_points.size();
}

// Children the repairs find again by their parents.
void CountLinksAnew(Salvage& salvage) {
  for (std::size_t i = 0; i < salvage.maps.size(); ++i) {
    if (salvage.maps[i].lost_links.empty()) continue;
    Map& map = salvage.atlas.maps[i];
    const IdTable keyframes = KeyFrameTable(map);
    std::vector<std::uint32_t> rows;
    for (const KeyFrameId id : salvage.maps[i].lost_links)
      if (const std::uint32_t row = keyframes.Find(id.value()); row != kNoRow) rows.push_back(row);
    detail::UpdateCovisibility(map, rows);
  }
}

void TellLists(const Salvage& salvage, SalvageReport& report) {
  const auto lose = [&](const SalvagedList& list, std::string_view one) {
    if (list.read < list.listed) report.losses.push_back(Counted(list.listed - list.read, one) + " lost");
  };
  lose(report.maps, "map");
  lose(report.keyframes, "keyframe");
  lose(report.points, "point");
  lose(report.landmarks, "landmark");
  for (const SalvagedMap& map : salvage.maps)
    if (map.points.listed == 0 && map.keyframes.read < map.keyframes.listed)
      report.losses.push_back(Concat(map.id, ": all points lost, whose number stands behind the keyframes"));
  std::size_t without_links = 0;
  for (const SalvagedMap& map : salvage.maps) without_links += map.lost_links.size();
  if (without_links > 0)
    report.losses.push_back(Concat("the links of ", Counted(without_links, "keyframe"),
                                   " lost: covisibility counted anew from shared points, children found by their "
                                   "parents; their loop and merge edges are known from the other side alone"));
  if (const std::size_t made = report.recovery.triangulated_points.size(); made > 0)
    report.losses.push_back(Counted(made, "point") +
                            " of those lost triangulated anew from what keyframes saw of them");
  const auto drop = [&](std::uint64_t count, std::string_view one) {
    if (count > 0) report.losses.push_back(Counted(count, one) + " of these dropped, since they were damaged");
  };
  drop(report.recovery.dropped_keyframes, "keyframe");
  drop(report.recovery.dropped_points, "point");
  drop(report.recovery.dropped_landmarks, "landmark");
}

void TellBeginning(const Salvage& salvage, SalvageReport& report) {
  for (const SalvagedMap& map : salvage.maps)
    if (map.lost_head)
      report.losses.push_back(Concat(map.id, ": its id and its initial keyframe lost, and taken from its keyframes"));
  if (!salvage.lost_beginning) return;
  if (report.recovery.taken_vocabulary)
    report.losses.emplace_back("the vocabulary's name and checksum lost, and taken from RecoverOptions::rig");
  else if (salvage.atlas.vocabulary == Vocabulary())
    report.losses.emplace_back("the vocabulary's name and checksum lost; setting `Atlas::vocabulary` stamps them");
}

void TellRebuilt(SalvageReport& report) {
  const auto tell = [&](const auto& ids, std::string_view what) {
    for (const auto id : ids) report.losses.push_back(Concat(id, what));
  };
  const RecoverReport& recovery = report.recovery;
  tell(recovery.rebuilt_maps, ": origins, initial keyframe and inertial stage lost, and set anew");
  tell(recovery.rebuilt_cameras, " lost, and rebuilt from what keyframes keep of it");
  tell(recovery.guessed_cameras,
       " lost, which keyframes keep nothing of: its focal lengths and centre are guessed, those of the left camera");
  tell(recovery.guessed_models,
       ": its model is guessed, a pinhole camera; of a fisheye camera keyframes would keep the same, and points "
       "triangulated with it would be wrong; RecoverOptions::rig takes it from a file");
  tell(recovery.guessed_lenses,
       ": its lens parameters are unknown and set to 0, and no point is triangulated with them; RecoverOptions::rig "
       "takes them from a file");
  tell(recovery.taken_cameras, " lost, and taken from RecoverOptions::rig");
  if (recovery.rebuilt_counters) report.losses.emplace_back("the next ids lost, and set above all ids that are known");
}

void TellWords(SalvageReport& report) {
  for (std::string& sentence : SentencesOf(report.recovery.words)) report.losses.push_back(std::move(sentence));
}

// Whether ORB-SLAM3 finds everything that the atlas refers to; what it leaves null without harm counts too.
bool HasNothingMissing(const CheckReport& check) {
  constexpr std::array<std::string_view, 4> kLeftNull = {"slot-target", "replacement-target", "temporal-target",
                                                         "bad-point-referenced"};
  return std::ranges::none_of(check.results, [&](const RuleResult& result) {
    return std::ranges::find(kLeftNull, result.id) != kLeftNull.end();
  });
}

// Whether the file can stay as it is.
bool IsSound(const Atlas& atlas, const RecoverOptions& options) {
  const CheckReport check = CheckAtlas(atlas, {.threads = options.threads});
  if (!check.ok() || !HasNothingMissing(check)) return false;
  return options.vocabulary == nullptr ||
         HasWordsOf(atlas,
                    {.tree = options.vocabulary, .identity = options.vocabulary_identity, .threads = options.threads});
}

}  // namespace

SalvageReport RecoverSalvage(Salvage& salvage, const RecoverOptions& options) {
  SalvageReport report{.damage = salvage.damage, .accepted = salvage.accepted};
  report.losses = salvage.losses;
  report.undone = salvage.undone;
  const bool sound = report.whole() && IsSound(salvage.atlas, options);
  report.untouched = sound && report.losses.empty();
  RecoverOptions recover = options;
  recover.triangulate = options.triangulate && !report.whole() && report.accepted.empty();
  CountLinksAnew(salvage);
  if (!sound) report.recovery = RecoverAtlas(salvage.atlas, recover);
  if (salvage.atlas.maps.empty() && !report.untouched)
    throw Error(ErrorKind::kDamaged, Concat("holds no keyframe and no landmark that could be read whole",
                                            report.whole() ? "" : ": " + report.damage.front()));
  CountLists(salvage, report);
  TellLists(salvage, report);
  TellBeginning(salvage, report);
  TellRebuilt(report);
  TellWords(report);
  if (report.recovery.pointless())
    report.losses.emplace_back(
        "no keyframe sees a point any more, which `CheckAtlas` finds not sound: poses and features are saved");
  return report;
}

}  // namespace slamdb
