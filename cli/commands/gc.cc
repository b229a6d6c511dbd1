// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/limits.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/revisions.h"
#include "cli/values.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct GcOptions {
  StoreVerbOptions store;
  GiveUpOptions give_up;
  bool keep_tags = false, no_vacuum = false, json = false;
};

std::string ReportText(const GiveUpReport& report, const GiveUpOptions& options) {
  const bool dry_run = options.dry_run;
  std::string text;
  std::uint64_t gone = 0, kept = 0;
  bool keeps_more = false;
  for (const GivenUp& atlas : report.atlases) {
    gone += atlas.revisions.size();
    kept += atlas.kept;
    keeps_more = keeps_more || (!options.keep_days && atlas.kept > options.keep.value_or(1));
    if (!atlas.revisions.empty())
      text += atlas.atlas + ": " + Counted(atlas.revisions.size(), "revision") + (dry_run ? " would go" : " given up") +
              ", " + Grouped(atlas.kept) + " kept\n";
  }
  if (keeps_more) text += "what has a tag, and what others were branched off, merged or restored from, is kept, too\n";
  if (gone == 0) return "nothing to give up: " + Counted(kept, "revision") + " kept\n" + text;
  return text + (dry_run ? "would free about " : "freed about ") + HumanBytes(report.bytes) + "\n";
}

void GiveSpaceBack(Store& store) {
  try {
    store.Vacuum();
  } catch (const Error& error) {
    throw Error(
        error.kind(), error.path(), error.place(),
        "the revisions are given up, but their space could not be given back to the disk: 'slamdb vacuum' tries "
        "again (" +
            error.problem() + ")");
  }
}

ExitCode RunGc(const GcOptions& options, Console& console) {
  if (!options.give_up.keep && !options.give_up.keep_days && !options.keep_tags)
    RefuseUsage(
        "say what to keep: --keep N, --keep-days D, or --keep-tags for nothing but the newest and what has a tag");
  const Location location = Location::Parse(options.store.path);
  Store store = OpenToChange(location.path, options.store.wait, console);
  const GiveUpReport report = store.GiveUp(options.give_up, location.name);
  const bool gives_back = !options.no_vacuum && !location.is_server();  // a server does so by itself
  if (report.bytes > 0 && !options.give_up.dry_run && gives_back) GiveSpaceBack(store);
  if (options.json)
    console.PrintData(ToJson(report, options.store.path));
  else if (!console.quiet())
    console.Print(ReportText(report, options.give_up));
  return ExitCode::kDone;
}

Run AddGc(CLI::App& verb) {
  const auto options = std::make_shared<GcOptions>();
  AddStore(verb, options->store);
  verb.add_option("--keep", options->give_up.keep, "Keep that many of the newest revisions of each atlas")
      ->type_name("N")
      ->check(Within(kRevisionsKept));
  verb.add_option("--keep-days", options->give_up.keep_days, "Keep what was saved in so many days up to now")
      ->type_name("DAYS")
      ->check(Within(kNonNegative));
  verb.add_flag("--keep-tags", options->keep_tags,
                "Keep nothing but the newest and what has a tag, which stays anyway");
  verb.add_flag("--dry-run", options->give_up.dry_run, "Only tell what would go");
  verb.add_flag("--no-vacuum", options->no_vacuum, "Leave the file as large as it is, for later saves to fill");
  AddJson(verb, options->json);
  return [options](Console& console) { return RunGc(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb gc lab.db --keep 10", "Gives up all but the ten newest revisions of each atlas."},
    {"slamdb gc lab.db --keep-days 30 --dry-run", "What would go if a month is enough."},
    {"slamdb gc lab.db#session_a --keep-tags", "Of one atlas, all but the newest and those with a tag."},
};

}  // namespace

const Command kGc = {
    .name = "gc",
    .summary = "give up earlier revisions of a store's atlases",
    .group = Group::kStore,
    .description =
        R"(Gives up revisions for good, all of a file in one transaction, and the space that they took. What is to be kept has to be said; of several
ways to keep, one is enough. The newest revision of every atlas stays, and so does what has a tag, and what others were branched
off or merged from, and these; as long as an earlier one stays, so do those that were restored
behind it, and what they were restored from.)",
    .failed = "The store could not be written, or another program uses it.",
    .examples = kExamples,
    .add = AddGc,
};

}  // namespace slamdb::cli
