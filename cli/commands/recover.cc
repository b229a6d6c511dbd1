// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/recover.h"

#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/report/layout.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/salvage.h"

namespace slamdb::cli {
namespace {

struct RecoverVerbOptions {
  EditOptions edit;
  std::string cameras, vocabulary;
  bool no_triangulate = false, accept_edits = false;
};

std::string Share(const SalvagedList& list, std::string_view one, std::string_view many) {
  if (list.listed == 0) return "no " + std::string(many);
  return Grouped(list.read) + " of " + Counted(list.listed, one, many);
}

std::string AcceptedText(const SalvageReport& report) {
  if (report.accepted.empty()) return {};
  std::string text = "accepted as they are, edited outside slamdb\n";
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(kShown, report.accepted.size()); ++i) text += "  " + report.accepted[i] + "\n";
  if (report.accepted.size() > kShown) text += "  and " + Grouped(report.accepted.size() - kShown) + " more rows\n";
  return text;
}

std::string TextOf(const SalvageReport& report) {
  std::string text = AcceptedText(report) + (report.undone.empty() ? "" : "undone: " + report.undone + "\n");
  if (report.untouched) return text + "the file is whole and sound\n";
  text += "recovered " + Share(report.maps, "map", "maps") + ", " + Share(report.keyframes, "keyframe", "keyframes") +
          ", " + Share(report.points, "point", "points");
  if (const std::size_t made = report.recovery.triangulated_points.size(); made > 0)
    text += "; " + Counted(made, "point") + " triangulated anew";
  if (report.landmarks.listed > 0) text += ", " + Share(report.landmarks, "landmark", "landmarks");
  text += "\ndamage\n";
  if (report.whole())
    text += report.recovery.repairs.empty() ? "  none, every byte can be read\n"
                                            : "  every byte can be read, but what some say is not sound\n";
  constexpr std::size_t kShown = 5;
  for (std::size_t i = 0; i < std::min(kShown, report.damage.size()); ++i) text += "  " + report.damage[i] + "\n";
  if (report.damage.size() > kShown) text += "  and " + Grouped(report.damage.size() - kShown) + " more places\n";
  if (!report.losses.empty()) text += "losses\n";
  for (const std::string& loss : report.losses) text += "  " + loss + "\n";
  const std::vector<AppliedFix>& repairs = report.recovery.repairs;
  if (!repairs.empty()) text += (report.whole() ? "repaired\n" : "repaired what referred to them\n");
  for (const AppliedFix& fix : repairs) text += "  " + fix.title + " (" + Counted(fix.changes, "change") + ")\n";
  return text;
}

ExitCode RunRecover(const RecoverVerbOptions& options, Console& console) {
  RefuseBadOutput(options.edit);
  const double wait = options.edit.wait;
  Notices notices;
  std::optional<Atlas> rig;
  if (!options.cameras.empty()) rig = ReadAtlas(options.cameras, MakeReadOptions(console, {}, wait), &notices);
  ReadOptions reading = MakeReadOptions(console, options.edit.from, wait);
  reading.of<StoreReadOptions>().accept_edits = options.accept_edits;
  Salvage salvage = SalvageAtlas(options.edit.input, reading);
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  RecoverOptions recover = {.rig = rig ? &*rig : nullptr,
                            .triangulate = !options.no_triangulate,
                            .threads = console.threads(),
                            .progress = console.MakeProgress()};
  if (vocabulary) {
    recover.vocabulary = &vocabulary->tree;
    recover.vocabulary_identity = vocabulary->identity;
  }
  const SalvageReport report = NamingFile(options.edit.input, [&] { return RecoverSalvage(salvage, recover); });
  options.edit.inputs->all = options.edit.inputs->good = {
      .maps = report.maps.listed > 0, .keyframes = report.keyframes.listed > 0};  // keyframes alone are worth saving
  std::string provenance = "recover " + options.edit.input;
  if (!report.accepted.empty())
    provenance += " --accept-edits (" + Counted(report.accepted.size(), "row", "rows") + " edited outside slamdb)";
  WriteResult(salvage.atlas, options.edit, provenance, console, notices);
  const ExitCode code =
      FinishEdit(TextOf(report), ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
  if (report.recovery.pointless()) return ExitCode::kLossy;  // little, and told as what is lost
  for (const std::string& error : ErrorsOf(report.recovery.left)) console.Warn(error);
  if (!report.recovery.sound()) return ExitCode::kFailed;
  return report.untouched ? code : ExitCode::kLossy;
}

Run AddRecover(CLI::App& verb) {
  const auto options = std::make_shared<RecoverVerbOptions>();
  AddEdit(verb, options->edit);
  verb.add_option("--cameras", options->cameras,
                  "Another atlas of the same cameras and vocabulary: what of those is lost is taken from it")
      ->type_name("FILE");
  AddVocabulary(verb, options->vocabulary);
  verb.add_flag("--no-triangulate", options->no_triangulate,
                "Do not make lost points anew from what two keyframes, or one with a depth, saw of them");
  verb.add_flag(
      "--accept-edits", options->accept_edits,
      "Of a store: take rows that were edited in SQL as they are now, instead of leaving them out as damaged");
  return [options](Console& console) { return RunRecover(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb recover cut.osa rescued.osa", "Keeps what is whole of a file that was cut short."},
    {"slamdb recover fisheye_cut.osa rescued.osa --cameras yesterday.osa",
     "Cameras are the last thing in a file; a fisheye lens is known from an older atlas alone, and no point is "
     "triangulated without."},
    {"slamdb recover flipped.osa rescued.osa --vocabulary ORBvoc.txt",
     "Bags of words are held against the vocabulary, and computed anew where they are damaged."},
    {"slamdb recover damaged.db#lab lab.osa", "Also of a store with damaged pages."},
    {"slamdb recover lab.db#lab lab.db#mended --accept-edits",
     "After UPDATE statements in lab.db: the rows count as they are now, and the history says so."},
};

}  // namespace

const Command kRecover = {
    .name = "recover",
    .summary = "save what is whole of a damaged file",
    .group = Group::kCheck,
    .description =
        R"(Reads every keyframe and point that is whole in an ORB-SLAM3 file that was cut short or damaged, binary or text, or in a
damaged store; finds again what the keyframes tell of what is lost: cameras, the next ids, and points that two of them saw,
or one with a depth, which are triangulated anew and counted apart; drops bags of words that are in doubt, or computes them
anew with --vocabulary; drops or repairs what refers to the rest; and writes an atlas that 'slamdb check' finds sound, or
says that it is not: keyframes of which no point is left are saved too. The input is never changed. Landmarks of a store
are saved, and those of an MRPT file in front of a cut.

In an .osa file the keyframes of a map come first, then its points, and the cameras at the very end: a file cut in its
middle still has the keyframes in front of the cut, and the points only of maps before. Where the beginning is lost, reading
starts at the first keyframe that is whole. Files of forks are recovered too: in the layout of --layout, or one that is known,
with the members of the fork, or else in one that is inferred, as files of ORB-SLAM3 v1.0.)",
    .done = "The file is whole and sound: the output is its copy.",
    .failed =
        "Nothing could be read, the output not be written, or an error is left that has no safe repair, other than "
        "that no keyframe sees a point.",
    .lossy =
        "Done, and something is lost; the report says what, and whether the output holds no point and is not sound.",
    .examples = kExamples,
    .add = AddRecover,
};

}  // namespace slamdb::cli
