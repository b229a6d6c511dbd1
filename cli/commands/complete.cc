// SPDX-License-Identifier: BSD-3-Clause
//
// What only the files can tell: completion scripts ask it while somebody types.
#include <algorithm>
#include <memory>
#include <set>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::cli {
namespace {

constexpr std::size_t kMostOffered = 200;

struct CompleteOptions {
  std::vector<std::string> words;
};

// Whoever presses Tab asked for no connection: a server may take its time, ask for a password, or lock out who fails
// too often. So nothing is offered there.
bool IsOnServer(const std::string& word) { return Location(word).is_server(); }

// `lab.db#mo` -> `lab.db#monday`.
std::vector<std::string> AtlasNames(const std::string& word) {
  std::vector<std::string> found;
  const std::size_t hash = word.rfind('#');
  if (hash == std::string::npos) return found;
  const std::string path = word.substr(0, hash);
  for (const std::string& name : Store::Open(path).Names())
    if (std::string whole = path + "#" + name; whole.starts_with(word)) found.push_back(std::move(whole));
  return found;
}

template <class List>
void AddIds(const List& list, const std::string& kind, std::set<std::uint64_t>& ids, const std::string& word) {
  if (!word.starts_with(kind)) return;
  for (const auto& entity : list)
    if (entity.id.has_value()) ids.insert(entity.id.value());
}

// Names of entities of an atlas: `kf/1` -> `kf/1`, `kf/10`, ...; without a slash their kinds.
std::vector<std::string> EntityNames(const std::string& input, const std::string& word) {
  const std::size_t slash = word.find('/');
  if (slash == std::string::npos) {
    std::vector<std::string> kinds = {"atlas", "camera/", "map/", "kf/", "mp/", "landmark/"};
    std::erase_if(kinds, [&](const std::string& kind) { return !kind.starts_with(word); });
    return kinds;
  }
  ReadOptions read;
  read.features = FeatureColumns::kNone;
  const Atlas atlas = ReadAtlas(input, read);
  std::set<std::uint64_t> ids;
  AddIds(atlas.cameras, "camera/", ids, word);
  AddIds(atlas.maps, "map/", ids, word);
  for (const Map& map : atlas.maps) {
    AddIds(map.keyframes, "kf/", ids, word);
    AddIds(map.points, "mp/", ids, word);
    AddIds(map.landmarks, "landmark/", ids, word);
  }
  std::vector<std::string> found;
  for (const std::uint64_t id : ids) {
    std::string name = word.substr(0, slash + 1) + std::to_string(id);
    if (name.starts_with(word)) found.push_back(std::move(name));
    if (found.size() == kMostOffered) break;
  }
  return found;
}

ExitCode RunComplete(const CompleteOptions& options, Console& console) {
  const std::vector<std::string>& words = options.words;
  if (IsOnServer(words.front())) return ExitCode::kDone;
  for (const std::string& name : words.size() < 2 ? AtlasNames(words.front()) : EntityNames(words[0], words[1]))
    console.Print(name + "\n");
  return ExitCode::kDone;
}

Run AddComplete(CLI::App& verb) {
  const auto options = std::make_shared<CompleteOptions>();
  verb.add_option("WORD", options->words, "STORE.db#BEGINNING, or an atlas and the beginning of an entity's name")
      ->type_name("WORD")
      ->required()
      ->expected(1, 2);
  return [options](Console& console) { return RunComplete(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb complete lab.db#", "The atlases of a store."},
    {"slamdb complete lab.osa kf/1", "Keyframes whose id begins with 1."},
};

}  // namespace

const Command kComplete = {
    .name = "complete",
    .summary = "print what a word may become, for completion scripts",
    .description = "Prints the names that a word may become, one a line: atlases of a store, entities of an atlas.",
    .examples = kExamples,
    .add = AddComplete,
    .hidden = true,
};

}  // namespace slamdb::cli
