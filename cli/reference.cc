// SPDX-License-Identifier: BSD-3-Clause
#include "cli/reference.h"

#include "cli/edit.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/trajectories.h"

namespace slamdb::cli {

std::vector<TimedPosition> ReadReference(const std::string& path, const TimesOptions& times, bool body, double wait,
                                         Console& console, Notices& notices) {
  ReadOptions read = MakeReadOptions(console, {}, wait);
  read.features = FeatureColumns::kNone;
  read.of<TrajectoryReadOptions>() = times.ForReading();
  // Not by way of an atlas, whose single precision has no room for coordinates as UTM's.
  const HeldSource held = HoldInput(path, read);
  const Format* format = FindFormatOfInput(held);
  RefuseIdleTimes(format, times);
  if (format != nullptr && IsTrajectory(*format)) {
    std::vector<TimedPosition> positions;
    read.format = format->id;  // in which order it has quaternions does not matter: they are not used
    for (const TrajectoryPose& pose : ReadTrajectory(held, read, &notices))
      positions.push_back({pose.timestamp, pose.position});
    return positions;
  }
  const Atlas reference = ReadAtlas(held, read, &notices);
  return NamingFile(path, [&] { return TrajectoryOf(reference, body); });
}

}  // namespace slamdb::cli
