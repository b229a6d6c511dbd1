// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/formats/sqlite/report.h"

namespace slamdb::cli {
namespace {

struct LogOptions {
  StoreVerbOptions store;
  bool json = false;
};

std::string LogText(const std::vector<HistoryEntry>& entries) {
  using enum Table::Align;
  Table table({kLeft, kLeft, kLeft, kRight, kRight, kRight, kRight, kLeft});
  table.Add({"WHEN", "ACTION", "ATLAS", "INSERTED", "UPDATED", "DELETED", "UNCHANGED", "FROM"});
  for (const HistoryEntry& entry : entries)
    table.Add({entry.at, entry.action, entry.atlas, Grouped(entry.inserted), Grouped(entry.updated),
               Grouped(entry.deleted), Grouped(entry.unchanged), entry.provenance});
  return entries.empty() ? "no history\n" : table.ToString();
}

ExitCode RunLog(const LogOptions& options, Console& console) {
  const Location location = Location::Parse(options.store.path);
  const std::vector<HistoryEntry> entries = Store::Open(location.path, options.store.wait).Log(location.name);
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
    .summary = "show what was done to a store",
    .group = Group::kStore,
    .description =
        "Shows the history of a store, or of one atlas (STORE.db#NAME): when it was saved or removed, by what, "
        "and how many rows that changed.",
    .failed = "The store could not be read.",
    .examples = kExamples,
    .add = AddLog,
};

}  // namespace slamdb::cli
