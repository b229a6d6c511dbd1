// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/results.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/convert_report.h"
#include "slamdb/formats/formats.h"

namespace slamdb {
namespace {

// What of it a file of the format can hold.
Substance HeldBy(const Format& format, Substance substance) {
  substance.keyframes &= HasAny(format.writes, Content::kPoses);
  substance.points &= HasAny(format.writes, Content::kPoints | Content::kObservations);
  substance.landmarks &= HasAny(format.writes, Content::kLandmarks);
  return substance;
}

bool HasSomething(const Substance& substance) { return substance.keyframes || substance.points || substance.landmarks; }

// What of an atlas a file of the format is there for, and there is none of.
std::string_view LacksFor(const Format& format, const Substance& substance) {
  const Substance held = HeldBy(format, substance);
  if (!format.is_export && HasAny(format.writes, Content::kPoses)) return held.Lacks();
  if (HasAny(format.writes, Content::kPoses)) return held.keyframes ? "" : "keyframes";
  if (HasAny(format.writes, Content::kPoints | Content::kObservations)) return held.points ? "" : "points";
  return held.landmarks ? "" : "landmarks";
}

// Why a file of the format, which has places for other things, would hold nothing of the atlas.
std::string HoldsNothing(const Format& format, const Substance& atlas) {
  std::string problem = "would hold nothing of the atlas, which has no " +
                        std::string(LacksFor(format, {.maps = true})) + "; nothing was written";
  if (HasAny(format.writes, Content::kLandmarks) && atlas.points)
    problem += "; `MakeLandmarks` makes landmarks of its points";
  if (HasAny(format.writes, Content::kPoints) && atlas.landmarks)
    problem += "; `MakePoints` makes points of its landmarks";
  return problem;
}

bool IsArchive(const Format& format) { return format.id.starts_with("orbslam3"); }

// By its first bytes; stores are guarded where files are replaced.
bool ReadsAsAtlas(const std::string& path) {
  std::error_code missing;
  if (detail::IsServer(path) || !std::filesystem::is_regular_file(path, missing)) return false;
  try {
    const Probe probe = Probe::Of(path);
    const auto format = std::ranges::find_if(
        Formats(), [&](const Format& known) { return known.sniff != nullptr && known.sniff(probe); });
    // ndjson, which tells all, is what `dump` prints too, and made again.
    return format != Formats().end() && !format->named && format->id != "ndjson" &&
           HasAny(format->reads, Content::kObservations | Content::kLandmarks);
  } catch (const Error&) {
    return false;  // whoever writes there will say what is wrong with it
  }
}

}  // namespace

void InputSubstance::Add(const Atlas& atlas, const Format* format) {
  all |= SubstanceOf(atlas, /*with_bad=*/true);
  good |= SubstanceOf(atlas);
  archives_alone &= format != nullptr && IsArchive(*format);
}

void LoseUseToOrbslam3(const Atlas& atlas, const InputSubstance& inputs, const Format& output, bool as_fork,
                       Notices& notices) {
  if (!IsArchive(output) || inputs.archives_alone || !atlas.layout.empty() || as_fork) return;
  const std::string why = WhyNoUseToOrbslam3(atlas);
  if (!why.empty()) notices.Lose(why);
}

void RefuseEmptyResult(const Atlas& result, const InputSubstance& inputs, const std::string& output,
                       const Format& format, bool dry_run, Notices& notices) {
  const Substance good = SubstanceOf(result);
  const std::string_view lacks = LacksFor(format, good);
  if (lacks.empty()) return;
  const Substance all = format.is_export ? good : SubstanceOf(result, /*with_bad=*/true);
  const bool lost = (LacksFor(format, inputs.good).empty()) ||
                    (LacksFor(format, inputs.all).empty() && !LacksFor(format, all).empty());
  const std::string what(lacks);
  if (!lost && !dry_run && HasSomething(good) && !HasSomething(HeldBy(format, good)))
    throw Error(ErrorKind::kNotPossible, output, "", HoldsNothing(format, good));
  if (!lost)
    notices.Warn("the output holds no " + what + ", and neither does the input as it was read");
  else if (dry_run)
    notices.Warn("the output would hold no " + what + ", though the input has some");
  else
    throw Error(ErrorKind::kNotPossible, output, "",
                "would hold no " + what + ", though the input has some; nothing was written");
}

void RefuseAtlas(const std::string& output) {
  if (ReadsAsAtlas(output))
    throw Error(ErrorKind::kAlreadyExists, output, "",
                "is an atlas, which only an atlas replaces; name another output, or remove it first");
}

}  // namespace slamdb
