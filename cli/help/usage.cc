// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help/usage.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "cli/command.h"
#include "cli/guard.h"
#include "cli/help/tree.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb::cli {
namespace {

using detail::Concat;

// What people type who know other tools, and the verb that does it here.
struct OtherWord {
  std::string_view typed, verb;
  std::string_view output = {};  // to write to, where none was typed
  std::string_view more = {};    // what the command line needs besides
};

constexpr OtherWord kOtherWords[] = {
    {"ape", "evaluate"},
    {"append", "merge", {}, "-o both.osa"},
    {"ate", "evaluate"},
    {"ba", "optimize", "adjusted.osa"},
    {"bundle-adjustment", "optimize", "adjusted.osa"},
    {"bundle_adjuster", "optimize", "adjusted.osa"},
    {"cat", "dump"},
    {"checkout", "restore"},
    {"clean", "gc", {}, "--keep 10"},
    {"clone", "branch", "NAME"},
    {"combine", "merge", {}, "-o both.osa"},
    {"commit", "convert", "maps.db#NAME"},
    {"compact", "gc", {}, "--keep 10"},
    {"compare", "diff"},
    {"conflicts", "merge --json", {}, "--base base.osa -o both.osa"},
    {"copy", "convert", "copy.osa"},
    {"cp", "convert", "copy.osa"},
    {"crop", "extract", "part.osa", "--box X,Y,Z:X,Y,Z"},
    {"cut", "extract", "part.osa", "--time +0:+10"},
    {"delete", "remove"},
    {"describe", "info"},
    {"df", "stats"},
    {"display", "view"},
    {"doctor", "check"},
    {"downgrade", "convert", "older.osa", "--boost-version ubuntu20.04"},
    {"download", "sync", "copy.db"},
    {"draw", "plot"},
    {"drop", "remove"},
    {"evo", "evaluate"},
    {"evo_ape", "evaluate"},
    {"evo_rpe", "evaluate"},
    {"evo_traj", "evaluate"},
    {"expire", "gc", {}, "--keep 10"},
    {"export", "convert", "points.ply"},
    {"find", "list"},
    {"fix", "repair", "fixed.osa"},
    {"forget", "gc", {}, "--keep 10"},
    {"fsck", "check"},
    {"fork", "branch"},
    {"garbage-collect", "gc", {}, "--keep 10"},
    {"gui", "view"},
    {"history", "log"},
    {"import", "convert", "map.osa"},
    {"init", "convert", "maps.db#NAME"},
    {"inspect", "info"},
    {"join", "merge", {}, "-o joined.osa --align"},
    {"label", "tag"},
    {"lint", "check"},
    {"load", "info"},
    {"localise", "locate", "picture.jpg"},
    {"localize", "locate", "picture.jpg"},
    {"loop", "close-loops", "closed.osa"},
    {"loop-closure", "close-loops", "closed.osa"},
    {"loops", "close-loops", "closed.osa"},
    {"ls", "list"},
    {"match", "align"},
    {"move", "transform", "moved.osa", "--by 'tx ty tz qx qy qz qw'"},
    {"open", "view"},
    {"png", "plot"},
    {"print", "dump"},
    {"prune", "cull", "thin.osa"},
    {"pull", "sync", "copy.db"},
    {"purge", "remove"},
    {"push", "sync", "copy.db"},
    {"put", "convert", "maps.db#NAME"},
    {"query", "list"},
    {"recognise", "locate", "picture.jpg"},
    {"recognize", "locate", "picture.jpg"},
    {"register", "align"},
    {"relocalise", "locate", "picture.jpg"},
    {"relocalize", "locate", "picture.jpg"},
    {"render", "view"},
    {"rename", "renumber", "renumbered.osa"},
    {"rescue", "recover", "saved.osa"},
    {"reset", "restore"},
    {"revert", "restore"},
    {"revisions", "log"},
    {"rm", "remove"},
    {"rollback", "restore"},
    {"rpe", "evaluate"},
    {"salvage", "recover", "saved.osa"},
    {"save", "add", "maps.db"},
    {"search", "list"},
    {"serve", "view", {}, "--serve"},
    {"simplify", "shrink", "small.osa", "--target-keyframes 100"},
    {"squash", "gc", {}, "--keep 10"},
    {"stat", "info"},
    {"store", "convert", "maps.db#NAME"},
    {"subset", "extract", "part.osa", "--map 0"},
    {"tags", "tag"},
    {"trajectory", "convert", "poses.tum"},
    {"trim", "extract", "part.osa", "--time +0:+10"},
    {"undo", "repair", "undone.osa", "--undo journal.json"},
    {"upgrade", "migrate"},
    {"upload", "sync", "copy.db"},
    {"validate", "check"},
    {"verify", "check"},
    {"versions", "log"},
    {"viewer", "view"},
    {"where", "locate", "picture.jpg"},
};

// What an operand tells of which of two meanings a word has.
enum class Operand { kNone, kStore, kAtlasInStore, kPicture };

// What a word means besides, where one operand is of that kind.
struct OtherMeaning {
  std::string_view of;  // what tells it apart
  Operand operand;
  OtherWord word;
};

constexpr OtherMeaning kOtherMeanings[] = {
    {"of a whole store", Operand::kStore, {"clone", "sync", "copy.db"}},
    {"shown in place", Operand::kNone, {"conflicts", "view --findings"}},
    {"of a picture", Operand::kPicture, {"find", "locate"}},
    {"of the revisions of a store", Operand::kStore, {"prune", "gc", {}, "--keep 10"}},
    {"of a picture", Operand::kPicture, {"search", "locate"}},
    {"of the last save in a store", Operand::kAtlasInStore, {"undo", "restore"}},
};

// Options by the names that other tools give them.
constexpr std::pair<std::string_view, std::string_view> kOtherOptions[] = {
    {"--force", "--overwrite"},  {"-f", "--overwrite"},   {"-y", "--overwrite"},   {"--yes", "--overwrite"},
    {"--format", "--to"},        {"--type", "--to"},      {"-n", "--dry-run"},     {"--out", "--output"},
    {"--jobs", "--threads"},     {"-j", "--threads"},     {"--silent", "--quiet"}, {"--bbox", "--box"},
    {"--simulate", "--dry-run"}, {"--colour", "--color"},
};

// Edits that turn one word into the other: insert, delete, replace (Levenshtein).
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

// As a shell takes it for one word.
std::string ShellWord(const std::string& word) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./:,@%#";
  if (!word.empty() && word.front() != '#' && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (const char letter : word) out += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return out + "'";
}

std::string CommandLine(std::string_view verb, std::span<const std::string> words) {
  std::string line = Concat("slamdb ", verb);
  for (const std::string& word : words) line += " " + ShellWord(word);
  return line;
}

// What is in a server is not asked for, and taken to be there.
bool IsThere(const std::string& path) {
  std::error_code ignored;
  return detail::IsServer(path) || std::filesystem::exists(path, ignored);
}

// Whether the verb has an -o that was not given, and no OUTPUT that would be in its place.
bool MissesOutput(const CLI::App& verb) {
  const CLI::Option* output = verb.get_option_no_throw("-o");
  return output != nullptr && output->count() == 0 && verb.get_option_no_throw("OUTPUT") == nullptr;
}

// Whether a name is one to write to: pages and pictures always, tables and reports where nothing is there yet.
bool LooksWritten(const std::string& word) {
  constexpr std::string_view kAlways[] = {".html", ".htm", ".svg", ".png"};
  constexpr std::string_view kNew[] = {".csv", ".json", ".ndjson", ".jsonl", ".xml", ".sarif"};
  const std::string suffix = std::filesystem::path(word).extension().string();
  return std::ranges::find(kAlways, suffix) != std::end(kAlways) ||
         (std::ranges::find(kNew, suffix) != std::end(kNew) && !IsThere(word));
}

// The command line with -o before the word.
std::string WithOutput(std::span<const std::string> words, const std::string& output) {
  std::vector<std::string> line(words.begin(), words.end());
  const auto at = std::ranges::find(line.rbegin(), line.rend(), output);
  if (at != line.rend()) line.insert(at.base() - 1, "-o");
  return CommandLine(line.front(), std::span(line).subspan(1));
}

// How many of the words are no options.
std::size_t Operands(std::span<const std::string> words) {
  return static_cast<std::size_t>(
      std::ranges::count_if(words, [](const std::string& word) { return !word.starts_with("-") || word == "-"; }));
}

Operand KindOf(const std::string& word) {
  constexpr std::string_view kPictures[] = {".jpg", ".jpeg", ".png", ".pgm"};
  const Location location = Location::Parse(word);
  if (HoldsNamedAtlases(location.path)) return location.name.empty() ? Operand::kStore : Operand::kAtlasInStore;
  const std::string suffix = std::filesystem::path(word).extension().string();
  return std::ranges::find(kPictures, suffix) != std::end(kPictures) ? Operand::kPicture : Operand::kNone;
}

bool IsStore(const std::string& word) { return KindOf(word) == Operand::kStore; }

// `add` has the store first: the one that was typed, wherever it stands.
std::string AddLine(const OtherWord& other, std::span<const std::string> words) {
  std::vector<std::string> line(words.begin(), words.end());
  const auto store = std::ranges::find_if(line, IsStore);
  if (store == line.end() || Operands(words) < 2)
    line.insert(line.begin(), std::string(other.output));
  else
    std::rotate(line.begin(), store, store + 1);
  return CommandLine(other.verb, line);
}

// What `convert` keeps in a store has a name there.
std::string KeepLine(const OtherWord& other, std::span<const std::string> words) {
  std::vector<std::string> line(words.begin(), words.end());
  const auto store = std::ranges::find_if(line, IsStore);
  if (store == line.end())
    return CommandLine(other.verb, line) + (Operands(words) < 2 ? Concat(" ", other.output) : "");
  *store += "#NAME";
  std::rotate(store, store + 1, line.end());
  if (Operands(words) < 2) line.insert(line.begin(), "FILE");
  return CommandLine(other.verb, line);
}

// Where no revision was named, the one before the newest.
std::string RestoreLine(const OtherWord& other, std::span<const std::string> words) {
  std::vector<std::string> line(words.begin(), words.end());
  for (std::string& word : line)
    if (KindOf(word) == Operand::kAtlasInStore && Location::Parse(word).name.find('@') == std::string::npos)
      word += "@-1";
  return CommandLine(other.verb, line);
}

std::string LineFor(const OtherWord& other, std::span<const std::string> words) {
  if (Operands(words) == 0) return Concat("slamdb ", other.verb.substr(0, other.verb.find(' ')), " --help");
  if (other.verb == "add") return AddLine(other, words);
  if (other.verb == "restore") return RestoreLine(other, words);
  if (other.output.ends_with("#NAME")) return KeepLine(other, words);
  std::string line = CommandLine(other.verb, words);
  if (Operands(words) < 2 && !other.output.empty()) line += Concat(" ", other.output);
  return other.more.empty() ? line : Concat(line, " ", other.more);
}

UsageProblem ProblemOfOtherWord(const OtherWord& other, std::span<const std::string> words) {
  UsageProblem problem{Concat("unknown verb '", other.typed, "'; here it is '", other.verb, "'"),
                       LineFor(other, words)};
  const auto besides =
      std::ranges::find(kOtherMeanings, other.typed, [](const OtherMeaning& meaning) { return meaning.word.typed; });
  if (besides == std::end(kOtherMeanings)) return problem;
  problem.problem += Concat(", and ", besides->of, " '", besides->word.verb, "'");
  const bool is_meant = besides->operand != Operand::kNone && std::ranges::count(words, besides->operand, KindOf) > 0;
  if (is_meant) problem.next = LineFor(besides->word, words);
  return problem;
}

std::vector<std::string> NamesOf(const CLI::App& verb, bool options) {
  std::vector<std::string> names;
  if (options)
    for (const OptionEntry& entry : OptionsOf(verb)) names.insert(names.end(), entry.names.begin(), entry.names.end());
  else
    for (const CLI::App* inner : VerbsOf(verb)) names.push_back(inner->get_name());
  return names;
}

// The first word that nothing takes, with the word that was probably meant.
std::string Explain(const CLI::App& verb, const std::string& word) {
  const bool option = word.starts_with("-");
  const std::vector<std::string> known = NamesOf(verb, option);
  const std::string name = word.substr(0, word.find('='));
  const std::string kind = option ? "unknown option" : known.empty() ? "unexpected argument" : "unknown verb";
  if (option && std::ranges::find(known, name) != known.end())
    return Concat("'", word, "' stands before the verb that takes it; put it behind");
  for (const auto& [typed, here] : kOtherOptions)
    if (typed == name && std::ranges::find(known, here) != known.end())
      return Concat(kind, " '", word, "'; here it is ", here);
  return kind + " '" + word + "'" + MeantInstead(name, known);
}

// Whether it may be a number or tag of a revision, or the name of an atlas: no option, no path.
bool IsName(const std::string& word) {
  const bool is_number = word.find_first_not_of("-0123456789") == std::string::npos;
  return !word.empty() && (word.front() != '-' || is_number) && word.find_first_of("./#@") == std::string::npos;
}

void EraseLast(std::vector<std::string>& words, const std::string& word) {
  const auto last = std::ranges::find(words.rbegin(), words.rend(), word);
  if (last != words.rend()) words.erase(last.base() - 1);
}

// Of a revision that stands by itself: `restore maps.db#lab 1`.
std::optional<UsageProblem> ProblemOfRevision(const CLI::App& verb, std::vector<std::string> words,
                                              const std::string& word) {
  const auto atlas =
      std::ranges::find_if(words, [](const std::string& each) { return KindOf(each) == Operand::kAtlasInStore; });
  if (verb.get_name() != "restore" || !IsName(word) || atlas == words.end() ||
      Location::Parse(*atlas).name.find('@') != std::string::npos)
    return std::nullopt;
  const std::string meant = *atlas += "@" + word;
  EraseLast(words, word);
  return UsageProblem{Concat("unexpected argument '", word, "'; a revision is named ", meant),
                      CommandLine(words.front(), std::span(words).subspan(1))};
}

// Of a name that stands behind the store by itself: `convert a.osa maps.db lab`, `--name lab`, `--name=lab`.
std::optional<UsageProblem> ProblemOfName(const CLI::App& verb, std::vector<std::string> words,
                                          const std::string& word) {
  constexpr std::string_view kOption = "--name", kValue = "--name=";
  const auto option =
      std::ranges::find_if(words, [&](const std::string& each) { return each == kOption || each.starts_with(kValue); });
  const bool is_option = option != words.end() && verb.get_option_no_throw(std::string(kOption)) == nullptr;
  const bool has_value = is_option && *option == kOption && option + 1 != words.end();
  const std::string name = !is_option  ? word
                           : has_value ? option[1]
                                       : option->substr(std::min(kValue.size(), option->size()));
  if (verb.get_option_no_throw("OUTPUT") == nullptr || !IsName(name)) return std::nullopt;
  if (is_option)
    words.erase(option, option + (has_value ? 2 : 1));
  else
    EraseLast(words, word);
  const auto store = std::ranges::find_if(words.rbegin(), words.rend(), IsStore);
  if (store == words.rend()) return std::nullopt;
  *store += "#" + name;
  return UsageProblem{Concat(is_option ? "unknown option '" : "unexpected argument '", is_option ? kOption : word,
                             "'; an atlas in a store is named ", *store),
                      CommandLine(words.front(), std::span(words).subspan(1))};
}

// Programs by whose name people ask for the format that they read, and formats by another name.
constexpr std::pair<std::string_view, std::string_view> kFormatsOf[] = {
    {"blender", "gltf"},
    {"cloudcompare", "ply"},
    {"evo", "tum"},
    {"excel", "csv"},
    {"foxglove", "mcap"},
    {"glb", "gltf"},
    {"google-earth", "kml"},
    {"json", "ndjson"},
    {"meshlab", "ply"},
    {"osa", "orbslam3"},
    {"pandas", "csv"},
    {"pcl", "pcd"},
    {"qgis", "geojson"},
    {"rviz", "mcap"},
    {"sqlite", "store"},
    {"threejs", "gltf"},
    {"splat", "3dgs"},
    {"splats", "3dgs"},
    {"gaussian", "3dgs"},
    {"gaussians", "3dgs"},
    {"nerfstudio", "nerf"},
    {"instant-ngp", "nerf"},
    {"openvslam", "stella"},
    {"stella_vslam", "stella"},
    {"stella-vslam", "stella"},
    {"colmap-bin", "colmap"},
    {"colmap-binary", "colmap"},
    {"colmap-txt", "colmap-text"},
    {"orb-slam2", "osmap"},
};

// `--to: xml not in {orbslam3,tum}` with the word that was probably meant.
std::string NotOneOf(const std::string& text) {
  constexpr std::string_view kNotIn = " not in {";
  const std::size_t at = text.find(kNotIn), end = text.rfind('}');
  if (at == std::string::npos || end == std::string::npos || end < at) return {};
  const std::size_t colon = text.find(": ");
  const std::size_t begin = colon < at ? colon + 2 : 0;
  const std::string value = text.substr(begin, at - begin);
  std::vector<std::string> words;
  std::string list;
  for (const std::string_view word :
       detail::Split(std::string_view(text).substr(at + kNotIn.size(), end - at - kNotIn.size()), ',')) {
    words.emplace_back(word);
    list += Concat(list.empty() ? "" : ", ", word);
  }
  if (text.starts_with("--to: ") && FindKnownLayout(value) != nullptr)
    return Concat("--to: '", value, "' is no format but a layout; did you mean '--to-layout ", value, "'?");
  for (const auto& [asked, format] : kFormatsOf)
    if (asked == value && std::ranges::find(words, format) != words.end())
      return Concat(text.substr(0, begin), "unknown format '", value, "'; what it reads is ", format);
  return Concat(text.substr(0, begin), "expected one of ", list, ", found '", value, "'", MeantInstead(value, words));
}

// `--boost-version: Value 3 not in range 10 to 255`.
std::string NotInRange(const std::string& text) {
  constexpr std::string_view kValue = ": Value ", kRange = " not in range ";
  const std::size_t value = text.find(kValue), range = text.find(kRange);
  if (value == std::string::npos || range == std::string::npos || range < value) return {};
  const std::size_t begin = value + kValue.size();
  return Concat(text.substr(0, value), ": expected a number from ", text.substr(range + kRange.size()), ", found '",
                text.substr(begin, range - begin), "'");
}

// `Could not convert: --map = x`, and `--json = x` of a flag.
std::string NotConverted(const CLI::App& verb, const std::string& text) {
  constexpr std::string_view kConvert = "Could not convert: ", kIs = " = ";
  const std::size_t is = text.find(kIs);
  if (!text.starts_with(kConvert) || is == std::string::npos) return {};
  const std::string name = text.substr(kConvert.size(), is - kConvert.size());
  const CLI::Option* option = verb.get_option_no_throw(name);
  if (option != nullptr && option->get_items_expected_max() == 0) return name + " takes no value";
  return Concat(name, ": expected a number, found '", text.substr(is + kIs.size()), "'");
}

// In the words of the house: what was expected, and what was found.
std::string Reworded(const CLI::App& verb, const CLI::ParseError& error) {
  const std::string text = error.what(), kind = error.get_name();
  if (kind == "ArgumentMismatch") {
    const std::string name = text.substr(0, text.find(':'));
    if (text.find("but received") != std::string::npos) return name + ": it is given more than once";
    return text.find("required") != std::string::npos ? name + ": a value is missing" : text;
  }
  if (kind == "ExcludesError") {
    constexpr std::string_view kExcludes = " excludes ";
    const std::size_t at = text.find(kExcludes);
    return at == std::string::npos
               ? text
               : Concat(text.substr(0, at), " and ", text.substr(at + kExcludes.size()), " exclude each other");
  }
  if (kind == "RequiredError") {
    constexpr std::string_view kRequired = " is required";
    return text.ends_with(kRequired) ? text.substr(0, text.size() - kRequired.size()) + " is missing" : text;
  }
  for (const std::string& said : {NotOneOf(text), NotInRange(text), NotConverted(verb, text)})
    if (!said.empty()) return said;
  return text;
}

}  // namespace

std::string DidYouMean(std::string_view word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = candidate.size() > word.size() && word.size() >= 3 && candidate.starts_with(word)
                                     ? 1
                                     : EditDistance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string MeantInstead(std::string_view word, const std::vector<std::string>& known) {
  const std::string meant = DidYouMean(word, known);
  return meant.empty() ? std::string() : "; did you mean '" + meant + "'?";
}

UsageProblem ProblemOfVerb(const CLI::App& program, std::span<const std::string> words) {
  const std::string& word = words.front();
  const auto rest = words.subspan(1);
  const auto other = std::ranges::find(kOtherWords, word, &OtherWord::typed);
  if (other != std::end(kOtherWords)) return ProblemOfOtherWord(*other, rest);
  const std::string help = FullName(program) + " --help";
  if (const std::string file = FileMeant(word); !file.empty())
    return {Concat(word, ": there is no such file, and no such verb; did you mean '", file, "'?"),
            CommandLine(ShellWord(file), rest)};
  if (word.find_first_of("./#") != std::string::npos)
    return {Concat(word, ": there is no such file, and no such verb"), help};
  const std::vector<std::string> verbs = NamesOf(program, false);
  const std::string meant = DidYouMean(word, verbs);
  return {"unknown verb '" + word + "'" + MeantInstead(word, verbs), meant.empty() ? help : CommandLine(meant, rest)};
}

UsageProblem ProblemOf(const CLI::App& verb, const CLI::ParseError& error, std::span<const std::string> words,
                       const std::vector<std::string>& rest) {
  const std::string next = FullName(verb) + " --help";
  if (!rest.empty() && error.get_name() != "ValidationError" && error.get_name() != "ConversionError") {
    const std::string& word = rest.front();
    if (MissesOutput(verb) && LooksWritten(word))
      return {Concat("unexpected argument '", word, "'; -o/--output names the output"), WithOutput(words, word)};
    const std::vector<std::string> all(words.begin(), words.end());
    for (const auto problem_of : {ProblemOfRevision, ProblemOfName})
      if (const std::optional<UsageProblem> problem = problem_of(verb, all, word)) return *problem;
    return {Explain(verb, word), next};
  }
  if (!VerbsOf(verb).empty()) return {"a verb is missing", next};
  return {Reworded(verb, error), next};
}

std::optional<UsageProblem> ProblemOfOutput(CLI::App& verb, std::span<const std::string> words) {
  if (!MissesOutput(verb)) return std::nullopt;
  const bool writes_atlas = MarkOf(*verb.get_option("-o")) == Writes::kAtlas;
  for (const CLI::Option* option : verb.get_options(NamesFiles)) {
    if (!option->get_positional() || option->count() < 2) continue;
    const std::string& last = option->results().back();
    if (!LooksWritten(last) && !(writes_atlas && !IsThere(Location::Parse(last).path) && last != "-")) continue;
    return UsageProblem{Concat("the output is missing; ", last, " is one where -o/--output stands before it"),
                        WithOutput(words, last)};
  }
  return std::nullopt;
}

std::string FileMeant(const std::string& path) {
  namespace fs = std::filesystem;
  constexpr std::size_t kMostLooked = 10'000;
  const fs::path asked(path);
  const std::string word = asked.filename().string();
  if (word.size() < 3 || IsThere(Location::Parse(path).path)) return {};
  const fs::path folder = asked.has_parent_path() ? asked.parent_path() : fs::path(".");
  std::size_t least = std::max<std::size_t>(2, word.size() / 4), looked = 0;
  std::vector<std::string> nearest;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (++looked > kMostLooked) return {};
    const std::string name = entry->path().filename().string();
    const std::size_t distance = entry->path().stem() == word ? 0 : EditDistance(word, name);
    std::error_code ignored;
    if (distance > least || !entry->is_regular_file(ignored)) continue;
    const std::string file = (asked.parent_path() / name).string();
    if (FindFormatOfInput(Location(file, {})) == nullptr) continue;
    if (distance < least) nearest.clear();
    least = distance;
    nearest.push_back(file);
  }
  return nearest.size() == 1 ? nearest.front() : std::string();
}

}  // namespace slamdb::cli
