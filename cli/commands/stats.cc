// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct StatsOptions {
  StoreVerbOptions store;
  bool json = false;
};

std::string StatsText(const StoreStats& stats, bool is_server) {
  using enum Table::Align;
  Table sizes({kLeft, kRight});
  sizes.Add({is_server ? "tables" : "file", HumanBytes(stats.file_bytes)});
  if (!is_server || stats.log_bytes > 0)
    sizes.Add({is_server ? "write-ahead log of the server" : "write-ahead log", HumanBytes(stats.log_bytes)});
  if (!is_server) sizes.Add({"free in the file", HumanBytes(stats.free_pages * stats.page_bytes)});
  sizes.Add({"schema version", std::to_string(stats.version)});
  if (stats.partitions_elsewhere > 0)
    sizes.Add({"not in it", Counted(stats.partitions_elsewhere, "partition") +
                                " on other servers, of which 'slamdb fleet status' tells"});
  Table tables({kLeft, kRight, kRight}, 2);
  for (const PartSize& part : stats.tables)
    tables.Add({part.part, HumanBytes(part.bytes), Percent(part.bytes, stats.file_bytes)});
  return sizes.ToString() + "\ntables with their indexes\n" + tables.ToString();
}

ExitCode RunStats(const StatsOptions& options, Console& console) {
  const StoreStats stats = Store::Open(options.store.path, options.store.wait).Stats();
  if (options.json)
    console.PrintData(ToJson(stats, options.store.path));
  else
    console.Print(StatsText(stats, detail::IsServer(options.store.path)));
  return ExitCode::kDone;
}

Run AddStats(CLI::App& verb) {
  const auto options = std::make_shared<StatsOptions>();
  AddStore(verb, options->store);
  AddJson(verb, options->json);
  return [options](Console& console) { return RunStats(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb stats lab.db", "What takes the space in a store."},
    {"slamdb stats lab.db --json | jq .free_pages", "Whether a vacuum is worth it."},
};

}  // namespace

const Command kStats = {
    .name = "stats",
    .summary = "show what takes the space in a store",
    .group = Group::kStore,
    .description = "Shows the size of a store's file, how much of it is free, and what each table takes.",
    .failed = "The store could not be read.",
    .examples = kExamples,
    .add = AddStats,
};

}  // namespace slamdb::cli
