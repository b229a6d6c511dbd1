// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct LogOptions {
  StoreVerbOptions store;
  bool json = false;
};

// `+49 -2 ~37`; nothing where nothing changed, or nobody counted.
std::string ChangesText(std::uint64_t added, std::uint64_t removed, std::uint64_t moved) {
  std::string text;
  const auto add = [&](char sign, std::uint64_t count) {
    if (count > 0) text += (text.empty() ? "" : " ") + std::string(1, sign) + Grouped(count);
  };
  add('+', added);
  add('-', removed);
  add('~', moved);
  return text;
}

// `lab@3 (release)`; without number where it cannot be read any more.
std::string RevisionText(const HistoryEntry& entry) {
  std::string text = entry.atlas;
  if (entry.readable) text += "@" + std::to_string(entry.revision);
  for (const std::string& tag : entry.tags) text += (&tag == entry.tags.data() ? " (" : ", ") + tag;
  return entry.tags.empty() ? text : text + ")";
}

std::string FromText(const HistoryEntry& entry) {
  return entry.provenance.empty() && entry.from ? entry.from->ToString() : entry.provenance;
}

std::string LogText(const std::vector<HistoryEntry>& entries) {
  using enum Table::Align;
  Table table({kLeft, kLeft, kLeft, kLeft, kLeft, kLeft, kLeft, kLeft});
  table.Add({"WHEN", "WHO", "ACTION", "ATLAS", "KEYFRAMES", "POINTS", "OBSERVATIONS", "FROM"});
  for (const HistoryEntry& entry : entries) {
    const MapChanges changes = entry.changes.value_or(MapChanges{});
    table.Add({entry.at, entry.who, entry.action, RevisionText(entry),
               ChangesText(changes.keyframes_added, changes.keyframes_removed, changes.keyframes_moved),
               ChangesText(changes.points_added, changes.points_removed, changes.points_moved),
               ChangesText(changes.observations_added, changes.observations_removed, 0), FromText(entry)});
  }
  return entries.empty() ? "no history\n" : table.ToString();
}

// Of the store, an atlas, or one revision; of what was removed, too.
std::vector<HistoryEntry> EntriesOf(const Location& location, double wait) {
  Store store = Store::Open(location.path, wait);
  std::vector<HistoryEntry> entries = store.Log(location.name);
  if (!entries.empty() || location.name.empty()) return entries;
  return {store.LogOf(store.FindRevision(location.name))};
}

ExitCode RunLog(const LogOptions& options, Console& console) {
  const Location location = Location::Parse(options.store.path);
  const std::vector<HistoryEntry> entries = EntriesOf(location, options.store.wait);
  if (options.json)
    console.PrintData(ToJson(entries, options.store.path));
  else
    console.Print(LogText(entries));
  return ExitCode::kDone;
}

Run AddLog(CLI::App& verb) {
  const auto options = std::make_shared<LogOptions>();
  AddStore(verb, options->store);
  AddJson(verb, options->json);
  return [options](Console& console) { return RunLog(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb log lab.db", "Everything that was done to a store, oldest first."},
    {"slamdb log lab.db#session_a", "What was done to one of its atlases."},
};

}  // namespace

const Command kLog = {
    .name = "log",
    .summary = "show the revisions of a store's atlases",
    .group = Group::kStore,
    .description =
        R"(Shows the history of a store, or of one atlas (STORE.db#NAME): who saved or removed it when, from what, and what that changed
in the map: + added, - removed, ~ moved. NAME@3 in the column ATLAS is a revision that every verb can read, as STORE.db#NAME@3.)",
    .failed = "The store could not be read.",
    .examples = kExamples,
    .add = AddLog,
};

}  // namespace slamdb::cli
