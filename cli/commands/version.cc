// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/version.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {
namespace {

struct VersionOptions {
  bool json = false;
};

const char* DirectionOf(const Format& format) {
  if (format.read != nullptr && format.write != nullptr) return "read, write";
  return format.read != nullptr ? "read" : "write";
}

ExitCode RunVersion(const VersionOptions& options, Console& console) {
  if (options.json) {
    detail::Json report = detail::ReportHead("version");
    report["version"] = Version();
    report["formats"] = detail::Json::array();
    for (const Format& format : Formats())
      report["formats"].push_back(
          {{"id", format.id},
           {"title", format.title},
           {"suffixes", std::vector<std::string>(format.suffixes.begin(), format.suffixes.end())},
           {"reads", format.read != nullptr},
           {"writes", format.write != nullptr}});
    console.PrintData(detail::JsonText(report));
    return ExitCode::kDone;
  }
  using enum Table::Align;
  Table table({kLeft, kLeft, kLeft, kLeft}, 2);
  for (const Format& format : Formats()) {
    std::string suffixes;
    for (const std::string_view suffix : format.suffixes)
      suffixes += (suffixes.empty() ? "" : " ") + std::string(suffix);
    table.Add({std::string(format.id), DirectionOf(format), suffixes, std::string(format.title)});
  }
  console.Print("slamdb " + std::string(Version()) + "\n\nFormats:\n" + table.ToString());
  return ExitCode::kDone;
}

Run AddVersion(CLI::App& verb) {
  const auto options = std::make_shared<VersionOptions>();
  AddJson(verb, options->json);
  return [options](Console& console) { return RunVersion(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb version", "The version, and what --from and --to take."},
    {"slamdb version --json | jq -r .version", "The version alone, for a script."},
};

}  // namespace

const Command kVersion = {
    .name = "version",
    .summary = "print the version and the formats it knows",
    .description =
        "Prints the version of slamdb and every file format it reads or writes, with the suffixes by which "
        "it is recognised.",
    .failed = "Standard output could not be written.",
    .examples = kExamples,
    .add = AddVersion,
};

}  // namespace slamdb::cli
