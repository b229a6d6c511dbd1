// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/sync.h"

#include <memory>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/limits.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/values.h"
#include "cli/words.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/detail/visible.h"

namespace slamdb::cli {
namespace {

struct SyncVerbOptions {
  std::string first, second;
  SyncOptions sync;
  double wait = kUsualWait;
  bool json = false, no_sync = false;
};

// What became of each atlas, as soon as it is done.
class Lines {
 public:
  Lines(const SyncVerbOptions& options, Console& console)
      : options_(options),
        console_(console),
        first_(detail::WithoutPassword(options.first)),
        second_(detail::WithoutPassword(options.second)) {}

  void Print(const SyncedAtlas& atlas) {
    Warn(atlas);
    if (atlas.result == SyncResult::kFailed) console_.Fail("'" + atlas.name + "': " + InCommandWords(atlas.failure));
    const std::string what = WhatOf(atlas);
    if (options_.json || console_.quiet() || what.empty()) return;
    console_.Print(detail::Visible(atlas.name) + ": " + what + "\n");
  }

 private:
  // `3 revisions to lab.db, the tag release to robot.db`.
  std::string WhatOf(const SyncedAtlas& atlas) const {
    std::string text;
    const auto add = [&](const std::string& what, bool to_first) {
      text += (text.empty() ? "" : ", ") + what + (options_.sync.dry_run ? " would go to " : " to ") +
              (to_first ? first_ : second_);
    };
    if (!atlas.revisions.empty()) add(Counted(atlas.revisions.size(), "revision"), atlas.to_first);
    if (!atlas.revisions.empty() && !atlas.branch.empty()) text += " as " + detail::Visible(atlas.branch);
    for (const SyncedAtlas::Tag& tag : atlas.tags) add("the tag " + detail::Visible(tag.tag), tag.to_first);
    if (atlas.result == SyncResult::kAhead) text += (text.empty() ? "" : ", ") + ("has more in " + second_);
    return text;
  }
  void Warn(const SyncedAtlas& atlas) {
    const std::string name = "'" + atlas.name + "'";
    if (atlas.result == SyncResult::kDiverged)
      console_.Warn(name +
                    " has revisions in each store that the other lacks, and stays as it is in both: --diverged "
                    "branch brings those of " +
                    first_ + " to " + second_ + " under another name");
    if (atlas.result == SyncResult::kBranched && !options_.sync.dry_run)
      console_.Note(name + " has revisions in each store that the other lacks: 'slamdb merge " + second_ + "#" +
                    atlas.name + " " + second_ + "#" + atlas.branch + "' makes one of them");
    for (const SyncedAtlas::Conflict& conflict : atlas.conflicts)
      console_.Warn("the tag '" + conflict.tag + "' of " + name + " is revision " + std::to_string(conflict.first) +
                    " in " + first_ + " and another one, " + std::to_string(conflict.second) + ", in " + second_ +
                    ": both stay; 'slamdb tag STORE#" + atlas.name + " " + conflict.tag +
                    " --remove' in one of them, and the next sync brings the other's");
    for (const SyncedAtlas::Alone& alone : atlas.alone) WarnOfAlone(name, alone);
  }

  // `'lab' has 2 earlier revisions, with the tag 'first', in robot.db alone: ...`.
  void WarnOfAlone(const std::string& name, const SyncedAtlas::Alone& alone) {
    std::string what = Counted(alone.revisions.size(), "earlier revision");
    for (std::size_t i = 0; i < alone.tags.size(); ++i)
      what += (i > 0                    ? ", "
               : alone.tags.size() == 1 ? ", with the tag "
                                        : ", with the tags ") +
              ("'" + alone.tags[i] + "'");
    console_.Warn(name + " has " + what + ", in " + (alone.in_first ? first_ : second_) + " alone: " +
                  (alone.in_first ? second_ : first_) + " has newer ones already, and behind these nothing is brought");
  }

  const SyncVerbOptions& options_;
  Console& console_;
  const std::string first_, second_;
};

// Whether that is something that a sync does, and does not find.
bool IsDone(SyncResult result) { return result == SyncResult::kCopied || result == SyncResult::kBranched; }

// `3 copied, 1 diverged, 20 same`; of a dry run `3 would be copied, ...`.
std::string Summary(const SyncReport& report, bool dry_run) {
  std::string text;
  for (const SyncResult result : {SyncResult::kCopied, SyncResult::kAhead, SyncResult::kDiverged, SyncResult::kBranched,
                                  SyncResult::kFailed, SyncResult::kSame})
    if (const std::uint64_t count = report.Count(result); count > 0)
      text += (text.empty() ? "" : ", ") + Grouped(count) + " " + (dry_run && IsDone(result) ? "would be " : "") +
              std::string(NameOf(result));
  if (const std::uint64_t tags = report.Conflicts(); tags > 0)
    text += (text.empty() ? "" : ", ") + Counted(tags, "tag") + " in conflict";
  return (text.empty() ? "no atlases" : text) + "\n";
}

ExitCode RunSync(const SyncVerbOptions& options, Console& console) {
  for (const std::string& store : {options.first, options.second})
    if (!Location::Parse(store).name.empty()) RefuseUsage("stores are named without an atlas; --name says which");
  SyncOptions sync = options.sync;
  sync.sync = !options.no_sync;
  sync.lock_timeout = options.wait;
  sync.threads = console.threads();
  sync.progress = console.MakeProgress();
  Lines lines(options, console);
  sync.on_done = [&](const SyncedAtlas& atlas) { lines.Print(atlas); };
  sync.on_retry = [&](const Error& error, double pause) {
    console.Warn(InCommandWords(error.what()) + "; going on in " + std::to_string(static_cast<int>(pause)) + " s");
  };
  const auto tell = [&](const SyncReport& report) {
    if (options.json)
      console.PrintData(ReportInCommandWords(ToJson(report)));
    else if (!console.quiet())
      console.Print(Summary(report, options.sync.dry_run));
  };
  sync.on_stopped = [&](const SyncReport& report) {
    const bool did_any = report.same > 0 || !report.atlases.empty();
    if (did_any || options.json) tell(report);
    console.Finish();  // before the signal, or the error, ends the program
  };
  const SyncReport report = SyncStores(options.first, options.second, sync);
  tell(report);
  if (report.Count(SyncResult::kFailed) > 0) return ExitCode::kFailed;
  return report.Count(SyncResult::kDiverged) + report.Conflicts() > 0 ? ExitCode::kLossy : ExitCode::kDone;
}

Run AddSync(CLI::App& verb) {
  const auto options = std::make_shared<SyncVerbOptions>();
  verb.add_option("FIRST", options->first, StoreAt("A store"))->type_name("FILE")->required();
  verb.add_option("SECOND", options->second, "The other one; either is made where it is missing")
      ->type_name("FILE")
      ->required();
  verb.add_option("--name", options->sync.names, "Only the atlas of this name; may be given several times")
      ->type_name("NAME")
      ->allow_extra_args(false);
  verb.add_flag("--one-way", options->sync.one_way, "Only from the first to the second");
  verb.add_option("--diverged", options->sync.branch_diverged,
                  "What to do where both went on from one revision: skip, leave both as they are, the default; branch, "
                  "save what the first has in the second as NAME-of-HOST (NAME-of-HOST-2, where that is another), for "
                  "'slamdb merge'")
      ->type_name("KIND")
      ->transform(OneOf(kDivergedWays));
  verb.add_flag("--dry-run", options->sync.dry_run, "Only tell what would be done");
  verb.add_option("--retry", options->sync.retries,
                  "Go on by itself, up to N times in a row, when the connection is lost or a store is locked")
      ->type_name("N")
      ->check(Within(kRetries));
  verb.add_flag("--no-sync", options->no_sync,
                "Do not wait for the disk: faster, but a power cut may lose what was copied");
  AddWait(verb, options->wait);
  AddJson(verb, options->json);
  return [options](Console& console) { return RunSync(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb sync lab.db robot7.db", "Both hold all atlases of both afterwards, with all revisions."},
    {"slamdb sync lab.db fleet.db --name robot7 --dry-run", "What would be done for one atlas."},
    {"slamdb sync lab.db disk/lab.db --one-way", "Brings a copy up to date."},
    {"slamdb sync robot7.db lab.db --diverged branch --retry 10",
     "A robot that came home, over a bad link: nothing that it made is left behind."},
};

}  // namespace

const Command kSync = {
    .name = "sync",
    .summary = "bring two stores to the same atlases and revisions",
    .group = Group::kStore,
    .description =
        R"(Copies what either store lacks, in files or on servers: atlases, revisions and tags. Revisions keep their hashes, numbers and
what the log says of them: who, when, with what. Whether one is there is told by its hash, and each is a transaction of its own:
what is killed, or loses its connection, is run again and goes on. To and from servers only what changed is sent.

Where each store has revisions that the other lacks, nothing is overwritten: see --diverged. An atlas that was removed from one
store comes back from the other; revisions that 'slamdb gc' gave up in one do not. Revisions before the newest that both have are
not brought either: where one store alone has such, a warning tells of them.)",
    .done = "Both stores hold the same, but for earlier revisions that a warning tells of.",
    .failed = "A store could not be read or written, or some atlas not be copied; what was copied stays.",
    .lossy = "Some atlas has diverged, or a tag is of another revision in each store: these stay as they are in both.",
    .examples = kExamples,
    .add = AddSync,
};

}  // namespace slamdb::cli
