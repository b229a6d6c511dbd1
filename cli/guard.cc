// SPDX-License-Identifier: BSD-3-Clause
#include "cli/guard.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/exports.h"
#include "cli/options.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {
namespace {

constexpr const char* kMarks[] = {"writes a file", "writes an atlas", "writes atlases"};  // in the order of Writes
constexpr const char *kStandardInput = "/dev/stdin", *kStandardOutput = "/dev/stdout";

void RefuseEmptyNames(const CLI::Option& option, const std::string& value) {
  const std::string which = option.get_name() + ": ";
  if (value.empty()) RefuseUsage(which + "the name of the file is empty");
  const Location location = Location::Parse(value);
  if (location.name.empty() && location.path != value) RefuseUsage(which + value + " names no atlas behind the #");
  if (value != "-") detail::RefuseMistypedServer(location.path);
}

struct NamedFile {
  std::string path;
  detail::AtlasName atlas;

  static NamedFile Of(const std::string& value, const char* standard_stream) {
    if (value == "-") return {standard_stream, std::nullopt};
    const Location location = Location::Parse(value);
    if (!location.name.empty() || HoldsNamedAtlases(location.path)) return {location.path, location.name};
    return {location.path, std::nullopt};
  }
};

// A file `maps.db#lab` would stand in front of the atlas `lab` of the store `maps.db`.
void RefuseNameOfAnAtlas(const std::string& value) {
  detail::RequireFile(value);
  const std::size_t hash = value.rfind('#');
  if (hash != std::string::npos && hash > 0 && HoldsNamedAtlases(value.substr(0, hash)))
    throw Error(ErrorKind::kUsage, value, "", "names an atlas of a store, where a file is to be written; name another");
}

NamedFile OutputOf(const std::string& value, Writes what) {
  if (what == Writes::kFile) RefuseNameOfAnAtlas(value);
  if (what == Writes::kFile && value != "-") return {value, std::nullopt};
  return NamedFile::Of(value, kStandardOutput);
}

void RefuseTwins(const std::vector<NamedFile>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (detail::IsSameFile(outputs[i].path, outputs[i].atlas, outputs[j].path, outputs[j].atlas))
        throw Error(ErrorKind::kUsage, outputs[i].path, "",
                    "is an output of this run already, as " + outputs[j].path + "; name another file");
}

}  // namespace

CLI::Option* Mark(CLI::Option* option, Writes what) {
  return option->check(CLI::Validator([](std::string&) { return std::string(); }, "", kMarks[static_cast<int>(what)]));
}

std::optional<Writes> MarkOf(CLI::Option& option) {
  for (const Writes what : {Writes::kFile, Writes::kAtlas, Writes::kPattern}) {
    try {
      option.get_validator(kMarks[static_cast<int>(what)]);
      return what;
    } catch (const CLI::OptionNotFound&) {
    }
  }
  return std::nullopt;
}

bool NamesFiles(const CLI::Option* option) {
  return option->get_items_expected_max() > 0 && option->get_type_name().find("FILE") != std::string::npos;
}

void GuardFiles(CLI::App& verb) {
  std::vector<NamedFile> outputs;
  std::vector<std::string> exports;
  detail::KeepInputs();
  for (CLI::Option* option : verb.get_options(NamesFiles)) {
    const std::optional<Writes> writes = MarkOf(*option);
    for (const std::string& value : option->results()) {
      RefuseEmptyNames(*option, value);
      if (writes && *writes != Writes::kPattern) outputs.push_back(OutputOf(value, *writes));
      if (writes && *writes == Writes::kFile) exports.push_back(value);
      if (writes) continue;
      const NamedFile input = NamedFile::Of(value, kStandardInput);
      detail::EnterInput(input.path, input.atlas);
    }
  }
  for (const NamedFile& output : outputs) detail::RefuseInput(output.path, output.atlas);
  for (const std::string& path : exports) RefuseAtlas(path);
  RefuseTwins(outputs);
  detail::RefuseInput(kStandardOutput);  // where verbs speak
}

}  // namespace slamdb::cli
