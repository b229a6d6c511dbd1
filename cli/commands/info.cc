// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <memory>

#include "cli/batch.h"
#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/info_text.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {
namespace {

using nlohmann::ordered_json;

struct InfoOptions {
  InputOptions inputs;
  bool json = false;
  int plot = 0;  // 1 asked for, -1 forbidden, 0 where a terminal shows it
  std::string key;
};

// Whether a value of the report comes from the maps, and not from the header alone.
bool NeedsMaps(const std::string& key) {
  const std::string first = key.substr(0, key.find('.'));
  return key.empty() || first == "maps" || first == "totals" || first == "parts";
}

// The value at a dotted path, such as maps.0.keyframes. Throws Error naming what there is instead.
const ordered_json& ValueAt(const ordered_json& report, const std::string& key) {
  const ordered_json* value = &report;
  for (std::size_t begin = 0; begin <= key.size();) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    const std::string step = key.substr(begin, end - begin);
    const auto index = value->is_array() ? detail::ParseNumber<std::size_t>(step) : std::nullopt;
    if (index && *index < value->size()) {
      value = &(*value)[*index];
    } else if (value->is_object() && value->contains(step)) {
      value = &(*value)[step];
    } else {
      std::string known = value->is_array() ? "it has " + std::to_string(value->size()) + " entries, from 0" : "";
      if (value->is_object())
        for (const auto& [name, member] : value->items()) known += (known.empty() ? "there is " : ", ") + name;
      throw Error(ErrorKind::kNotFound, "no value '" + key + "': " + (known.empty() ? "nothing is below that" : known));
    }
    begin = end + 1;
  }
  return *value;
}

std::string ValueText(const ordered_json& value) {
  return value.is_string() ? value.get<std::string>() + "\n" : detail::JsonText(value);
}

// How many columns the plan of a map may take; 0: none is drawn.
std::size_t PlanWidth(const InfoOptions& options, const Console& console) {
  constexpr std::size_t kWidest = 60;
  const bool drawn = options.plot > 0 || (options.plot == 0 && ::isatty(STDOUT_FILENO) != 0 && ShowsUnicode());
  return drawn ? std::min(kWidest, console.width()) : 0;
}

ExitCode RunInfo(const InfoOptions& options, Console& console) {
  const auto outcomes = ForEachInput<AtlasInfo>(
      options.inputs, console, [&](const std::string& path, const ReadOptions& read, Notices& notices) {
        return ReadInfo(path, read, &notices, !NeedsMaps(options.key));
      });
  const bool several = outcomes.size() > 1;
  bool first = true;
  for (const auto& outcome : outcomes) {
    if (!outcome.ok()) continue;
    if (!options.key.empty()) {
      console.Print((several ? outcome.path + ": " : "") +
                    ValueText(ValueAt(ordered_json::parse(ToJson(outcome.result)), options.key)));
    } else if (options.json) {
      console.PrintData(ToJson(outcome.result, several ? -1 : 2));
    } else {
      console.Print((first ? "" : "\n") + InfoText(outcome.result, PlanWidth(options, console)), PaintHeadings);
    }
    first = false;
  }
  return ReportOutcomes(outcomes, console);
}

Run AddInfo(CLI::App& verb) {
  const auto options = std::make_shared<InfoOptions>();
  AddInputs(verb, options->inputs, AtlasAt("An atlas"));
  AddJson(verb, options->json);
  verb.add_flag("--plot,!--no-plot", options->plot,
                "Draw the trajectory of each map as seen from above; by default on terminals of UTF-8");
  verb.add_option("-g,--get", options->key, "Print this value of the JSON only, such as maps.0.keyframes")
      ->type_name("KEY");
  return [options](Console& console) { return RunInfo(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb info lab.osa", "Header, vocabulary, cameras, and what is in each map."},
    {"slamdb info --get totals.keyframes lab.osa", "One number, for a script."},
    {"slamdb info maps/*.osa --json | jq -r '[.input, .totals.points] | @tsv'", "A table of many files."},
    {"slamdb info lab.db#session_a", "An atlas in a store."},
};

}  // namespace

const Command kInfo = {
    .name = "info",
    .summary = "show what is in an atlas",
    .group = Group::kLook,
    .description =
        R"(Shows the header, the vocabulary, the cameras, and for each map: sensor, counts, how points are observed, extent,
trajectory, graph, inertial state and ids; then what takes the space on disk. Lengths are in metres, or in units of the
map where a monocular map has no scale. Terminals that show UTF-8 get a plan of each trajectory.

--json prints one object for a file, and one object per line for several files; schema/info.schema.json describes it.
Ids are whole numbers of up to 64 bits; null stands for none.)",
    .failed = "An input could not be read, or there is no such value.",
    .examples = kExamples,
    .add = AddInfo,
};

}  // namespace slamdb::cli
