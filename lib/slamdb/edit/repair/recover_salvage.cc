// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/repair/recover.h"

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
  const auto drop = [&](std::uint64_t count, std::string_view one) {
    if (count > 0) report.losses.push_back(Counted(count, one) + " of these dropped, since they were damaged");
  };
  drop(report.recovery.dropped_keyframes, "keyframe");
  drop(report.recovery.dropped_points, "point");
  drop(report.recovery.dropped_landmarks, "landmark");
}

void TellBeginning(const Salvage& salvage, SalvageReport& report) {
  if (!salvage.lost_beginning) return;
  if (report.recovery.taken_vocabulary)
    report.losses.emplace_back("the vocabulary's name and checksum lost, and taken from RecoverOptions::rig");
  else if (salvage.atlas.vocabulary == Vocabulary())
    report.losses.emplace_back("the vocabulary's name and checksum lost; setting `Atlas::vocabulary` stamps them");
  if (!salvage.maps.empty())
    report.losses.push_back(
        Concat(salvage.maps.front().id, ": its id and its initial keyframe lost, and taken from its keyframes"));
}

void TellRebuilt(SalvageReport& report) {
  const auto tell = [&](const auto& ids, std::string_view what) {
    for (const auto id : ids) report.losses.push_back(Concat(id, what));
  };
  const RecoverReport& recovery = report.recovery;
  tell(recovery.rebuilt_maps, ": origins, initial keyframe and inertial stage lost, and set anew");
  tell(recovery.rebuilt_cameras, " lost, and rebuilt from what keyframes keep of it");
  tell(recovery.guessed_lenses,
       ": its lens parameters are unknown and set to 0; RecoverOptions::rig takes them from a file");
  tell(recovery.taken_cameras, " lost, and taken from RecoverOptions::rig");
  if (recovery.rebuilt_counters) report.losses.emplace_back("the next ids lost, and set above all ids that are known");
}

}  // namespace

SalvageReport RecoverSalvage(Salvage& salvage, const RecoverOptions& options) {
  SalvageReport report{.damage = salvage.damage, .accepted = salvage.accepted};
  report.untouched = report.whole() && CheckAtlas(salvage.atlas, {.threads = options.threads}).ok();
  if (!report.untouched) report.recovery = RecoverAtlas(salvage.atlas, options);
  if (salvage.atlas.maps.empty() && !report.untouched)
    throw Error(ErrorKind::kDamaged, Concat("holds no keyframe and no landmark that could be read whole",
                                            report.whole() ? "" : ": " + report.damage.front()));
  CountLists(salvage, report);
  TellLists(salvage, report);
  TellBeginning(salvage, report);
  TellRebuilt(report);
  return report;
}

}  // namespace slamdb
