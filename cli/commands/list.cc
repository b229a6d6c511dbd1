// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/formats/sqlite/report.h"

namespace slamdb::cli {
namespace {

struct ListOptions {
  StoreVerbOptions store;
  bool json = false;
};

std::string ListText(const std::vector<StoredAtlas>& atlases) {
  using enum Table::Align;
  constexpr std::size_t kLandmarksColumn = 5;
  Table table({kLeft, kRight, kRight, kRight, kRight, kRight, kRight, kRight, kLeft});
  table.Add({"NAME", "MAPS", "KEYFRAMES", "POINTS", "OBSERVATIONS", "LANDMARKS", "SIZE", "REVISION", "SAVED"});
  for (const StoredAtlas& atlas : atlases)
    table.Add({atlas.name, Grouped(atlas.maps), Grouped(atlas.keyframes), Grouped(atlas.points),
               Grouped(atlas.observations), Grouped(atlas.landmarks), HumanBytes(atlas.bytes), Grouped(atlas.revision),
               atlas.saved_at});
  if (std::ranges::all_of(atlases, [](const StoredAtlas& atlas) { return atlas.landmarks == 0; }))
    table.Drop(kLandmarksColumn);
  return atlases.empty() ? "no atlases\n" : table.ToString();
}

ExitCode RunList(const ListOptions& options, Console& console) {
  const std::vector<StoredAtlas> atlases = Store::Open(options.store.path, options.store.wait).List();
  if (options.json)
    console.PrintData(ToJson(atlases, options.store.path));
  else
    console.Print(ListText(atlases));
  return ExitCode::kDone;
}

Run AddList(CLI::App& verb) {
  const auto options = std::make_shared<ListOptions>();
  AddStore(verb, options->store);
  AddJson(verb, options->json);
  return [options](Console& console) { return RunList(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb list lab.db", "Names, counts and sizes."},
    {"slamdb list lab.db --json | jq -r '.atlases[].name'", "The names, for a script."},
};

}  // namespace

const Command kList = {
    .name = "list",
    .summary = "list the atlases of a store",
    .group = Group::kStore,
    .description = "Lists the atlases of a store by name. Others are named STORE.db#NAME on the command line.",
    .failed = "The store could not be read.",
    .examples = kExamples,
    .add = AddList,
};

}  // namespace slamdb::cli
