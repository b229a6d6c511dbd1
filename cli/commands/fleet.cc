// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/fleet.h"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/limits.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/values.h"
#include "slamdb/formats/store/report.h"

namespace slamdb::cli {
namespace {

struct FleetVerbOptions {
  StoreVerbOptions store;
  std::vector<std::string> servers;
  std::string to;
  std::uint32_t partitions = 0, partition = 0;
  bool repair = false, json = false;
};

FleetOptions OptionsOf(const FleetVerbOptions& options, Console& console) {
  return {.lock_timeout = options.store.wait, .progress = console.MakeProgress()};
}

std::string StatusText(const Fleet& fleet) {
  using enum Table::Align;
  Table table({kRight, kLeft, kRight, kRight, kLeft});
  table.Add({"PARTITION", "SERVER", "ATLASES", "SIZE", ""});
  for (const FleetPartition& each : fleet.partitions)
    table.Add({std::to_string(each.number), each.server.empty() ? "its own" : each.server, Grouped(each.atlases),
               HumanBytes(each.bytes), each.failure.empty() ? "" : "does not answer"});
  return table.ToString();
}

// What is where; exit code 1 when some server does not answer.
ExitCode PrintStatus(const FleetVerbOptions& options, Console& console) {
  const Fleet fleet = ReadFleet(options.store.path);
  if (options.json)
    console.PrintData(ToJson(fleet, options.store.path));
  else if (!console.quiet())
    console.Print(StatusText(fleet));
  for (const FleetPartition& each : fleet.partitions)
    if (!each.failure.empty())
      console.Warn("partition " + std::to_string(each.number) + " on " + each.server + ": " + each.failure);
  return fleet.ok() ? ExitCode::kDone : ExitCode::kFailed;
}

ExitCode RunInit(const FleetVerbOptions& options, Console& console) {
  InitFleet(options.store.path, options.partitions, options.servers, OptionsOf(options, console));
  return PrintStatus(options, console);
}

ExitCode RunStatus(const FleetVerbOptions& options, Console& console) {
  if (options.repair) {
    const std::uint64_t rows = RepairFleet(options.store.path, OptionsOf(options, console));
    if (!console.quiet() && !options.json)
      console.Print(rows == 0 ? "nothing was left by interrupted writers on servers that answer\n"
                              : "removed " + Counted(rows, "row") + " that interrupted writers left\n");
  }
  return PrintStatus(options, console);
}

ExitCode RunMove(const FleetVerbOptions& options, Console& console) {
  MovePartition(options.store.path, options.partition, options.to, OptionsOf(options, console));
  return PrintStatus(options, console);
}

// ---- options

std::shared_ptr<FleetVerbOptions> AddFleetStore(CLI::App& verb) {
  const auto options = std::make_shared<FleetVerbOptions>();
  verb.add_option("STORE", options->store.path, "The store's own database, postgresql://USER@HOST/DATABASE")
      ->type_name("FILE")
      ->required();
  AddWait(verb, options->store.wait);
  AddJson(verb, options->json);
  return options;
}

Run BindInit(CLI::App& verb) {
  const auto options = AddFleetStore(verb);
  verb.add_option("--partitions", options->partitions,
                  "Into how many partitions atlases go, which stays so: several for each server there will ever be")
      ->type_name("N")
      ->check(Within(kPartitions))
      ->required();
  verb.add_option("--server", options->servers,
                  "A database that gets its share of the partitions, postgresql://USER@HOST/DATABASE; may be given "
                  "several times. Without one, all are on the store's own server")
      ->type_name("URI")
      ->allow_extra_args(false);
  return [options](Console& console) { return RunInit(*options, console); };
}

Run BindStatus(CLI::App& verb) {
  const auto options = AddFleetStore(verb);
  verb.add_flag("--repair", options->repair, "First remove what interrupted saves left on other servers");
  return [options](Console& console) { return RunStatus(*options, console); };
}

Run BindMove(CLI::App& verb) {
  const auto options = AddFleetStore(verb);
  verb.add_option("--partition", options->partition, "The number of the partition to move")
      ->type_name("N")
      ->check(Within(kPartition))
      ->required();
  verb.add_option("--to", options->to, "The database that gets it, postgresql://USER@HOST/DATABASE")
      ->type_name("URI")
      ->required();
  return [options](Console& console) { return RunMove(*options, console); };
}

Run AddFleet(CLI::App& verb) {
  verb.require_subcommand(1);
  std::vector<std::pair<const CLI::App*, Run>> runs;
  const auto add = [&](const char* name, const char* summary, Run (*bind)(CLI::App&)) {
    CLI::App* inner = verb.add_subcommand(name, summary);
    runs.emplace_back(inner, bind(*inner));
  };
  add("init", "Make a store whose partitions are on several servers", BindInit);
  add("status", "Tell which server has what, and which answer", BindStatus);
  add("move", "Move a partition to another server, while readers go on", BindMove);
  return [runs](Console& console) {
    for (const auto& [inner, run] : runs)
      if (inner->parsed()) return run(console);
    return ExitCode::kUsage;
  };
}

constexpr Example kExamples[] = {
    {"slamdb fleet init postgresql:///maps --partitions 8 --server postgresql://one/maps --server "
     "postgresql://two/maps",
     "A store whose atlases are on two servers, four partitions on each."},
    {"slamdb fleet status postgresql:///maps", "Which servers answer, and what they have."},
    {"slamdb fleet status postgresql:///maps --repair", "After a crash: gives back what interrupted saves left."},
    {"slamdb fleet move postgresql:///maps --partition 3 --to postgresql://three/maps",
     "The first of the partitions that a new server gets."},
};

}  // namespace

const Command kFleet = {
    .name = "fleet",
    .summary = "spread a store in PostgreSQL over several servers",
    .group = Group::kStore,
    .description =
        R"(A store in PostgreSQL may be in several partitions, and these on other servers, by postgres_fdw. The store's own server has
the list of atlases and their log, and is the one to name; an atlas is on one server, whole. A server that is down takes its
atlases with it: the others are listed, searched, read and saved as before.

'init' and 'move' may be interrupted, and are repeated as they were.)",
    .failed = "A server does not answer, does not let the user do that, or the store is another already.",
    .examples = kExamples,
    .add = AddFleet,
};

}  // namespace slamdb::cli
