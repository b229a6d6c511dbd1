// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/add.h"

#include <algorithm>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/guard.h"
#include "cli/many.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/layout_text.h"

namespace slamdb::cli {
namespace {

struct AddVerbOptions {
  std::string store;
  ManyOptions many;
  AddOptions add;
  bool json = false, no_sync = false;
  double wait = kUsualWait;
};

// One line for each atlas, as soon as it is done.
class Lines {
 public:
  Lines(Console& console, bool dry_run) : console_(console), dry_run_(dry_run) {}

  void SetNames(const std::vector<std::string>& names) {
    constexpr std::size_t kWidest = 40;
    for (const std::string& name : names) width_ = std::max(width_, std::min(kWidest, name.size()));
  }

  void Print(const AddedAtlas& atlas) {
    if (atlas.result == AddResult::kFailed || console_.quiet()) return;
    const bool would_be = dry_run_ && atlas.result != AddResult::kUnchanged;
    const std::string word = (would_be ? "would be " : "") + std::string(NameOf(atlas.result));
    console_.Print(Padded(word, std::string_view(dry_run_ ? "would be replaced" : "unchanged").size()) +
                   Padded(detail::Visible(atlas.name), width_) + SummaryText(atlas.summary) + "\n");
  }

 private:
  static std::string Padded(std::string text, std::size_t width) {
    text.resize(std::max(text.size(), width), ' ');
    return text + "  ";
  }

  static std::string SummaryText(const AtlasSummary& summary) {
    return Counted(summary.maps, "map") + ", " + Counted(summary.keyframes, "keyframe") + ", " +
           Counted(summary.points, "point") +
           (summary.landmarks > 0 ? ", " + Counted(summary.landmarks, "landmark") : std::string());
  }

  Console& console_;
  const bool dry_run_;
  std::size_t width_ = 0;
};

// `3 added, 1 unchanged; lab.db holds 4 atlases`.
std::string Summary(const AddReport& report) {
  std::string text;
  for (const AddResult result :
       {AddResult::kAdded, AddResult::kReplaced, AddResult::kUnchanged, AddResult::kFailed, AddResult::kNotTried})
    if (const std::uint64_t count = report.Count(result); count > 0)
      text += (text.empty() ? "" : ", ") + Grouped(count) + " " + std::string(NameOf(result));
  return (text.empty() ? "nothing to add" : text) + "; " + report.store +
         (report.dry_run ? " would hold " : " holds ") + Counted(report.in_store, "atlas", "atlases") + "\n";
}

ExitCode RunAdd(const AddVerbOptions& options, Console& console) {
  if (!Location(options.store).name.empty())
    RefuseUsage("the store is named without an atlas; --as names what is added");
  const AtlasInputs inputs = FindInputs(options.many, console, options.wait);
  AddOptions add = options.add;
  add.format = options.many.inputs.from.format;
  add.layout = LayoutNamed(options.many.inputs.from.layout);
  add.sync = !options.no_sync;
  add.lock_timeout = options.wait;
  add.provenance = "add ";
  add.threads = console.threads();
  add.progress = console.MakeProgress();
  Lines lines(console, add.dry_run);
  add.on_names = [&](const std::vector<std::string>& names) { lines.SetNames(names); };
  add.on_done = [&](const AddedAtlas& atlas) {
    console.Report(atlas.notices);
    if (!atlas.failure.empty()) console.Fail(InCommandWords(atlas.failure));
    if (!options.json) lines.Print(atlas);
  };
  const auto tell = [&](const AddReport& report) {
    if (options.json)
      console.PrintData(ReportInCommandWords(ToJson(report)));
    else if (!console.quiet())
      console.Print(Summary(report));
  };
  add.on_stopped = [&](const AddReport& report) {
    tell(report);
    console.Finish();  // before the signal, or the error, ends the program
  };
  const AddReport report = AddToStore(options.store, inputs, add);
  tell(report);
  return report.ok() ? ExitCode::kDone : ExitCode::kFailed;
}

Run AddAdd(CLI::App& verb) {
  const auto options = std::make_shared<AddVerbOptions>();
  Mark(verb.add_option("STORE", options->store, StoreAt("The store") + "; made where it is missing"), Writes::kAtlas)
      ->type_name("FILE")
      ->required();
  AddMany(verb, options->many);
  verb.add_option("--as", options->add.name, "Its name in the store, of one atlas")->type_name("NAME");
  verb.add_option("--name-from", options->add.name_from,
                  "What names the others: their files without suffix, or the whole path below the folder that is named")
      ->type_name("WHAT")
      ->transform(
          OneOf<AddOptions::NameFrom>({{"stem", AddOptions::NameFrom::kStem}, {"path", AddOptions::NameFrom::kPath}}))
      ->excludes(verb.get_option("--as"));
  verb.add_flag("-O,--overwrite", options->add.overwrite,
                "Save an atlas that differs from the one of its name in the store as the next revision of that");
  verb.add_flag("--dry-run", options->add.dry_run, "Say what would be done, and write nothing");
  verb.add_flag("--no-sync", options->no_sync,
                "Do not wait for the disk: faster, but a power cut may lose what was added");
  AddWait(verb, options->wait);
  AddJson(verb, options->json);
  return [options](Console& console) { return RunAdd(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb add all.db maps", "Keeps every atlas of a folder; those that are there already are left as they are."},
    {"slamdb add all.db session_a.osa session_b.osa -O", "Files; what has changed since becomes the next revision."},
    {"slamdb add all.db lab.db", "All atlases of another store; 'lab.db#session_*' takes some."},
    {"slamdb add all.db session_a.osa --as monday", "One, under a name of your own."},
    {"slamdb add all.db maps -r --name-from path --dry-run", "What would be added of a tree of folders."},
};

}  // namespace

const Command kAdd = {
    .name = "add",
    .summary = "keep many atlases in a store",
    .group = Group::kStore,
    .description =
        R"(Saves atlases, also all of a folder or of another store, in a store, each under the name of its file. Where several files
have the same name, those of their folders stand before it: monday_map, tuesday_map; and where these are the same, too,
a number behind it: map, map-2. An atlas that the store holds as it is, by its hash, is left as it is, also under a name
that its path gave it when other files were there; another one of a name that is taken is refused unless -O saves it as
the next revision.

Each atlas is saved in a transaction of its own while the next is read: what fails leaves the others in the store, and
Ctrl-C, or a crash, whole atlases only. What ends early says how many atlases were added, and how many not tried.)",
    .done = "All atlases are in the store.",
    .failed = "Some atlas could not be read or saved; the others are in the store.",
    .examples = kExamples,
    .add = AddAdd,
};

}  // namespace slamdb::cli
