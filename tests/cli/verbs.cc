// SPDX-License-Identifier: BSD-3-Clause
#include "tests/cli/verbs.h"

#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>

#include "cli/command.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

// What a verb needs besides its files, to do something.
const std::map<std::string, std::vector<std::string>>& More() {
  static const std::map<std::string, std::vector<std::string>> kMore = {
      {"align", {"room.osa"}},
      {"complete", {"a.osa", "kf/"}},
      {"completion", {"bash"}},
      {"edit", {"--points", "points.csv"}},
      {"evaluate", {"--align", "none"}},
      {"extract", {"--map", "0"}},
      {"fleet init", {"--partitions", "2"}},
      {"fleet move", {"--partition", "0", "--to", "postgresql://u:S3cret@127.0.0.1:1/other"}},
      {"layouts from-source", {"sources"}},
      {"layouts show", {"v1.0"}},
      {"man", {"--folder", "pages"}},
      {"plot", {"--format", "svg"}},
      {"reassign-origin", {"--compact"}},
      {"show", {"map/0"}},
      {"shrink", {"--target-keyframes", "2"}},
      {"transform", {"--scale", "2"}},
      {"vocabulary set", {"--vocabulary", "voc.txt"}},
  };
  return kMore;
}

// Inputs that are no atlas, by the verb and the option, or by the option alone.
std::string InputOf(const std::string& verb, const std::string& option) {
  static const std::map<std::string, std::string> kInputs = {{"STORE", "m.db"},
                                                             {"STORE#NAME", "m.db#a"},
                                                             {"--vocabulary", "voc.txt"},
                                                             {"migrate STORE", "old.db"},
                                                             {"landmarks from-points INPUT", "points.osa"},
                                                             {"landmarks to-points INPUT", "landmarks.mrpt"},
                                                             {"edit --points", "points.csv"},
                                                             {"edit --keyframes", "poses.keyframes.csv"},
                                                             {"align INPUT", "room.osa"},
                                                             {"locate INPUT", "room.osa"},
                                                             {"locate PICTURE", "room.jpg"}};
  for (const std::string& key : {verb + " " + option, option})
    if (const auto found = kInputs.find(key); found != kInputs.end()) return found->second;
  return option == "AFTER" || option.starts_with("--") ? "b.osa" : "a.osa";
}

FileOption FileOptionOf(CLI::Option& option) {
  const bool positional = option.get_positional();
  return {.name = positional ? option.get_name() : "--" + option.get_lnames().front(),
          .positional = positional,
          .required = option.get_required(),
          .writes = cli::MarkOf(option)};
}

void Collect(CLI::App& app, std::vector<std::string> words, std::vector<Verb>& verbs) {
  words.push_back(app.get_name());
  const auto inner = app.get_subcommands([](CLI::App*) { return true; });
  for (CLI::App* verb : inner) Collect(*verb, words, verbs);
  if (!inner.empty()) return;
  Verb verb{.words = words};
  for (CLI::Option* option : app.get_options(cli::NamesFiles)) verb.files.push_back(FileOptionOf(*option));
  if (app.get_option_no_throw("OUTPUT") != nullptr)
    verb.output_option = std::erase_if(verb.files, [](const FileOption& file) { return file.name == "--output"; }) > 0;
  std::stable_partition(verb.files.begin(), verb.files.end(), [](const FileOption& file) { return file.positional; });
  verb.overwrites = app.get_option_no_throw("--overwrite") != nullptr;
  verbs.push_back(std::move(verb));
}

}  // namespace

std::string Verb::name() const {
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "" : " ") + word;
  return name;
}

std::vector<Verb> AllVerbs() {
  CLI::App program;
  std::vector<Verb> verbs;
  for (const cli::Command* command : cli::Commands()) {
    CLI::App* app = program.add_subcommand(std::string(command->name));
    const cli::Run run = command->add(*app);
    Collect(*app, {}, verbs);
  }
  return verbs;
}

std::vector<std::pair<std::string, std::string>> TypesOfOptions() {
  CLI::App program;
  std::vector<std::pair<std::string, std::string>> types;
  const std::function<void(CLI::App&, const std::string&)> collect = [&](CLI::App& app, const std::string& before) {
    const std::string name = before + app.get_name() + " ";
    for (CLI::Option* option : app.get_options()) {
      if (option->get_items_expected_max() > 0) types.emplace_back(name + option->get_name(), option->get_type_name());
    }
    for (CLI::App* inner : app.get_subcommands([](CLI::App*) { return true; })) collect(*inner, name);
  };
  for (const cli::Command* command : cli::Commands()) {
    CLI::App* app = program.add_subcommand(std::string(command->name));
    const cli::Run run = command->add(*app);
    collect(*app, "");
  }
  return types;
}

std::string ValueOf(const Verb& verb, const FileOption& option) {
  if (!option.writes) return InputOf(verb.name(), option.name);
  if (verb.name() == "view" || verb.name() == "report") return "page.html";
  if (*option.writes != cli::Writes::kFile) return option.name == "STORE" ? "out.db" : "out.osa";
  std::string name = option.name;
  name.erase(0, name.find_first_not_of('-'));
  return name + (name == "plot" ? ".svg" : ".out");
}

std::vector<std::string> CommandLine(const Verb& verb) {
  std::vector<std::string> line = verb.words;
  for (const FileOption& file : verb.files) {
    if (!file.required && !file.positional && !file.writes) continue;
    if (!file.positional) line.push_back(file.name);
    line.push_back(ValueOf(verb, file));
  }
  if (const auto more = More().find(verb.name()); more != More().end())
    line.insert(line.end(), more->second.begin(), more->second.end());
  return line;
}

void FillFolder(const std::string& folder) {
  const std::filesystem::path in(folder);
  const std::string tiny = SLAMDB_FIXTURES "/tiny/tiny.osa";
  for (const char* name : {"a.osa", "b.osa", "points.osa"}) std::filesystem::copy_file(tiny, in / name);
  for (const char* name : {"m.db#a", "m.db#b", "old.db#a"}) WriteAtlas(ReadAtlas(tiny), (in / name).string());
  for (const char* name : {"points.csv", "poses.keyframes.csv"}) WriteAtlas(ReadAtlas(tiny), (in / name).string());
  MigrateStore((in / "old.db").string(), {.back = true, .backup = false});
  std::filesystem::create_directory(in / "sources");
  WriteWholeFile(in / "sources" / "map.h",
                 "class Map { int a; template <class A> void serialize(A& ar, unsigned) { ar & a; } };\n"
                 "void Save(Map* map) { boost::archive::binary_oarchive oa(f); oa << map; }\n");
  std::filesystem::copy_file(SLAMDB_FIXTURES "/room/corner.osa", in / "room.osa");
  std::filesystem::copy_file(SLAMDB_FIXTURES "/room/a01.jpg", in / "room.jpg");
  std::filesystem::copy_file(SLAMDB_FIXTURES "/vocabulary/small.txt", in / "voc.txt");
  std::filesystem::copy_file(SLAMDB_FIXTURES "/mrpt/landmarks.bin", in / "landmarks.mrpt");
}

}  // namespace slamdb::testing
