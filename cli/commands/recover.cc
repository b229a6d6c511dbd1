// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/recover.h"

#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/json.h"
#include "cli/report/layout.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/salvage.h"

namespace slamdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct RecoverVerbOptions {
  EditOptions edit;
  std::string cameras;
};

struct Totals {
  SalvagedList maps, keyframes, points, landmarks;  // read: in the output
};

Totals TotalsOf(const Salvage& salvage) {
  Totals totals;
  totals.maps = {salvage.maps_listed, salvage.atlas.maps.size()};
  if (salvage.damage.empty()) totals.maps.listed = totals.maps.read;  // what else is listed are repetitions
  for (const SalvagedMap& map : salvage.maps) {
    totals.keyframes.listed += map.keyframes.listed;
    totals.points.listed += map.points.listed;
    totals.landmarks.listed += map.landmarks.listed;
  }
  for (const Map& map : salvage.atlas.maps) {
    totals.keyframes.read += map.keyframes.size();
    totals.points.read += map.points.size();
    totals.landmarks.read += map.landmarks.size();
  }
  return totals;
}

std::string Share(const SalvagedList& list, std::string_view one, std::string_view many) {
  if (list.listed == 0) return "no " + std::string(many);
  return Grouped(list.read) + " of " + Counted(list.listed, one, many);
}

// What a damaged file cost, one sentence for each kind.
std::vector<std::string> LossesOf(const Salvage& salvage, const RecoverReport& report) {
  std::vector<std::string> losses;
  const auto lose = [&](const SalvagedList& list, std::string_view one, std::string_view many) {
    if (list.read < list.listed) losses.push_back(Counted(list.listed - list.read, one, many) + " lost");
  };
  const Totals totals = TotalsOf(salvage);
  lose(totals.maps, "map", "maps");
  lose(totals.keyframes, "keyframe", "keyframes");
  lose(totals.points, "point", "points");
  lose(totals.landmarks, "landmark", "landmarks");
  for (const SalvagedMap& map : salvage.maps)
    if (map.points.listed == 0 && map.keyframes.read < map.keyframes.listed)
      losses.push_back(ToString(map.id) + ": all points lost, whose number stands behind the keyframes");
  if (report.dropped_keyframes > 0)
    losses.push_back(Counted(report.dropped_keyframes, "keyframe") + " of these dropped, since they were damaged");
  if (report.dropped_points > 0)
    losses.push_back(Counted(report.dropped_points, "point") + " of these dropped, since they were damaged");
  if (report.dropped_landmarks > 0)
    losses.push_back(Counted(report.dropped_landmarks, "landmark") + " of these dropped, since they were damaged");
  if (salvage.lost_beginning) {
    if (report.taken_vocabulary)
      losses.push_back("the vocabulary's name and checksum lost, and taken from --cameras");
    else if (salvage.atlas.vocabulary == Vocabulary())
      losses.push_back("the vocabulary's name and checksum lost; 'slamdb vocabulary set' stamps them");
    if (!salvage.maps.empty())
      losses.push_back(ToString(salvage.maps.front().id) +
                       ": its id and its initial keyframe lost, and taken from its keyframes");
  }
  for (const MapId map : report.rebuilt_maps)
    losses.push_back(ToString(map) + ": origins, initial keyframe and inertial stage lost, and set anew");
  for (const CameraId camera : report.rebuilt_cameras)
    losses.push_back(ToString(camera) + " lost, and rebuilt from what keyframes keep of it");
  for (const CameraId camera : report.guessed_lenses)
    losses.push_back(ToString(camera) +
                     ": its lens parameters are unknown and set to 0; --cameras takes them from a file");
  for (const CameraId camera : report.taken_cameras)
    losses.push_back(ToString(camera) + " lost, and taken from --cameras");
  if (report.rebuilt_counters) losses.push_back("the next ids lost, and set above all ids that are known");
  return losses;
}

std::string TextOf(const Salvage& salvage, const RecoverReport& report, const std::vector<std::string>& losses) {
  const bool whole = salvage.damage.empty();
  if (whole && losses.empty() && report.repairs.empty()) return "the file is whole and sound\n";
  const Totals totals = TotalsOf(salvage);
  std::string text = "recovered " + Share(totals.maps, "map", "maps") + ", " +
                     Share(totals.keyframes, "keyframe", "keyframes") + ", " + Share(totals.points, "point", "points");
  if (totals.landmarks.listed > 0) text += ", " + Share(totals.landmarks, "landmark", "landmarks");
  text += "\ndamage\n";
  if (whole) text += "  every byte can be read, but what some say is not sound\n";
  constexpr std::size_t kShown = 5;
  for (std::size_t i = 0; i < std::min(kShown, salvage.damage.size()); ++i) text += "  " + salvage.damage[i] + "\n";
  if (salvage.damage.size() > kShown) text += "  and " + Grouped(salvage.damage.size() - kShown) + " more places\n";
  if (!losses.empty()) text += "losses\n";
  for (const std::string& loss : losses) text += "  " + loss + "\n";
  if (!report.repairs.empty()) text += (whole ? "repaired\n" : "repaired what referred to them\n");
  for (const AppliedFix& fix : report.repairs) text += "  " + fix.title + " (" + Counted(fix.changes, "change") + ")\n";
  return text;
}

Json ListValue(const SalvagedList& list) { return {{"listed", list.listed}, {"recovered", list.read}}; }

std::string JsonOf(const Salvage& salvage, const RecoverReport& report, const std::vector<std::string>& losses,
                   const std::string& input) {
  const Totals totals = TotalsOf(salvage);
  Json repairs = Json::array();
  for (const AppliedFix& fix : report.repairs)
    repairs.push_back({{"rule", fix.rule}, {"fix", fix.fix}, {"changes", fix.changes}});
  return JsonText({{"format", "slamdb-recover-1"},
                   {"input", input},
                   {"whole", salvage.damage.empty()},
                   {"sound", report.sound()},
                   {"maps", ListValue(totals.maps)},
                   {"keyframes", ListValue(totals.keyframes)},
                   {"points", ListValue(totals.points)},
                   {"landmarks", ListValue(totals.landmarks)},
                   {"damage", salvage.damage},
                   {"losses", losses},
                   {"repairs", repairs}});
}

ExitCode RunRecover(const RecoverVerbOptions& options, Console& console) {
  RefuseBadOutput(options.edit);
  const double wait = options.edit.wait;
  Notices notices;
  std::optional<Atlas> rig;
  if (!options.cameras.empty()) rig = ReadAtlas(options.cameras, MakeReadOptions(console, {}, wait), &notices);
  Salvage salvage = SalvageAtlas(options.edit.input, MakeReadOptions(console, options.edit.from, wait));
  RecoverReport report;
  const bool whole = salvage.damage.empty();
  const bool good = whole && CheckAtlas(salvage.atlas, {.threads = console.threads()}).ok();
  if (!good) report = RecoverAtlas(salvage.atlas, {.rig = rig ? &*rig : nullptr, .threads = console.threads()});
  if (salvage.atlas.maps.empty() && !good)
    throw Error(
        options.edit.input, "",
        "holds no keyframe and no landmark that could be read whole" + (whole ? "" : ": " + salvage.damage.front()));
  const std::vector<std::string> losses = LossesOf(salvage, report);
  WriteResult(salvage.atlas, options.edit, "recover " + options.edit.input, console, notices);
  const ExitCode code = FinishEdit(TextOf(salvage, report, losses), JsonOf(salvage, report, losses, options.edit.input),
                                   options.edit, console, notices);
  for (const Unrepaired& rule : report.left)
    if (rule.severity == Severity::kError)
      console.Warn(rule.rule + ": " + ToString(rule.first.place) + ": " + rule.first.message + "; stays, since " +
                   rule.reason);
  if (!report.sound()) return ExitCode::kFailed;
  return good ? code : ExitCode::kLossy;
}

Run AddRecover(CLI::App& verb) {
  const auto options = std::make_shared<RecoverVerbOptions>();
  AddEdit(verb, options->edit);
  verb.add_option("--cameras", options->cameras,
                  "Another atlas of the same cameras and vocabulary: what of those is lost is taken from it")
      ->type_name("FILE");
  return [options](Console& console) { return RunRecover(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb recover cut.osa rescued.osa", "Keeps what is whole of a file that was cut short."},
    {"slamdb recover cut.osa --dry-run", "Only says how much that would be."},
    {"slamdb recover fisheye_cut.osa rescued.osa --cameras yesterday.osa",
     "Cameras are the last thing in a file; a fisheye lens is known from an older atlas alone."},
    {"slamdb recover zeros_first.osa rescued.osa --cameras yesterday.osa",
     "A file whose beginning is lost; the vocabulary is known from an older atlas."},
    {"slamdb recover damaged.db#lab lab.osa", "Also of a store with damaged pages."},
};

}  // namespace

const Command kRecover = {
    .name = "recover",
    .summary = "save what is whole of a damaged file",
    .description =
        R"(Reads every keyframe and point that is whole in an ORB-SLAM3 file that was cut short or damaged, binary or text, or in a
damaged store; finds again what the keyframes tell of what is lost (cameras, the next ids); drops or repairs what refers to
the rest; and writes an atlas that 'slamdb check' finds sound. The input is never changed. Landmarks of a store are saved
too, and those of an MRPT file in front of a cut.

In an .osa file the keyframes of a map come first, then its points, and the cameras at the very end: a file cut in its
middle still has the keyframes in front of the cut, and the points only of maps before. Where the beginning is lost, reading
starts at the first keyframe that is whole.)",
    .done = "The file is whole and sound: the output is its copy.",
    .failed = "Nothing could be read, the output not be written, or an error is left that has no safe repair.",
    .lossy = "Done, and something is lost; the report says what.",
    .examples = kExamples,
    .add = AddRecover,
};

}  // namespace slamdb::cli
